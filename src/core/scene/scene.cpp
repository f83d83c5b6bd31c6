// SPDX-License-Identifier: BSD-3-Clause
// The check that finds every fault of a scene, and the words for its enumerators.
#include "rigid_body_sim/scene.h"

#include "base/checks.h"
#include "base/number_text.h"
#include "base/text.h"
#include "rigid_body_sim/quote.h"
#include "state/scene_fields.h"

#include <cmath>
#include <iterator>
#include <set>

namespace rbs {
namespace {

constexpr std::size_t kLongestName = 64;

std::string range(double low, double high, const std::string& unit) {
  return numberText(low) + " to " + numberText(high) + (unit.empty() ? "" : " " + unit);
}

/// Collects faults. A comparison is written so that NaN fails it.
class Faults {
 public:
  void add(const std::string& path, const std::string& value, const std::string& allowed) {
    problems_.push_back({path, value, allowed});
  }
  void number(const std::string& path, double x, double low, double high, const std::string& unit = "") {
    if (!(x >= low && x <= high)) add(path, numberText(x), range(low, high, unit));
  }
  void vector(const std::string& path, const Vec3& v, double longest, const std::string& unit) {
    if (!(v.norm() <= longest))
      add(path, vectorText(v), "finite, of a length of at most " + numberText(longest) + " " + unit);
  }
  void within(const std::string& path, double x, const Range& range) {
    number(path, x, range.low, range.high, range.unit);
  }
  void within(const std::string& path, const Vec3& v, const Range& range) {
    vector(path, v, range.high, range.unit);
  }
  void append(std::vector<Problem> more) {
    problems_.insert(problems_.end(), std::make_move_iterator(more.begin()),
                     std::make_move_iterator(more.end()));
  }
  std::vector<Problem> take() { return std::move(problems_); }

