// SPDX-License-Identifier: BSD-3-Clause
// Soft step: sequential impulses with sub-steps, soft contacts and a relaxing pass.
//
// The interval [t0, t1] is cut into n sub-steps of length h, which the setting says; into more of them where
// bodies turn or travel further in one than contact points found at its start can follow.
// The narrow phase runs at the start, and again for a pair that has since moved by more than a small share of
// its size; in between the gap s of a contact point follows the motion of its bodies. A sub-step
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
// fraction of the sub-step rate, so that it has no unit of its own (and that of a whole sub-step also in one
// that an impact cuts short, or a sliver of time would push as fast as it can); the steady error under a
// force F is F/(m w²). b s is capped at sqrt(g L): an overlap is pushed out no faster than a body falls its
// own length, g being what presses the pair together where that is more than gravity.
//
// A point that is still open (s > 0) asks only that it does not close faster than it can: u >= -s/h. The
// relaxing pass leaves out the points without an impulse: by then they have moved, and what they ask for is
// the next sub-step's matter, or that of an impact there.
//
// Friction is a vector in the contact plane, |l_T| <= mu l_n, on the circular cone. A sticking point is
// solved as a 2 x 2 block. A sliding one steps by rho = 1/(largest eigenvalue of its 2 x 2 response) and is
// projected back: l_T <- P(l_T - rho u_T). The fixed point of that is u_T against l_T, the direction of
// maximum dissipation, which the block step alone would miss when the response is not isotropic.
//
// Restitution. Impacts that were not resolved at their time (impacts.h) rebound at the end: a point that came
// at a speed u0 worth a rebound and was pushed leaves at e u0 (Newton's law, a pass over the points).
//
// A body that no impulse pushed in a sub-step has moved under its load alone and takes the exact parabola. A
// push takes that away by degrees, so that none, however small, makes a jump; one of a hundredth of the load
// does so in full.
#include "algebra.h"
#include "effects/rolling.h"
#include "effects_built.h"
#include "fidelity.h"
#include "integrate.h"
#include "methods/contact_lanes.h"
#include "overlaps.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace rbs::soft_step {

namespace {

// w h of a contact. Stiffer sags less, but a stack of ten then never comes to rest (from 0.45 pi) or gains
// energy as it lands (from 0.35 pi).
constexpr double kStiffness = 0.3 * kPi;
constexpr double kDamping = 10.0;  // z: stiff contacts must not ring
// Share of its load that a body must be pushed with to take the straight path of a contact.
constexpr double kPushed = 0.01;
// A turn in one sub-step below which a body's gyroscopic torque changes its spin by less than this share.
constexpr double kSlowTurn = 1e-6;
// The most that a body that is not a ball may turn in a sub-step, rad, and that a pair may travel and fall
// against each other, share of their smaller length: farther, and a body is past a wall, or its far end on
// the other side of one, before a contact has stopped it. A load sinks in by about what it falls in one. No
// step is cut into more than so many sub-steps.
constexpr double kMostTurn = 0.5, kMostTravel = 0.5, kMostFall = 0.1;
constexpr double kMostSubSteps = 256.0;
// Share of the smaller length from which an overlap is deep: no contact makes one, but edits and user forces
// do.
constexpr double kDeep = 0.1;

// Of a contact over a sub-step of length h, in a step whose own sub-steps are h_full long.
Softness softness(double h, double h_full) {
  const double omega = kStiffness / h_full;
  const double x = h * omega * (2.0 * kDamping + h * omega);
  return {omega / (2.0 * kDamping + h * omega), x / (1.0 + x), 1.0 / (1.0 + x)};
}

// With rolling resistance, or as if there were none: not a test of it is left in the loops of a scene that
// has none.
template <bool kRolling>
class Solver {
 public:
  Solver(Context& context, const IslandBatch& batch, double t0, double t1)
      : context_(context), contacts_(context, batch), lanes_(contacts_), t0_(t0), dt_(t1 - t0) {
    h_full_ = subStep(context, batch.edges);
    sub_steps_ = std::max(1, static_cast<int>(std::ceil(dt_ / h_full_ - 1e-9)));
    h_ = dt_ / sub_steps_;
    soft_ = softness(h_, h_full_);
  }

