// Soft step: sequential impulses with sub-steps, soft contacts and a relaxing pass.
//
// The interval [t0, t1] is cut into n sub-steps of length h. The narrow phase runs at the start, and again for
// a pair that has since moved by more than a small share of its size; in between the gap s of a contact point
// follows the motion of its bodies. A sub-step
//   1. adds the loads to the velocities, and last sub-step's impulses (warm start);
//   2. solves each contact once with a soft constraint that also closes the position error;
//   3. moves the bodies;
//   4. solves each contact once more without the position error (relax), which takes away the speed that
//      only served to separate the bodies, so that pushing bodies apart adds no kinetic energy.
//
// Soft contact. A contact of effective mass m that is open by s with speed u gets a spring and damper of
// frequency w and damping ratio z, integrated implicitly, which an impulse solver writes as
//   dl = -a m (u + b s) - c l,   b = w/(2z + h w),   x = h w (2z + h w),   a = x/(1 + x),   c = 1/(1 + x),
// with l the accumulated impulse (Catto, "Soft constraints", GDC 2011; "Solver2D", 2024). w is a fixed
// fraction of the sub-step rate, so that it has no unit of its own (and that of a whole sub-step also in one that
// an impact cuts short, or a sliver of time would push as fast as it can); the steady error under a force F is
// F/(m w²). b s is capped at sqrt(g L): an overlap is pushed out no faster than a body falls its own length.
//
// A point that is still open (s > 0) asks only that it does not close faster than it can: u >= -s/h. The
// relaxing pass leaves out the points without an impulse: by then they have moved, and what they ask for is the
// next sub-step's matter, or that of an impact there.
//
// Friction is a vector in the contact plane, |l_T| <= mu l_n, on the circular cone. A sticking point is
// solved as a 2 x 2 block. A sliding one steps by rho = 1/(largest eigenvalue of its 2 x 2 response) and is
// projected back: l_T <- P(l_T - rho u_T). The fixed point of that is u_T against l_T, the direction of
// maximum dissipation, which the block step alone would miss when the response is not isotropic.
//
// Restitution. Impacts that were not resolved at their time (impacts.h) rebound at the end: a point that came
// at a speed u0 worth a rebound and was pushed leaves at e u0 (Newton's law, a pass over the points).
//
// A body that no impulse touched in a sub-step has moved under its load alone and takes the exact parabola.
#include "algebra.h"
#include "integrate.h"
#include "methods/methods.h"
#include "narrowphase/collide.h"

#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