 private:
  std::vector<Problem> problems_;
};

bool isLetter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}
bool isDigit(char c) {
  return c >= '0' && c <= '9';
}

/// What a body's name breaks; empty for a sound one. It is the name of a frame of tf too, where "/" parts
/// levels and may not come first, and an argument of command lines, where "-" begins an option.
std::string faultOfName(const std::string& name) {
  if (name.empty()) return "";
  if (name.size() > kLongestName) return "at most 64 characters, not " + std::to_string(name.size());
  for (const char c : name) {
    if (!isLetter(c) && !isDigit(c) && c != '_' && c != '-' && c != '/')
      return "letters, digits, '_', '-' and '/'";
  }
  if (!isLetter(name[0]) && name[0] != '_') return "a letter or '_' first";
  if (name.back() == '/' || name.find("//") != std::string::npos) return "names between '/', not empty ones";
  if (name == kWorldName || name == worldFrame() || framePrefix() + name == worldFrame()) {
    return "another name than that of the world's frame";
  }
  return "";
}

bool hasSoundSize(const Shape& shape) {
  if (const auto* hull = std::get_if<ConvexHull>(&shape); hull && !hull->polyhedron) return false;
  if (const auto* capsule = std::get_if<Capsule>(&shape); capsule && !(capsule->half_length >= 0.0))
    return false;
  const Vec3 size = fullExtents(shape);
  return size.allFinite() && size.minCoeff() >= Limits::min_size && size.maxCoeff() <= Limits::max_size;
}

void checkShape(const BodyDef& body, const std::string& path, Faults& faults) {
  if (std::holds_alternative<Plane>(body.shape)) {
    if (body.kind == BodyKind::Dynamic) {
      faults.add(path + ".kind", "dynamic", "static or kinematic: a plane has no mass");
    }
    if (body.mass || body.density) {
      faults.add(path + (body.mass ? ".mass" : ".density"),
                 numberText(body.mass ? *body.mass : *body.density), "nothing: a plane has no mass");
    }
    return;
  }
  if (hasSoundSize(body.shape)) return;
  const auto* hull = std::get_if<ConvexHull>(&body.shape);
  if (hull && !hull->polyhedron) return faults.add(path + ".points", "", "a hull of makeHull()");
  const Vec3 size = fullExtents(body.shape);
  const bool is_ball = std::holds_alternative<Sphere>(body.shape);
  faults.add(path + (hull ? ".points" : ".size"), is_ball ? numberText(size.x()) : vectorText(size),
             (is_ball ? "a diameter of " : "extents of ") + range(Limits::min_size, Limits::max_size, "m"));
}

void checkMotion(const BodyDef& body, const std::string& path, Faults& faults) {
  faults.vector(path + ".position", body.pose.p_WB, Limits::max_position, "m from the origin");
  if (!isOrientation(body.pose.q_WB)) {
    const auto& q = body.pose.q_WB.coeffs();
    faults.add(path + ".orientation",
               "[" + numberText(q[0]) + ", " + numberText(q[1]) + ", " + numberText(q[2]) + ", " +
                   numberText(q[3]) + "]",
               "a quaternion [x, y, z, w] of norm " + range(kMinQuaternionNorm, kMaxQuaternionNorm, "") +
                   ", which is normalised on use");
  }
  faults.vector(path + ".velocity", body.twist.v_WB, Limits::max_speed, "m/s");
  faults.vector(path + ".spin", body.twist.w_WB, Limits::max_spin, "rad/s");
  if (body.kind == BodyKind::Static) {
    const std::string allowed = "zero: a static body never moves (kinematic bodies do)";
    if (!body.twist.v_WB.isZero(0.0)) faults.add(path + ".velocity", vectorText(body.twist.v_WB), allowed);
    if (!body.twist.w_WB.isZero(0.0)) faults.add(path + ".spin", vectorText(body.twist.w_WB), allowed);
  }
}

void checkMass(const BodyDef& body, const std::string& path, Faults& faults) {
  if (std::holds_alternative<Plane>(body.shape)) return;
  if (body.mass) faults.number(path + ".mass", *body.mass, Limits::min_mass, Limits::max_mass, "kg");
  if (body.density) {
    faults.number(path + ".density", *body.density, Limits::min_density, Limits::max_density, "kg/m^3");
  }
  if (body.mass && body.density) {
    faults.add(path + ".density", numberText(*body.density), "at most one of mass and density");
  }
  if (body.mass || body.kind != BodyKind::Dynamic || !hasSoundSize(body.shape)) return;
  const double density = body.density.value_or(kDefaultDensity);
  if (!(density >= Limits::min_density && density <= Limits::max_density)) return;
  const double mass = density * volume(body.shape);
  if (mass < Limits::min_mass || mass > Limits::max_mass) {
    faults.add(path + ".size", vectorText(fullExtents(body.shape)),
               "with its density a mass of " + range(Limits::min_mass, Limits::max_mass, "kg") + ", not " +
                   numberText(mass) + " kg");
  }
}

void checkMaterial(const Material& material, const std::string& path, Faults& faults) {
  faults.number(path + ".friction", material.friction, 0.0, Limits::max_friction);
  faults.number(path + ".restitution", material.restitution, 0.0, 1.0);
  if (material.drag_coefficient) {
    faults.number(path + ".drag_coefficient", *material.drag_coefficient, 0.0, Limits::max_drag);
  }
  faults.number(path + ".rolling_resistance", material.rolling_resistance, 0.0, Limits::max_resistance);
  faults.number(path + ".torsional_resistance", material.torsional_resistance, 0.0, Limits::max_resistance);
}

void checkColor(const Color& color, const std::string& path, Faults& faults) {
  static const char* const channels[] = {"red", "green", "blue", "alpha"};
  for (std::size_t i = 0; i < color.size(); ++i) {
    if (!(color[i] >= 0.0f && color[i] <= 1.0f)) {
      faults.add(path, numberText(color[i]), std::string(channels[i]) + " from 0 to 1");
    }
  }
}

void checkSurroundings(const SceneDef& scene, Faults& faults) {
  faults.vector("gravity", scene.gravity, Limits::max_gravity, "m/s^2");
  faults.number("step", scene.step, Limits::min_step, Limits::max_step, "s");
  faults.append(validate(scene.fidelity));
  if (scene.goal) faults.append(validate(*scene.goal));
  if (scene.wind && !scene.air)
    faults.add("wind", vectorText(scene.wind->velocity), "only together with air");
  forEachSurrounding([&](const std::string& key, auto surrounding, auto type) {
    if (!(scene.*surrounding)) return;
    forEachField(type, [&](const char* name, auto field, const Range& range) {
      faults.within(key + "." + name, *(scene.*surrounding).*field, range);
    });
  });
  faults.vector("view.eye", scene.view.eye, Limits::max_position, "m from the origin");
  faults.vector("view.target", scene.view.target, Limits::max_position, "m from the origin");
  if (scene.view.eye == scene.view.target) {
    faults.add("view.target", vectorText(scene.view.target), "another place than view.eye");
  }
}

void checkNamesDiffer(const std::vector<BodyDef>& bodies, Faults& faults) {
  std::set<std::string> names;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (bodies[i].name.empty()) continue;
    if (!names.insert(bodies[i].name).second) {
      faults.add("bodies[" + std::to_string(i) + "].name", quoted(bodies[i].name),
                 "unique names; an earlier body has this one");
    }
  }
}

