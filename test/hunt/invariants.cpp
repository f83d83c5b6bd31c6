// SPDX-License-Identifier: BSD-3-Clause
#include "invariants.h"

#include "rigid_body_sim/polyhedron.h"
#include "rigid_body_sim/queries.h"
#include "rigid_body_sim/scenes.h"
#include "rigid_body_sim/shape.h"
#include "rigid_body_sim/world.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <map>
#include <set>
#include <sstream>

namespace rbs::hunt {

namespace {

// Of the energy, by setting: what a step may add. docs/stability.md says where these come from.
constexpr double kEnergy[] = {5e-2, 2e-2, 2e-2, 2e-2};
constexpr double kBalance = 1e-10;    // of the impulses on a body
constexpr double kCone = 1e-6;        // of mu times the normal impulse
constexpr double kForgiven = 1.1e-4;  // residual that rounding may leave, see docs/tolerances.md
constexpr double kClosing = 2e-3;     // of the fastest speed,
constexpr double kDiscs = 5e-3;       // and with what a disc adds at most
constexpr double kAlike = 1e-6;       // velocities of two runs, in shares of the largest: they are the same
constexpr double kSymmetry = 1e-2;    // where a step may part them that began it alike
constexpr int kSymmetrySteps = 20;    // so many are compared
constexpr std::uint32_t kMostImpacts = 25000;
constexpr double kTooFast = 30.0;  // rad in a step, or smallest extents
constexpr double kDeep = 0.05;     // of the smaller extent of a pair: deeper ones are the work of an edit

bool isExact(const SceneDef& scene) {
  return scene.fidelity.preset >= Fidelity::Accurate;
}

double extentOf(const BodyDescription& body) {
  const double least = fullExtents(body.shape).minCoeff();
  return least > 0.0 ? least : std::numeric_limits<double>::infinity();
}

bool isDeep(const BodyDescription& a, const BodyDescription& b, double separation) {
  return separation < -kDeep * std::min(extentOf(a), extentOf(b));
}

bool overlapsDeeply(const Snapshot& snapshot) {
  return std::any_of(snapshot.contacts.begin(), snapshot.contacts.end(), [&](const ContactPoint& point) {
    return isDeep((*snapshot.bodies)[snapshot.find(point.a)], (*snapshot.bodies)[snapshot.find(point.b)],
                  point.separation);
  });
}

// Before the first step no contacts are known.
bool startsDeep(const Snapshot& start) {
  const std::vector<BodyDescription>& bodies = *start.bodies;
  for (std::size_t i = 0; i < bodies.size(); ++i)
    for (std::size_t j = i + 1; j < bodies.size(); ++j) {
      if (bodies[i].kind != BodyKind::Dynamic && bodies[j].kind != BodyKind::Dynamic) continue;
      if (isDeep(bodies[i], bodies[j], closestPoints(start, bodies[i].id, bodies[j].id).distance))
        return true;
    }
  return false;
}

// Whether a body has come to the limits of speeds, which have units.
bool reachesLimits(const StepReport& report) {
  return std::any_of(report.warnings.begin(), report.warnings.end(),
                     [](const Warning& warning) { return warning.kind == "too_fast"; });
}

bool hasConverged(const StepReport& report) {
  return std::all_of(report.residuals.begin(), report.residuals.end(),
                     [](const IslandResiduals& island) { return island.converged; });
}

// How fast the rim of a disc closes at most, m/s, while none of the eight feet that it stands on does: halfway between two
// feet it is R (1 - cos(pi/8)) beyond the line through them, about which the two bodies may turn relative to each other at w.
double closingOfRim(const BodyDescription& body, double w) {
  const double beyond = 1.0 - std::sqrt(0.5 + std::sqrt(0.125));
  if (const auto* cylinder = std::get_if<Cylinder>(&body.shape)) return beyond * cylinder->radius * w;
  if (const auto* cone = std::get_if<Cone>(&body.shape)) return beyond * cone->radius * w;
  return 0.0;
}

// The fastest point of a body, m/s; of a plane, its velocity.
double speedOf(const BodyDescription& body, const Twist& twist) {
  const double radius = boundingRadius(body.shape);
  return twist.v_WB.norm() + (std::isfinite(radius) ? radius * twist.w_WB.norm() : 0.0);
}

double fastest(const Snapshot& snapshot) {
  double speed = snapshot.gravity.norm() * snapshot.step;
  for (std::size_t i = 0; i < snapshot.states.size(); ++i)
    speed = std::max(speed, speedOf((*snapshot.bodies)[i], snapshot.states[i].twist));
  return speed;
}

class Run {
 public:
  Run(const SceneDef& scene, double overlap)
      : scene_(scene), overlap_(overlap), world_(scene), before_(world_.snapshot()) {
    for (const BodyDescription& body : *before_.bodies) {
      if (body.kind == BodyKind::Kinematic) driven_ = true;
      if (body.kind != BodyKind::Dynamic) continue;
      fall_ += body.mass * scene.gravity.norm() * extentOf(body);
    }
    deep_ = startsDeep(before_);
    least_ = energyOf(before_);
    most_kinetic_ = before_.totals.kinetic_energy;
  }