namespace rbs::soft_step {

namespace {

// w h of a contact. Stiffer sags less, but a stack of ten then never comes to rest (from 0.45 pi) or gains energy
// as it lands (from 0.35 pi).
constexpr double kStiffness = 0.3 * kPi;
constexpr double kDamping = 10.0;  // z: stiff contacts must not ring
// Points within this share of the smaller length are kept whatever the speeds, so that resting contacts do
// not flicker.
constexpr double kMargin = 0.01;
// A pair that has moved by this share of the smaller length since its points were found looks for them anew.
constexpr double kStray = 0.05;
// A turn in one sub-step below which a body's gyroscopic torque changes its spin by less than this share.
constexpr double kSlowTurn = 1e-6;

struct SolverBody {
  Vec3 v, w;                // m/s, rad/s
  Vec3 moved, turned;       // since the start, m, rad
  Mat3 inv_inertia_W;
  double inv_mass;
  bool touched = false;     // by an impulse in this sub-step
  bool round;               // its surface does not turn with it: a sphere
  double reach;             // of the points that turning moves, m: 0 for a sphere and a plane
  Index body;
};

struct Point {
  Vec3 r_i, r_j;        // from the centres, m
  double gap;           // when it was found, m
  double u_0;           // normal velocity of j against i when it was found, m/s
  double mass_n;        // effective, along the normal, kg
  Eigen::Matrix2d mass_t;  // effective, in the contact plane, kg
  double rho;           // 1/(largest eigenvalue of the response in the contact plane), kg
  double l_n = 0.0;     // impulses of this sub-step, N s
  Eigen::Vector2d l_t{0.0, 0.0};
  double guess_n = 0.0;  // the forces it began with, N
  Vec3 guess_t_W{0.0, 0.0, 0.0};
  double sum_n = 0.0;   // over all sub-steps
  Eigen::Vector2d sum_t{0.0, 0.0};
  double open;          // gap now, m
  std::uint32_t feature;
  Vec3 p_W;
};

struct Block {
  Index i, j;  // solver bodies
  Vec3 n, t1, t2;
  double mu, e;
  double push;  // largest speed of separation, m/s
  Index pair;
  int first, size;
  double stray;                                // how far the pair may move until its points are found anew, m
  Vec3 moved_i, moved_j, turned_i, turned_j;  // of the bodies when they were found
};

struct Softness {
  double bias, mass, impulse;  // b, a, c
};

// Of a contact over a sub-step of length h, in a step whose own sub-steps are h_full long.
Softness softness(double h, double h_full) {
  const double omega = kStiffness / h_full;
  const double x = h * omega * (2.0 * kDamping + h * omega);
  return {omega / (2.0 * kDamping + h * omega), x / (1.0 + x), 1.0 / (1.0 + x)};
}

int subSteps(Fidelity fidelity) { return fidelity == Fidelity::Preview ? 1 : 8; }

class Solver {
 public:
  Solver(Context& context, const IslandBatch& batch, double t0, double t1)
      : context_(context), batch_(batch), t0_(t0), dt_(t1 - t0) {
    h_full_ = context.step.h() / subSteps(context.scene.settings.fidelity);
    sub_steps_ = std::max(1, static_cast<int>(std::ceil(dt_ / h_full_ - 1e-9)));
    h_ = dt_ / sub_steps_;
    soft_ = softness(h_, h_full_);
  }

  void gather();
  void collide();
  void subStep();
  void rebound();
  void store();
  int subStepCount() const { return sub_steps_; }

 private:
  SolverBody makeBody(Index i) const;
  Index solverBody(Index i);
  double marginOf(const Block& block) const;
  void findPoints(Block& block);
  void preparePoint(const Block& block, const ManifoldPoint& found, const Vec3& centre_i, const Vec3& centre_j,
                    Point& point) const;
  void warmFromLastStep(const Block& block, Point& point) const;
  void warmFrom(const Block& block, const Block& old_block, Point& point) const;
  bool hasStrayed(const Block& block) const;
  void refresh();

  void kick();
  void warmStart();
  template <bool kBias>
  void solve();
  void drift();
  double gapNow(const Block& block, const Point& point) const;
  double now() const { return t0_ + done_ * h_; }
  static void apply(SolverBody& i, SolverBody& j, const Point& point, const Vec3& impulse);