std::string describe(const Problem& problem) {
  if (problem.value.empty()) return problem.path + "; " + problem.allowed;
  return problem.path + ": " + problem.value + " (allowed: " + problem.allowed + ")";
}

/// One line a problem; after the first few only their number.
std::string describe(const std::vector<Problem>& problems) {
  constexpr std::size_t most = 20;
  std::string text;
  for (std::size_t i = 0; i < problems.size() && i < most; ++i) {
    text += (i == 0 ? "" : "\n") + describe(problems[i]);
  }
  if (problems.size() > most) text += "\nand " + std::to_string(problems.size() - most) + " more";
  return text;
}

}  // namespace

namespace {

/// Whatever a user wrote, the message is short and can be sent and shown.
std::vector<Problem> shortened(std::vector<Problem> problems) {
  for (Problem& problem : problems) {
    problem.path = printable(problem.path, 2 * kLongestPath);
    problem.value = printable(problem.value, 2 * kLongestPath);
  }
  return problems;
}

}  // namespace

InvalidInput::InvalidInput(std::vector<Problem> problems) : InvalidInput(shortened(std::move(problems)), 0) {}

InvalidInput::InvalidInput(std::vector<Problem> problems, int)
    : std::invalid_argument(describe(problems)), problems_(std::move(problems)) {}

namespace {

struct Frames {
  std::string world = kWorldName, prefix;
};

Frames& frames() {
  static Frames names;
  return names;
}

/// Whether tf takes it: letters, digits and '_', '-', '/', of which the last neither begins it nor follows
/// itself.
bool isFrameName(const std::string& name) {
  for (const char c : name)
    if (!isLetter(c) && !isDigit(c) && c != '_' && c != '-' && c != '/') return false;
  return name.size() <= kLongestName && name.substr(0, 1) != "/" && name.find("//") == std::string::npos;
}

}  // namespace

void nameFrames(const std::string& world, const std::string& prefix) {
  std::vector<Problem> problems;
  const std::string allowed = "letters, digits, '_', '-' and single '/', at most 64, not '/' first";
  if (world.empty() || world.back() == '/' || !isFrameName(world)) {
    problems.push_back({"world_frame", quoted(world), allowed + " or last"});
  }
  if (!isFrameName(prefix)) problems.push_back({"tf_prefix", quoted(prefix), allowed});
  if (!problems.empty()) throw InvalidInput(problems);
  frames() = {world, prefix};
}

const std::string& worldFrame() {
  return frames().world;
}

const std::string& framePrefix() {
  return frames().prefix;
}

const char* kindName(BodyKind kind) {
  switch (kind) {
    case BodyKind::Dynamic:
      return "dynamic";
    case BodyKind::Static:
      return "static";
    case BodyKind::Kinematic:
      return "kinematic";
  }
  return "";
}