  World& world() { return world_; }
  bool reachedLimits() const { return reached_limits_; }

  std::optional<Finding> step(double seconds_allowed) {
    ++k_;
    const std::clock_t start = std::clock();
    world_.step();
    const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    const Snapshot after = world_.snapshot();
    reached_limits_ = reached_limits_ || reachesLimits(after.report);
    std::optional<Finding> found = check(after);
    if (!found && seconds_allowed > 0.0 && seconds > seconds_allowed)
      found = Finding{"step_time", seconds, seconds_allowed, k_,
                      std::to_string(after.report.impacts) + " impacts"};
    before_ = after;
    return found;
  }

 private:
  static double energyOf(const Snapshot& snapshot) {
    return snapshot.totals.kinetic_energy + snapshot.totals.potential_energy;
  }

  std::optional<Finding> check(const Snapshot& after) {
    if (auto found = checkFinite(after)) return found;
    if (auto found = checkPlanes(after)) return found;
    if (after.report.impacts > kMostImpacts)
      return Finding{"count", double(after.report.impacts), kMostImpacts, k_, "impacts"};
    const bool deep = overlapsDeeply(before_) || overlapsDeeply(after);
    deep_ = deep_ || deep;
    if (auto found = checkEnergy(after)) return found;
    if (!deep && !scene_.air && !scene_.fluid && !isTooFast(after))
      if (auto found = checkBalance(after)) return found;
    if (isExact(scene_))
      if (auto found = checkCertificate(after)) return found;
    // What overlaps at the start is the work of an edit; what comes to overlap later is not.
    if (isExact(scene_) && !overlapsDeeply(k_ == 1 ? after : before_))
      if (auto found = checkContacts(after)) return found;
    return {};
  }

  // Too fast for the most sub-steps of the soft step, which the exact settings fall back on.
  bool isTooFast(const Snapshot& after) const {
    for (const Snapshot* snapshot : {&before_, &after})
      for (std::size_t i = 0; i < after.states.size(); ++i) {
        const Twist& twist = snapshot->states[i].twist;
        const double turn = scene_.step * twist.w_WB.norm(), way = scene_.step * twist.v_WB.norm();
        if (turn > kTooFast || way > kTooFast * extentOf((*after.bodies)[i])) return true;
      }
    return false;
  }

  std::optional<Finding> checkFinite(const Snapshot& after) const {
    for (std::size_t i = 0; i < after.states.size(); ++i) {
      const BodyState& state = after.states[i];
      const double sum = state.pose.p_WB.sum() + state.pose.q_WB.coeffs().sum() + state.twist.v_WB.sum() +
                         state.twist.w_WB.sum();
      if (!std::isfinite(sum) || (*after.bodies)[i].frozen)
        return Finding{"finite", 1.0, 0.0, k_, (*after.bodies)[i].name + " is frozen or not finite"};
    }
    return {};
  }

