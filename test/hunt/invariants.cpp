// SPDX-License-Identifier: BSD-3-Clause
#include "invariants.h"

#include "rigid_body_sim/scenes.h"
#include "rigid_body_sim/shape.h"
#include "rigid_body_sim/world.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <map>
#include <sstream>

namespace rbs::hunt {

namespace {

// Of the energy, by setting: what a step may add. docs/stability.md says where these come from.
constexpr double kEnergy[] = {5e-2, 2e-2, 2e-2, 2e-2};
constexpr double kBalance = 1e-10;  // of the impulses on a body
constexpr double kCone = 1e-6;      // of mu times the normal impulse
constexpr double kTooFast = 30.0;   // rad in a step, or smallest extents
constexpr double kDeep = 0.05;      // of the smaller extent of a pair: deeper ones are the work of an edit

bool isExact(const SceneDef& scene) {
  return scene.fidelity.preset >= Fidelity::Accurate;
}

double extentOf(const BodyDescription& body) {
  const double least = fullExtents(body.shape).minCoeff();
  return least > 0.0 ? least : std::numeric_limits<double>::infinity();
}

bool overlapsDeeply(const Snapshot& snapshot) {
  return std::any_of(snapshot.contacts.begin(), snapshot.contacts.end(), [&](const ContactPoint& point) {
    const double least = std::min(extentOf((*snapshot.bodies)[snapshot.find(point.a)]),
                                  extentOf((*snapshot.bodies)[snapshot.find(point.b)]));
    return point.separation < -kDeep * least;
  });
}

// Whether a body has come to the limits of speeds, which have units.
bool reachesLimits(const StepReport& report) {
  return std::any_of(report.warnings.begin(), report.warnings.end(),
                     [](const Warning& warning) { return warning.kind == "too_fast"; });
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
    const bool deep = overlapsDeeply(before_) || overlapsDeeply(after);
    deep_ = deep_ || deep;
    if (auto found = checkEnergy(after)) return found;
    if (!deep && !scene_.air && !scene_.fluid && !isTooFast(after))
      if (auto found = checkBalance(after)) return found;
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
        const double allowed = 0.5 * extentOf(body) * (1.0 + 1e-9);
        if (below > allowed && below > before && !driven_ && !deep_)
          return Finding{"plane", below, allowed, k_, body.name + " is below " + plane.name};
      }
    }
    return {};
  }
  static double lowest(const BodyDescription& body, const Pose& X_WB, const Vec3& up_W, const Vec3& p_W) {
    return up_W.dot(X_WB.p_WB - p_W) - reach(body.shape, X_WB.q_WB.conjugate() * -up_W);
  }

  std::optional<Finding> checkEnergy(const Snapshot& after) {
    const double energy = energyOf(after);
    most_kinetic_ = std::max(most_kinetic_, after.totals.kinetic_energy);
    const double scale = most_kinetic_ + fall_;
    const double gain = scale > 0.0 ? (energy - least_) / scale : 0.0;
    least_ = std::min(least_, energy);
    const double allowed = kEnergy[static_cast<int>(scene_.fidelity.preset)];
    if (driven_ || deep_ || scene_.air || scene_.fluid || gain <= allowed) return {};
    return Finding{"energy", gain, allowed, k_, "from the least so far"};
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

  // Of the islands that converged. Only a plane has the same normal in the whole step: the impulses of other
  // pairs are sums over normals that the report does not tell.
  std::optional<Finding> checkContacts(const Snapshot& after) const {
    if (!std::all_of(after.report.residuals.begin(), after.report.residuals.end(),
                     [](const IslandResiduals& island) { return island.converged; }))
      return {};
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
    double depth = 0.0;
    for (const ContactPoint& point : before_.contacts)
      if (point.a == a && point.b == b)
        depth = std::max(depth, -point.separation / std::min(extentOf((*before_.bodies)[before_.find(a)]),
                                                             extentOf((*before_.bodies)[before_.find(b)])));
    return depth;
  }

  SceneDef scene_;
  double overlap_;
  World world_;
  Snapshot before_;
  int k_ = 0;
  bool driven_ = false, deep_ = false, reached_limits_ = false;
  double fall_ = 0.0, least_ = 0.0, most_kinetic_ = 0.0;
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
  if (run.reachedLimits()) return {};
  World other(inOtherUnits(scene));
  for (int k = 1; k <= demands.steps; ++k)
    if (reachesLimits(other.step())) return {};
  const double apart = difference(end, other.snapshot(), kMetre);
  if (apart > 0.0) return Finding{"units", apart, 0.0, demands.steps, "of the positions at the end"};
  return {};
}

}  // namespace rbs::hunt