  void begin() {
    contacts_.find(t0_, dt_, h_);
    lanes_.take();
    if constexpr (kRolling) rolling_ = rolling::find(context_.scene, contacts_);
    findDeepIslands();
  }
  void goOn();
  void end() { lanes_.giveBack(); }
  void rebound();
  void limitEnergy();
  void store() { contacts_.store(h_, h_full_); }
  int subStepCount() const { return sub_steps_; }

 private:
  // Inlined whatever their size, which depends on the effects that this build has: what it lacks is to save
  // no more than its own instructions.
  [[gnu::always_inline]] void kick();
  [[gnu::always_inline]] void drift();
  void solveRolling();
  void findDeepIslands();

  // An island in which bodies overlap deeply, and what it may do.
  struct DeepIsland {
    Index island;
    double energy;           // kinetic, at the start of the step, J
    double led_speed = 0.0;  // of the fastest led body that pushes it, m/s
  };
  double kineticEnergy(const SolverBody& s) const;
  DeepIsland* deepIslandOf(const SolverBody& s);

  Context& context_;
  SolverContacts contacts_;
  ContactLanes lanes_;
  std::vector<rolling::Row> rolling_;
  std::vector<DeepIsland> deep_islands_;  // by island
  double t0_, dt_;
  double h_full_, h_;  // a sub-step when no impact cuts the step, and now
  int sub_steps_, done_ = 0;
  Softness soft_;
};

// --- one sub-step

template <bool kRolling>
void Solver<kRolling>::goOn() {
  if (done_ > 0) lanes_.refresh(t0_ + done_ * h_, dt_ - done_ * h_);
  kick();
  lanes_.warmStart();
  if constexpr (kRolling) rolling::warmStart(contacts_, rolling_), solveRolling();
  lanes_.solve(ContactLanes::Pass::Soft, soft_, h_);
  drift();
  // Twice with rolling rows, whose bounds are the normal forces as they are then.
  for (int pass = kRolling && !rolling_.empty() ? 0 : 1; pass < 2; ++pass) {
    lanes_.solve(ContactLanes::Pass::Relax, soft_, h_);
    if constexpr (kRolling)
      if (pass == 0) solveRolling();
  }
  lanes_.addUp();
  ++done_;
}

template <bool kRolling>
void Solver<kRolling>::solveRolling() {
  if (rolling_.empty()) return;
  lanes_.giveBack();
  rolling::solve(contacts_, rolling_);
}

template <bool kRolling>
inline void Solver<kRolling>::kick() {
  for (SolverBody& s : contacts_.bodies) {
    if (s.inv_mass == 0.0) continue;
    const Load& load = context_.step.load[s.body];
    s.v += h_ * load.a_W;
    s.v_free = s.v;
    s.w += h_ * (s.inv_inertia_W * load.torque_W);
  }
}

template <bool kRolling>
inline void Solver<kRolling>::drift() {
  Bodies& bodies = context_.scene.bodies;
  for (SolverBody& s : contacts_.bodies) {
    if (s.inv_mass == 0.0 && context_.step.island[s.body] == kNone) {
      s.moved += h_ * s.v;  // led bodies move on their own clock; here only the gaps follow them
      s.turned += h_ * s.w;
      continue;
    }
    const Inertia& inertia = bodies.inertia[s.body];
    Vec3 step = h_ * s.v;
    const Vec3 fall = h_ * context_.step.load[s.body].a_W;
    const double push = (s.v - s.v_free).norm(), enough = kPushed * fall.norm();
    if (push < enough) step -= 0.5 * h_ * (1.0 - push / enough) * fall;
    s.moved += step;
    s.turned += h_ * s.w;
    bodies.pose[s.body].p_WB += step;
    Quat& q_WB = bodies.pose[s.body].q_WB;
    if (inertia.unturned) continue;
    if ((inertia.isotropic && !inertia.gyroscopic) || s.w.norm() * h_ < kSlowTurn) {
      q_WB = (rotationBy(h_ * s.w) * q_WB).normalized();
    } else {
      rotateFreely(q_WB, s.w, inertia, h_);
      s.inv_inertia_W = inertia.inverseW(q_WB.toRotationMatrix());
      s.turned_axes = true;
    }
  }
  lanes_.follow();
}

// Slower than half of what gravity adds in a step, a rebound would be over within it.
template <bool kRolling>
void Solver<kRolling>::rebound() {
  const double slowest = 0.5 * context_.step.h() * context_.scene.gravity_W.norm();
  for (const SolverBlock& block : contacts_.blocks) {
    SolverBody &i = contacts_.bodies[block.i], &j = contacts_.bodies[block.j];
    for (int k = block.first; k < block.first + block.size; ++k) {
      SolverPoint& point = contacts_.points[k];
      if (-block.e * point.u_0 <= slowest || point.earlier_n + point.sum_n == 0.0) continue;
      const double u_n = block.n.dot(contacts_.velocityAt(block, point));
      const double impulse = -point.mass_n * (u_n + block.e * point.u_0);
      if (impulse <= 0.0) continue;
      point.sum_n += impulse;
      const Vec3 impulse_W = impulse * block.n;
      i.v -= i.inv_mass * impulse_W;
      i.w -= i.inv_inertia_W * point.r_i.cross(impulse_W);
      j.v += j.inv_mass * impulse_W;
      j.w += j.inv_inertia_W * point.r_j.cross(impulse_W);
    }
  }
}

template <bool kRolling>
double Solver<kRolling>::kineticEnergy(const SolverBody& s) const {
  const Vec3 w_B = context_.scene.bodies.pose[s.body].q_WB.conjugate() * s.w;
  return 0.5 * (s.v.squaredNorm() / s.inv_mass +
                w_B.dot(context_.scene.bodies.inertia[s.body].moments.cwiseProduct(w_B)));
}

// Each pair that overlaps parts no faster than its cap. But what is wedged between two would need v /
// sin(alpha) to part from both at v, if their sides are alpha from parallel (a light body between heavy ones
// left at 2 km/s), and in a chain or a crowd the speeds of the pairs add up. So an island in which bodies
// overlap deeply gains no energy: it ends the step with what it had, what its loads did, and what bodies that
// are led may give it.
template <bool kRolling>
void Solver<kRolling>::findDeepIslands() {
  const StepStore& step = context_.step;
  const auto& traits = context_.scene.bodies.traits;
  std::set<Index> found;  // islands
  for (const SolverBlock& block : contacts_.blocks) {
    const auto points = contacts_.points.begin() + block.first;
    const SolverBody &i = contacts_.bodies[block.i], &j = contacts_.bodies[block.j];
    const double deep = kDeep * std::min(traits[i.body].length, traits[j.body].length);
    if (std::any_of(points, points + block.size, [&](const SolverPoint& p) { return p.gap < -deep; }))
      found.insert(step.island[i.inv_mass > 0.0 ? i.body : j.body]);
  }
  for (const SolverBody& s : contacts_.bodies)
    if (s.inv_mass > 0.0 && step.isCrowded(s.body)) found.insert(step.island[s.body]);
  for (const Index island : found) deep_islands_.push_back({island, 0.0});
  if (deep_islands_.empty()) return;
  for (const SolverBody& s : contacts_.bodies)
    if (DeepIsland* island = deepIslandOf(s)) island->energy += kineticEnergy(s);
  for (const SolverBlock& block : contacts_.blocks) {
    const SolverBody &i = contacts_.bodies[block.i], &j = contacts_.bodies[block.j];
    for (const auto& [led, pushed] : {std::pair(&i, &j), std::pair(&j, &i)})
      if (DeepIsland* island = led->inv_mass > 0.0 || led->still ? nullptr : deepIslandOf(*pushed))
        island->led_speed = std::max(island->led_speed, led->v.norm() + led->reach * led->w.norm());
  }
}

template <bool kRolling>
typename Solver<kRolling>::DeepIsland* Solver<kRolling>::deepIslandOf(const SolverBody& s) {
  if (s.inv_mass == 0.0) return nullptr;
  const Index island = context_.step.island[s.body];
  const auto known = std::lower_bound(deep_islands_.begin(), deep_islands_.end(), island,
                                      [](const DeepIsland& deep, Index k) { return deep.island < k; });
  return known != deep_islands_.end() && known->island == island ? &*known : nullptr;
}

// Takes the energy from the motions about the common centre first, which keeps the momentum.
template <bool kRolling>
void Solver<kRolling>::limitEnergy() {
  for (DeepIsland& island : deep_islands_) {
    double mass = 0.0, energy = 0.0;
    Vec3 momentum = Vec3::Zero();
    for (const SolverBody& s : contacts_.bodies) {
      if (deepIslandOf(s) != &island) continue;
      const Load& load = context_.step.load[s.body];
      island.energy += load.a_W.dot(s.moved) / s.inv_mass + load.torque_W.dot(s.turned);
      mass += 1.0 / s.inv_mass, momentum += s.v / s.inv_mass, energy += kineticEnergy(s);
    }
    const double most = std::max(0.0, island.energy + 0.5 * mass * island.led_speed * island.led_speed);
    if (energy <= most) continue;
    const Vec3 common = momentum / mass;
    const double together = 0.5 * mass * common.squaredNorm(), apart = energy - together;
    const double share = apart > 0.0 ? std::sqrt(std::clamp((most - together) / apart, 0.0, 1.0)) : 0.0;
    const double rest = together > most ? std::sqrt(most / together) : 1.0;
    for (SolverBody& s : contacts_.bodies)
      if (deepIslandOf(s) == &island) s.v = rest * common + share * (s.v - common), s.w *= share;
  }
}

template <class SomeSolver>
void advanceBy(Context& context, const IslandBatch& batch, double t0, double t1) {
  ContactClock clock(context.step);
  SomeSolver solver(context, batch, t0, t1);
  solver.begin();
  clock.charge(kCollide);
  for (int k = 0; k < solver.subStepCount(); ++k) solver.goOn();
  solver.end();
  if (built::restitution && context.scene.effects[Effect::Restitution]) solver.rebound();
  solver.limitEnergy();
  clock.charge(kSolve);
  solver.store();
  clock.charge(kStore);
}

}  // namespace