  std::optional<Finding> checkPlanes(const Snapshot& after) const {
    for (std::size_t p = 0; p < after.states.size(); ++p) {
      const BodyDescription& plane = (*after.bodies)[p];
      if (!std::holds_alternative<Plane>(plane.shape) || plane.kind != BodyKind::Static) continue;
      const Vec3 up_W = after.states[p].pose.q_WB * Vec3::UnitZ();
      for (std::size_t i = 0; i < after.states.size(); ++i) {
        const BodyDescription& body = (*after.bodies)[i];
        if (body.kind != BodyKind::Dynamic) continue;
        const double below = -lowest(body, after.states[i].pose, up_W, after.states[p].pose.p_WB);
        const double before = -lowest(body, before_.states[i].pose, up_W, before_.states[p].pose.p_WB);
        const double rounding = 1e-9 * extentOf(body);
        const double allowed = 0.5 * extentOf(body) + rounding;
        if (below > allowed && below > before + rounding && !driven_ && !deep_)
          return Finding{"plane", below, allowed, k_, body.name + " is below " + plane.name};
      }
    }
    return {};
  }
  static double lowest(const BodyDescription& body, const Pose& X_WB, const Vec3& up_W, const Vec3& p_W) {
    return up_W.dot(X_WB.p_WB - p_W) - reach(body.shape, X_WB.q_WB.conjugate() * -up_W);
  }

  std::optional<Finding> checkEnergy(const Snapshot& after) {
    addWork(after);
    const double energy = energyOf(after) - work_;
    most_kinetic_ = std::max(most_kinetic_, after.totals.kinetic_energy);
    const double scale = most_kinetic_ + fall_;
    const double gain = scale > 0.0 ? (energy - least_) / scale : 0.0;
    least_ = std::min(least_, energy);
    const double allowed = kEnergy[static_cast<int>(scene_.fidelity.preset)];
    if (deep_ || scene_.air || scene_.fluid || gain <= allowed) return {};
    return Finding{"energy", gain, allowed, k_,
                   driven_ ? "beyond the work of what is kinematic" : "from the least so far"};
  }

  // The work of kinematic bodies in the step. An impulse r on a body does the work r u, where u is the velocity of the kinematic body at
  // the point. Reported are sums over the step, at one point. So where the carrier turns at w, u may be off by |w| h times itself, and
  // by |w| times the way of the point on the carrier, which may run round a rim; so much work is taken as done.
  void addWork(const Snapshot& after) {
    const double h = scene_.step;
    for (const ContactPoint& point : after.contacts) {
      const std::size_t a = after.find(point.a), b = after.find(point.b);
      const bool first = (*after.bodies)[a].kind == BodyKind::Kinematic;
      if (!first && (*after.bodies)[b].kind != BodyKind::Kinematic) continue;
      const BodyState& carrier = after.states[first ? a : b];
      const std::size_t moved = first ? b : a;
      const Vec3 impulse = (first ? 1.0 : -1.0) * (point.normal_impulse * point.n_W + point.friction_impulse);
      const Vec3& w_W = carrier.twist.w_WB;
      const Vec3 u_W = carrier.twist.v_WB + w_W.cross(point.p_W - carrier.pose.p_WB);
      const Twist& twist = after.states[moved].twist;
      const double way = h * speedOf((*after.bodies)[moved], {twist.v_WB - u_W, twist.w_WB - w_W});
      work_ += impulse.dot(u_W) + impulse.norm() * w_W.norm() * (h * u_W.norm() + way);
    }
  }

  std::optional<Finding> checkBalance(const Snapshot& after) const {
    std::map<BodyId, Vec3> sum;
    std::map<BodyId, double> size;
    for (const ContactPoint& point : after.contacts) {
      const Vec3 impulse = point.normal_impulse * point.n_W + point.friction_impulse;
      for (const auto& [body, sign] : {std::pair(point.a, -1.0), std::pair(point.b, 1.0)}) {
        sum.try_emplace(body, Vec3::Zero()).first->second += sign * impulse;
        size[body] += impulse.norm();
      }
    }
    for (std::size_t i = 0; i < after.states.size(); ++i) {
      const BodyDescription& body = (*after.bodies)[i];
      if (body.kind != BodyKind::Dynamic) continue;
      const Vec3 &v0 = before_.states[i].twist.v_WB, &v1 = after.states[i].twist.v_WB;
      const Vec3 given = body.mass * (v1 - v0 - scene_.gravity * scene_.step);
      const Vec3 reported = sum.count(body.id) ? sum[body.id] : Vec3::Zero();
      const double scale =
          size[body.id] + body.mass * (scene_.gravity.norm() * scene_.step + v0.norm() + v1.norm());
      if ((reported - given).norm() > kBalance * scale)
        return Finding{"balance", (reported - given).norm() / scale, kBalance, k_, body.name};
    }
    return {};
  }