double defaultDragCoefficient(const Shape& shape) {
  const ShapeTraits traits = traitsOf(shape);
  if (traits.unbounded) return 0.0;
  return traits.edged ? kEdgedDrag : kRoundedDrag;
}

const char* fidelityName(Fidelity fidelity) {
  switch (fidelity) {
    case Fidelity::Preview:
      return "preview";
    case Fidelity::Interactive:
      return "interactive";
    case Fidelity::Accurate:
      return "accurate";
    case Fidelity::Reference:
      return "reference";
  }
  return "";
}

Fidelity fidelityNamed(const std::string& name) {
  for (const Fidelity fidelity : kFidelities)
    if (name == fidelityName(fidelity)) return fidelity;
  throw InvalidInput({{"fidelity", quoted(name), "preview, interactive, accurate or reference"}});
}

std::string settingName(const Setting& setting) {
  std::string name = fidelityName(setting.preset);
  if (setting.divisions > 1) name += ", " + std::to_string(setting.divisions) + " divisions";
  if (setting.sub_steps) name += ", " + count(*setting.sub_steps, "sub-step", "sub-steps");
  if (setting.tolerance) name += ", tolerance " + numberText(*setting.tolerance);
  if (setting.max_solve_ms) name += ", solves of at most " + numberText(*setting.max_solve_ms) + " ms";
  return name;
}

const char* effectName(Effect effect) {
  return kEffectNames[static_cast<std::size_t>(effect)];
}

Effect effectNamed(const std::string& name) {
  std::string names;
  for (const Effect effect : kEffects) {
    if (name == effectName(effect)) return effect;
    names += (names.empty() ? "" : ", ") + std::string(effectName(effect));
  }
  throw InvalidInput({{"effect", quoted(name), names}});
}

std::vector<Problem> validate(const Setting& setting) {
  Faults faults;
  faults.number("fidelity.divisions", setting.divisions, 1, Limits::max_divisions);
  if (setting.sub_steps) faults.number("fidelity.sub_steps", *setting.sub_steps, 1, Limits::max_sub_steps);
  if (setting.tolerance)
    faults.number("fidelity.tolerance", *setting.tolerance, Limits::min_tolerance, Limits::max_tolerance);
  if (setting.max_solve_ms)
    faults.number("fidelity.max_solve_ms", *setting.max_solve_ms, Limits::min_solve_ms, Limits::max_solve_ms,
                  "ms");
  return faults.take();
}

std::vector<Problem> validate(const Goal& goal) {
  Faults faults;
  if (goal.max_error.has_value() == goal.max_step_ms.has_value())
    faults.add("fidelity",
               goal.max_error ? "both max_error and max_step_ms" : "neither max_error nor max_step_ms",
               "exactly one of them");
  if (goal.max_error)
    faults.number("fidelity.max_error", *goal.max_error, Limits::min_goal, Limits::max_goal, "m per second");
  if (goal.max_step_ms)
    faults.number("fidelity.max_step_ms", *goal.max_step_ms, Limits::min_goal, Limits::max_goal, "ms");
  return faults.take();
}

std::vector<Problem> validate(const BodyDef& body, const std::string& path) {
  Faults faults;
  if (const std::string fault = faultOfName(body.name); !fault.empty()) {
    faults.add(path + ".name", quoted(body.name), fault);
  }
  checkShape(body, path, faults);
  checkMotion(body, path, faults);
  checkMass(body, path, faults);
  checkMaterial(body.material, path + ".material", faults);
  if (body.color) checkColor(*body.color, path + ".color", faults);
  return faults.take();
}

std::vector<Problem> validate(const SceneDef& scene) {
  Faults faults;
  checkSurroundings(scene, faults);
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    faults.append(validate(scene.bodies[i], "bodies[" + std::to_string(i) + "]"));
  }
  checkNamesDiffer(scene.bodies, faults);
  return faults.take();
}

}  // namespace rbs