  Context& context_;
  const IslandBatch& batch_;
  double t0_, dt_;
  double h_full_, h_;  // a sub-step when the step is not cut, and now
  int sub_steps_, done_ = 0;
  Softness soft_;
  std::vector<SolverBody> bodies_;
  std::vector<Index> slot_;
  std::vector<Block> blocks_;
  std::vector<Point> points_;
};

// --- set-up

SolverBody Solver::makeBody(Index i) const {
  const Bodies& bodies = context_.scene.bodies;
  SolverBody s;
  s.v = bodies.twist[i].v_WB;
  s.w = bodies.twist[i].w_WB;
  s.moved.setZero();
  s.turned.setZero();
  s.inv_mass = bodies.inertia[i].inv_mass;
  s.inv_inertia_W = bodies.inertia[i].isotropic ? Mat3(bodies.inertia[i].inv_moments.asDiagonal())
                                                : bodies.inertia[i].inverseW(bodies.R_WB(i));
  s.round = std::holds_alternative<Sphere>(bodies.traits[i].shape);
  s.reach = std::holds_alternative<Box>(bodies.traits[i].shape) ? bodies.traits[i].bounding_radius : 0.0;
  s.body = i;
  return s;
}

Index Solver::solverBody(Index i) {
  if (slot_[i] == kNone) {
    slot_[i] = static_cast<Index>(bodies_.size());
    bodies_.push_back(makeBody(i));
  }
  return slot_[i];
}

void Solver::gather() {
  slot_.assign(context_.scene.bodies.size(), kNone);
  bodies_.reserve(batch_.bodies.size() + 8);
  for (const Index i : batch_.bodies) solverBody(i);
}

// Points that can touch in what is left of the interval, with room to spare.
double Solver::marginOf(const Block& block) const {
  const SolverBody& i = bodies_[block.i];
  const SolverBody& j = bodies_[block.j];
  const std::vector<Traits>& traits = context_.scene.bodies.traits;
  const double left = dt_ - done_ * h_;
  const double speed = (j.v - i.v).norm() + i.reach * i.w.norm() + j.reach * j.w.norm();
  const Vec3 a = context_.step.load[j.body].a_W - context_.step.load[i.body].a_W;
  const double length = std::min(traits[i.body].length, traits[j.body].length);
  return left * (speed + 0.5 * left * a.norm()) + kMargin * length;
}

void Solver::collide() {
  const Bodies& bodies = context_.scene.bodies;
  const double gravity = context_.scene.settings.gravity.norm();
  for (const Index k : batch_.pairs) {
    if (context_.step.standing[k] == Standing::Awaited) continue;
    const ContactPair& pair = context_.step.contacts.pairs[k];
    const Traits& a = bodies.traits[pair.i];
    const Traits& b = bodies.traits[pair.j];
    Block block;
    block.i = solverBody(pair.i);
    block.j = solverBody(pair.j);
    block.mu = pairFriction(a.material, b.material);
    block.e = pairRestitution(a.material, b.material);
    block.push = fallSpeed(gravity, std::min(a.length, b.length));
    block.pair = k;
    findPoints(block);
    for (int p = block.first; p < block.first + block.size; ++p) warmFromLastStep(block, points_[p]);
    blocks_.push_back(block);
  }
}

// Finds where the pair touches now. Without a point within the margin nothing can touch before the pair has
// moved that far.
void Solver::findPoints(Block& block) {
  const Bodies& bodies = context_.scene.bodies;
  const SolverBody& i = bodies_[block.i];
  const SolverBody& j = bodies_[block.j];
  const Pose X_i = context_.step.poseAt(bodies, i.body, now()), X_j = context_.step.poseAt(bodies, j.body, now());
  const double margin = marginOf(block);
  const Manifold manifold = rbs::collide(bodies.traits[i.body].shape, X_i, bodies.traits[j.body].shape, X_j, margin);
  const double length = std::min(bodies.traits[i.body].length, bodies.traits[j.body].length);
  block.n = manifold.n_W;
  std::tie(block.t1, block.t2) = tangents(block.n);
  block.stray = manifold.size > 0 ? kStray * length : margin;
  block.moved_i = i.moved, block.turned_i = i.turned;
  block.moved_j = j.moved, block.turned_j = j.turned;
  block.first = static_cast<int>(points_.size());
  block.size = manifold.size;
  points_.resize(points_.size() + block.size);
  for (int k = 0; k < block.size; ++k)
    preparePoint(block, manifold.points[k], X_i.p_WB, X_j.p_WB, points_[block.first + k]);
}

void Solver::preparePoint(const Block& block, const ManifoldPoint& found, const Vec3& centre_i,
                          const Vec3& centre_j, Point& point) const {
  const SolverBody& i = bodies_[block.i];
  const SolverBody& j = bodies_[block.j];
  point.p_W = found.p_W;
  point.r_i = found.p_W - centre_i;
  point.r_j = found.p_W - centre_j;
  point.gap = point.open = found.separation;
  point.feature = found.feature;

  const Mat3 lever_i = crossMatrix(point.r_i), lever_j = crossMatrix(point.r_j);
  const Mat3 response = (i.inv_mass + j.inv_mass) * Mat3::Identity() -
                        lever_i * i.inv_inertia_W * lever_i - lever_j * j.inv_inertia_W * lever_j;
  point.mass_n = 1.0 / block.n.dot(response * block.n);
  point.u_0 = block.n.dot(j.v + j.w.cross(point.r_j) - i.v - i.w.cross(point.r_i));
  if (block.mu == 0.0) return;
  Eigen::Matrix<double, 3, 2> T;
  T << block.t1, block.t2;
  const Eigen::Matrix2d S = T.transpose() * response * T;
  point.mass_t = S.inverse();
  const double half_trace = 0.5 * S.trace();
  point.rho = 1.0 / (half_trace + std::sqrt(std::max(half_trace * half_trace - S.determinant(), 0.0)));
}

void Solver::warmFromLastStep(const Block& block, Point& point) const {
  const Contacts& contacts = context_.step.contacts;
  const ContactPair& pair = contacts.pairs[block.pair];
  for (Index t = pair.first; t < pair.first + pair.size; ++t) {
    const Touch& touch = contacts.touches[t];
    if (touch.feature != point.feature) continue;
    point.guess_n = touch.normal;
    point.guess_t_W = touch.friction_W;
    point.l_n = touch.normal * h_;
    if (block.mu > 0.0) point.l_t = h_ * Eigen::Vector2d(block.t1.dot(touch.friction_W), block.t2.dot(touch.friction_W));
    break;
  }
}

void Solver::warmFrom(const Block& block, const Block& old_block, Point& point) const {
  for (int k = old_block.first; k < old_block.first + old_block.size; ++k) {
    const Point& old = points_[k];
    if (old.feature != point.feature) continue;
    const auto turned = [&](const Eigen::Vector2d& t) -> Eigen::Vector2d {
      const Vec3 t_W = t.x() * old_block.t1 + t.y() * old_block.t2;
      return {block.t1.dot(t_W), block.t2.dot(t_W)};
    };
    point.u_0 = old.u_0;
    point.guess_n = old.guess_n, point.guess_t_W = old.guess_t_W;
    point.l_n = old.l_n, point.l_t = turned(old.l_t);
    point.sum_n = old.sum_n, point.sum_t = turned(old.sum_t);
    break;
  }
}

bool Solver::hasStrayed(const Block& block) const {
  const SolverBody& i = bodies_[block.i];
  const SolverBody& j = bodies_[block.j];
  const double travel = ((j.moved - block.moved_j) - (i.moved - block.moved_i)).norm();
  const double turn_i = (i.turned - block.turned_i).norm(), turn_j = (j.turned - block.turned_j).norm();
  return travel + i.reach * turn_i + j.reach * turn_j > block.stray;
}

void Solver::refresh() {
  for (Block& block : blocks_) {
    if (!hasStrayed(block)) continue;
    const Block old = block;
    findPoints(block);
    for (int k = block.first; k < block.first + block.size; ++k) warmFrom(block, old, points_[k]);
  }
}

// --- one sub-step

void Solver::subStep() {
  if (done_ > 0) refresh();
  kick();
  warmStart();
  solve<true>();
  drift();
  solve<false>();
  for (Point& point : points_) point.sum_n += point.l_n, point.sum_t += point.l_t;
  ++done_;
}

void Solver::kick() {
  for (SolverBody& s : bodies_) {
    s.touched = false;
    if (s.inv_mass == 0.0) continue;
    const Load& load = context_.step.load[s.body];
    s.v += h_ * load.a_W;
    s.w += h_ * (s.inv_inertia_W * load.torque_W);
  }
}

void Solver::apply(SolverBody& i, SolverBody& j, const Point& point, const Vec3& impulse) {
  i.v -= i.inv_mass * impulse;
  i.w -= i.inv_inertia_W * point.r_i.cross(impulse);
  j.v += j.inv_mass * impulse;
  j.w += j.inv_inertia_W * point.r_j.cross(impulse);
  i.touched = j.touched = true;
}

void Solver::warmStart() {
  for (const Block& block : blocks_) {
    for (int k = block.first; k < block.first + block.size; ++k) {
      const Point& point = points_[k];
      if (point.l_n == 0.0) continue;
      apply(bodies_[block.i], bodies_[block.j], point,
            point.l_n * block.n + point.l_t.x() * block.t1 + point.l_t.y() * block.t2);
    }
  }
}

// The gap after the bodies moved by x and turned by theta since the point was found. A point of the surface at r has gone to
// x + exp([theta]) r, to second order x + theta x r + theta x (theta x r)/2. A sphere's nearest point does not
// turn with it.
double Solver::gapNow(const Block& block, const Point& point) const {
  const SolverBody& i = bodies_[block.i];
  const SolverBody& j = bodies_[block.j];
  Vec3 shift = (j.moved - block.moved_j) - (i.moved - block.moved_i);
  if (!i.round) {
    const Vec3 theta = i.turned - block.turned_i, turn = theta.cross(point.r_i);
    shift -= turn + 0.5 * theta.cross(turn);
  }
  if (!j.round) {
    const Vec3 theta = j.turned - block.turned_j, turn = theta.cross(point.r_j);
    shift += turn + 0.5 * theta.cross(turn);
  }
  return point.gap + block.n.dot(shift);
}

template <bool kBias>
void Solver::solve() {
  for (const Block& block : blocks_) {
    SolverBody& i = bodies_[block.i];
    SolverBody& j = bodies_[block.j];
    const auto relative = [&](const Point& point) -> Vec3 {
      return j.v + j.w.cross(point.r_j) - i.v - i.w.cross(point.r_i);
    };

    if (block.mu > 0.0) {
      for (int k = block.first; k < block.first + block.size; ++k) {
        Point& point = points_[k];
        const double limit = block.mu * point.l_n;
        if (limit == 0.0 && point.l_t.isZero(0.0)) continue;
        const Vec3 u = relative(point);
        const Eigen::Vector2d u_t(block.t1.dot(u), block.t2.dot(u));
        Eigen::Vector2d l_t = point.l_t - point.mass_t * u_t;
        if (l_t.squaredNorm() > limit * limit) {
          l_t = point.l_t - point.rho * u_t;
          const double length = l_t.norm();
          if (length > limit) l_t *= limit / length;
        }
        const Eigen::Vector2d change = l_t - point.l_t;
        point.l_t = l_t;
        apply(i, j, point, change.x() * block.t1 + change.y() * block.t2);
      }
    }

    for (int k = block.first; k < block.first + block.size; ++k) {
      Point& point = points_[k];
      if (!kBias && point.l_n == 0.0) continue;
      const double u_n = block.n.dot(relative(point));
      point.open = gapNow(block, point);
      double change;
      if (point.open > 0.0) {
        change = -point.mass_n * (u_n + point.open / h_);
      } else if (kBias) {
        const double bias = std::max(soft_.bias * point.open, -block.push);
        change = -soft_.mass * point.mass_n * (u_n + bias) - soft_.impulse * point.l_n;
      } else {
        change = -point.mass_n * u_n;
      }
      const double l_n = std::max(point.l_n + change, 0.0);
      change = l_n - point.l_n;
      if (change == 0.0) continue;
      point.l_n = l_n;
      apply(i, j, point, change * block.n);
    }
  }
}

void Solver::drift() {
  Bodies& bodies = context_.scene.bodies;
  for (SolverBody& s : bodies_) {
    if (s.inv_mass == 0.0 && context_.step.island[s.body] == kNone) {
      s.moved += h_ * s.v;  // led bodies move on their own clock; here only the gaps follow them
      s.turned += h_ * s.w;
      continue;
    }
    const Inertia& inertia = bodies.inertia[s.body];
    Vec3 step = h_ * s.v;
    if (!s.touched) step -= 0.5 * h_ * h_ * context_.step.load[s.body].a_W;
    s.moved += step;
    s.turned += h_ * s.w;
    bodies.pose[s.body].p_WB += step;
    Quat& q_WB = bodies.pose[s.body].q_WB;
    if (inertia.isotropic || s.w.norm() * h_ < kSlowTurn) {
      q_WB = (rotationBy(h_ * s.w) * q_WB).normalized();
    } else {
      rotateFreely(q_WB, s.w, inertia, h_);
      s.inv_inertia_W = inertia.inverseW(q_WB.toRotationMatrix());
    }
  }
}

// Slower than half of what gravity adds in a step, a rebound would be over within it.
void Solver::rebound() {
  const double slowest = 0.5 * context_.step.h() * context_.scene.settings.gravity.norm();
  for (const Block& block : blocks_) {
    SolverBody& i = bodies_[block.i];
    SolverBody& j = bodies_[block.j];
    for (int k = block.first; k < block.first + block.size; ++k) {
      Point& point = points_[k];
      if (-block.e * point.u_0 <= slowest || point.sum_n == 0.0) continue;
      const double u_n = block.n.dot(j.v + j.w.cross(point.r_j) - i.v - i.w.cross(point.r_i));
      const double impulse = -point.mass_n * (u_n + block.e * point.u_0);
      if (impulse <= 0.0) continue;
      point.sum_n += impulse;
      apply(i, j, point, impulse * block.n);
    }
  }
}

// --- results

// The force of a point is its impulse over a whole sub-step. After a shorter one, which an impact has cut off,
// the guess it began with stands in for the rest: an impulse divided by a sliver of time is no force.
void Solver::store() {
  const double rest = std::max(h_full_ - h_, 0.0);
  Bodies& bodies = context_.scene.bodies;
  for (const SolverBody& s : bodies_) {
    if (context_.step.island[s.body] == kNone) continue;
    bodies.twist[s.body] = {s.v, s.w};
  }
  Contacts& contacts = context_.step.contacts;
  for (const Index k : batch_.pairs) contacts.pairs[k].size = 0;
  for (const Block& block : blocks_) {
    ContactPair& pair = contacts.pairs[block.pair];
    pair.first = static_cast<Index>(contacts.touches.size());
    pair.size = static_cast<Index>(block.size);
    for (int k = block.first; k < block.first + block.size; ++k) {
      const Point& point = points_[k];
      const auto inPlane = [&](const Eigen::Vector2d& t) -> Vec3 { return t.x() * block.t1 + t.y() * block.t2; };
      Touch touch;
      touch.feature = point.feature;
      touch.normal = (point.l_n + rest * point.guess_n) / (h_ + rest);
      touch.friction_W = (inPlane(point.l_t) + rest * point.guess_t_W) / (h_ + rest);
      touch.p_W = point.p_W + 0.5 * (bodies_[block.i].moved - block.moved_i + bodies_[block.j].moved - block.moved_j);
      touch.n_W = block.n;
      touch.separation = gapNow(block, point);
      touch.normal_impulse = point.sum_n;
      touch.friction_impulse_W = inPlane(point.sum_t);
      contacts.touches.push_back(touch);
    }
  }
}

// The rows of the method, each timed under its name.
enum Row { kCollide, kSolve, kStore, kRows };

}  // namespace

const std::vector<const char*>& stageNames() {
  static const std::vector<const char*> names{"narrowphase.collide", "contacts.substeps", "contacts.store"};
  return names;
}

void advance(Context& context, const IslandBatch& batch, double t0, double t1) {
  if (!(t1 > t0)) return;
  using Clock = std::chrono::steady_clock;
  std::vector<double>& seconds = context.step.contact_seconds;
  seconds.resize(kRows);
  auto mark = Clock::now();
  const auto charge = [&](Row row) {
    const auto now = Clock::now();
    seconds[row] += std::chrono::duration<double>(now - mark).count();
    mark = now;
  };

  Solver solver(context, batch, t0, t1);
  solver.gather();
  solver.collide();
  charge(kCollide);
  for (int k = 0; k < solver.subStepCount(); ++k) solver.subStep();
  solver.rebound();
  charge(kSolve);
  solver.store();
  charge(kStore);
}

}  // namespace rbs::soft_step