  std::optional<Finding> checkCertificate(const Snapshot& after) const {
    for (const IslandResiduals& island : after.report.residuals) {
      const double worst = std::max({island.signorini, island.coulomb, island.dissipation});
      if (island.converged && !(worst <= kForgiven))
        return Finding{"certificate", worst, kForgiven, k_, std::string("residual of ") + island.method};
    }
    if (!hasConverged(after.report)) return {};
    const double unit = std::max(fastest(before_), fastest(after));
    const auto velocityAt = [&](std::size_t i, const Vec3& p_W) -> Vec3 {
      const BodyState& state = after.states[i];
      return state.twist.v_WB + state.twist.w_WB.cross(p_W - state.pose.p_WB);
    };
    std::set<std::pair<BodyId, BodyId>> seen;
    for (const ContactPoint& point : after.contacts) {
      if (!seen.emplace(point.a, point.b).second) continue;
      const std::size_t a = after.find(point.a), b = after.find(point.b);
      const BodyDescription &first = (*after.bodies)[a], &second = (*after.bodies)[b];
      const double length = std::min(extentOf(first), extentOf(second));
      const ClosestPoints closest = closestPoints(after, point.a, point.b);
      if (closest.distance > 1e-9 * length || closest.distance < -1e-6 * length) continue;
      const Vec3 p_W = 0.5 * (closest.p_WA + closest.p_WB);
      const double closing = closest.n_W.dot(velocityAt(a, p_W) - velocityAt(b, p_W)) / unit;
      const double w = (after.states[a].twist.w_WB - after.states[b].twist.w_WB).norm();
      const double of_rims = closingOfRim(first, w) + closingOfRim(second, w);
      const double allowed = std::min(kClosing + of_rims / unit, kDiscs);
      // What meets at the very end of a step and rebounds does so in the next one.
      const auto pushes = [&](const ContactPoint& other) {
        return other.a == point.a && other.b == point.b && other.normal_impulse > 0.0;
      };
      const bool will_rebound = std::max(first.material.restitution, second.material.restitution) > 0.0 &&
                                std::none_of(after.contacts.begin(), after.contacts.end(), pushes);
      if (closing > allowed && !will_rebound)
        return Finding{"certificate", closing, allowed, k_,
                       first.name + " and " + second.name + " touch and close"};
    }
    return {};
  }

  // Of the islands that converged. Only a plane has the same normal in the whole step: the impulses of other
  // pairs are sums over normals that the report does not tell.
  std::optional<Finding> checkContacts(const Snapshot& after) const {
    if (!hasConverged(after.report)) return {};
    for (const ContactPoint& point : after.contacts) {
      const BodyDescription &a = (*after.bodies)[after.find(point.a)],
                            &b = (*after.bodies)[after.find(point.b)];
      const std::string where = a.name + " and " + b.name;
      const double N = point.normal_impulse, friction = point.friction_impulse.norm();
      const double mu = std::sqrt(a.material.friction * b.material.friction);
      const bool plane = std::holds_alternative<Plane>(a.shape) || std::holds_alternative<Plane>(b.shape);
      if (plane && friction > (mu * (1.0 + kCone) + kCone) * N)
        return Finding{"cone", friction / N, mu, k_, where};
      const double depth = -point.separation / std::min(extentOf(a), extentOf(b));
      if (depth > overlap_ && depth > 1.001 * deepestBefore(point.a, point.b))
        return Finding{"overlap", depth, overlap_, k_, where};
    }
    return {};
  }
  double deepestBefore(BodyId a, BodyId b) const {
    const std::vector<BodyDescription>& bodies = *before_.bodies;
    double separation = 0.0;
    if (k_ == 1) separation = closestPoints(before_, a, b).distance;  // no contacts are known
    for (const ContactPoint& point : before_.contacts)
      if (point.a == a && point.b == b) separation = std::min(separation, point.separation);
    return -separation / std::min(extentOf(bodies[before_.find(a)]), extentOf(bodies[before_.find(b)]));
  }