double subStep(const Context& context, const std::vector<Edge>& edges) {
  const StepStore& step = context.step;
  const Bodies& bodies = context.scene.bodies;
  double h = step.h() / settingsOf(context.scene.settings.fidelity).sub_steps;
  for (const Edge& edge : edges) {
    if (edge.kind != ConstraintKind::Contact) continue;
    const Contact& contact = context.scene.contacts.active[edge.of];
    const Index i = contact.i, j = contact.j;
    const double length = std::min(bodies.traits[i].length, bodies.traits[j].length);
    const double load = (step.load[j].a_W - step.load[i].a_W).norm();
    const double speed = (bodies.twist[j].v_WB - bodies.twist[i].v_WB).norm() + step.h() * load;
    h = std::min(h, kMostTravel * length / speed);
    h = std::min(h, std::sqrt(kMostFall * length / load));
    for (const Index one : {i, j})
      if (!std::holds_alternative<Sphere>(bodies.traits[one].shape))
        h = std::min(h, kMostTurn / bodies.twist[one].w_WB.norm());
  }
  return std::max(h, step.h() / kMostSubSteps);
}

void advance(Context& context, const IslandBatch& batch, double t0, double t1) {
  if (!(t1 > t0)) return;
  if constexpr (built::rolling)
    if (context.scene.effects[Effect::Rolling]) return advanceBy<Solver<true>>(context, batch, t0, t1);
  advanceBy<Solver<false>>(context, batch, t0, t1);
}

}  // namespace rbs::soft_step