  SceneDef scene_;
  double overlap_;
  World world_;
  Snapshot before_;
  int k_ = 0;
  bool driven_ = false, deep_ = false, reached_limits_ = false;
  double fall_ = 0.0, work_ = 0.0, least_ = 0.0, most_kinetic_ = 0.0;
};

// Units of which all products that occur, and their square roots and fourth roots, are powers of two: none
// rounds. Accelerations keep their numbers, and so does the gravity of the Earth, which stands in for none.
constexpr double kMetre = 0x1p-8, kSecond = 0x1p-4, kKilogram = 0x1p-20;

SceneDef inOtherUnits(SceneDef scene) {
  scene.step *= kSecond;
  scene.gravity *= kMetre / (kSecond * kSecond);
  const double density = kKilogram / (kMetre * kMetre * kMetre);
  if (scene.air) scene.air->density *= density;
  for (BodyDef& body : scene.bodies) {
    body.shape = scaled(body.shape, kMetre);
    body.pose.p_WB *= kMetre;
    body.twist = {body.twist.v_WB * (kMetre / kSecond), body.twist.w_WB / kSecond};
    if (body.density) *body.density *= density;
    if (body.mass) *body.mass *= kKilogram;
    if (!body.density && !body.mass && !std::holds_alternative<Plane>(body.shape))
      body.density = kDefaultDensity * density;
  }
  return scene;
}

// The largest difference of two runs, in shares of the largest coordinate.
double difference(const Snapshot& a, const Snapshot& b, double metre) {
  double largest = 1e-300, most = 0.0;
  for (std::size_t i = 0; i < a.states.size(); ++i) {
    const Vec3 &p = a.states[i].pose.p_WB, q = b.states[i].pose.p_WB / metre;
    largest = std::max(largest, p.norm());
    most = std::max(most, (p - q).norm());
  }
  return most / largest;
}

// Across the plane x = 0: of a vector, and of an axial one.
Vec3 mirrored(const Vec3& v) {
  return {-v.x(), v.y(), v.z()};
}
Twist mirrored(const Twist& twist) {
  return {mirrored(twist.v_WB), -mirrored(twist.w_WB)};
}

SceneDef mirrored(SceneDef scene) {
  scene.gravity = mirrored(scene.gravity);
  for (BodyDef& body : scene.bodies) {
    const Quat q = body.pose.q_WB;
    body.pose = {mirrored(body.pose.p_WB), Quat(q.w(), q.x(), -q.y(), -q.z())};
    body.twist = mirrored(body.twist);
    if (const auto* hull = std::get_if<ConvexHull>(&body.shape)) {  // the other shapes are their own image
      std::vector<Vec3> corners = hull->polyhedron->vertices;
      for (Vec3& corner : corners) corner = mirrored(corner);
      const PlacedHull placed = makeHull(corners, body.name);
      body.shape = placed.hull;
      body.pose = placed.poseOfB(body.pose);
    }
  }
  return scene;
}

SceneDef reordered(SceneDef scene) {
  std::reverse(scene.bodies.begin(), scene.bodies.end());
  return scene;
}

// By how much the velocities of two runs differ, in shares of the largest.
double apart(const Snapshot& a, const Snapshot& b, bool is_mirrored) {
  double most = 0.0;
  for (std::size_t i = 0; i < a.states.size(); ++i) {
    const BodyDescription& body = (*a.bodies)[i];
    if (body.kind != BodyKind::Dynamic) continue;
    const Twist& one = a.states[i].twist;
    Twist other = b.states[b.find(body.name)].twist;
    if (is_mirrored) other = mirrored(other);
    most = std::max(most, speedOf(body, {one.v_WB - other.v_WB, one.w_WB - other.w_WB}));
  }
  return most / fastest(a);
}

std::optional<Finding> brokenSymmetry(const SceneDef& scene, int steps) {
  for (const bool mirror : {true, false}) {
    World world(scene), other(mirror ? mirrored(scene) : reordered(scene));
    for (int k = 1; k <= std::min(steps, kSymmetrySteps); ++k) {
      world.step();
      other.step();
      const Snapshot a = world.snapshot(), b = other.snapshot();
      const double difference = apart(a, b, mirror);
      const bool comparable =
          hasConverged(a.report) && hasConverged(b.report) && a.report.impacts == 0 && b.report.impacts == 0;
      if (comparable && difference > kSymmetry)
        return Finding{mirror ? "mirrored" : "reordered", difference, kSymmetry, k, "of the velocities"};
      if (difference > kAlike) break;
    }
  }
  return {};
}

}  // namespace

std::string text(const Finding& finding) {
  std::ostringstream line;
  line.precision(3);
  line << finding.invariant << ": " << finding.figure << " in step " << finding.step << ", "
       << finding.allowed << " allowed (" << finding.detail << ")";
  return line.str();
}

std::optional<Finding> firstBroken(const SceneDef& scene, const Demands& demands) {
  Run run(scene, demands.overlap);
  std::optional<World> resumed;
  for (int k = 1; k <= demands.steps; ++k) {
    if (auto found = run.step(demands.seconds_per_step)) return found;
    if (resumed) resumed->step();
    if (k == demands.steps / 2) {
      const std::string saved = writeScene(run.world().capture(), run.world().captureState());
      const SceneFile file = parseScene(saved, "saved.yaml");
      resumed.emplace(file.scene, file.state);
    }
  }
  const Snapshot end = run.world().snapshot();
  if (resumed && resumed->stateHash() != end.hash)
    return Finding{"restored", difference(end, resumed->snapshot(), 1.0), 0.0, demands.steps,
                   "saved at half time"};
  if (isExact(scene))
    if (auto found = brokenSymmetry(scene, demands.steps)) return found;
  if (run.reachedLimits()) return {};
  World other(inOtherUnits(scene));
  for (int k = 1; k <= demands.steps; ++k)
    if (reachesLimits(other.step())) return {};
  const double apart = difference(end, other.snapshot(), kMetre);
  if (apart > 0.0) return Finding{"units", apart, 0.0, demands.steps, "of the positions at the end"};
  return {};
}

namespace {

// The largest distance of a body in two snapshots, in its bounding radii.
double distanceOf(const Snapshot& a, const Snapshot& b) {
  double most = 0.0;
  for (std::size_t i = 0; i < a.states.size(); ++i) {
    const BodyDescription& body = (*a.bodies)[i];
    if (body.kind != BodyKind::Dynamic) continue;
    most =
        std::max(most, (a.states[i].pose.p_WB - b.states[i].pose.p_WB).norm() / boundingRadius(body.shape));
  }
  return most;
}

}  // namespace

std::optional<double> stepError(const SceneDef& scene, int coarse, int fine) {
  constexpr double kOff = 1e-10, kFar = 1e-3;
  World before(scene);
  for (int k = 0; k < 4; ++k) before.step();
  const SceneDef start = before.capture();
  const auto endOf = [](SceneDef divided, int parts) -> std::optional<Snapshot> {
    divided.step /= parts;
    World world(divided);
    for (int k = 0; k < parts; ++k)
      if (!hasConverged(world.step())) return {};
    return world.snapshot();
  };
  SceneDef off = start;
  for (std::size_t k = 0; k < off.bodies.size(); ++k)
    if (BodyDef& body = off.bodies[k]; body.kind == BodyKind::Dynamic)
      body.pose.p_WB += kOff * boundingRadius(body.shape) * Vec3(k % 2 ? 1.0 : -1.0, k % 3 ? 1.0 : -1.0, 1.0);
  const std::optional<Snapshot> end = endOf(start, coarse), wanted = endOf(start, fine),
                                other = endOf(off, fine);
  if (!end || !wanted || !other || distanceOf(*wanted, *other) > kFar) return {};
  return distanceOf(*end, *wanted);
}

}  // namespace rbs::hunt
