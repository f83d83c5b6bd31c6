// SPDX-License-Identifier: BSD-3-Clause
// Writing scene files. A number is written with as many digits as it takes to read it back bit for bit;
// what has the default's very bits is left out.
#include "base/number_text.h"
#include "rigid_body_sim/scenes.h"
#include "scene/scene_limits.h"
#include "scene/scene_text.h"
#include "state/scene_fields.h"

#include <cstdio>
#include <cstring>

namespace rbs {
namespace scene_text {

bool sameBits(double a, double b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}
bool sameBits(const Vec3& a, const Vec3& b) {
  return sameBits(a.x(), b.x()) && sameBits(a.y(), b.y()) && sameBits(a.z(), b.z());
}
bool sameBits(const Quat& a, const Quat& b) {
  return sameBits(a.x(), b.x()) && sameBits(a.y(), b.y()) && sameBits(a.z(), b.z()) && sameBits(a.w(), b.w());
}

std::string text(double number) {
  return numberText(number);
}
std::string text(std::uint32_t number) {
  return std::to_string(number);
}
std::string text(std::uint64_t number) {
  return std::to_string(number);
}
std::string text(const Vec3& v) {
  return vectorText(v);
}
std::string text(const Quat& q) {
  return "[" + text(q.x()) + ", " + text(q.y()) + ", " + text(q.z()) + ", " + text(q.w()) + "]";
}
std::string text(const Color& c) {
  return "[" + numberText(c[0]) + ", " + numberText(c[1]) + ", " + numberText(c[2]) + ", " +
         numberText(c[3]) + "]";
}

std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      result += {'\\', c};
    } else if (byte < 0x20 || byte == 0x7f) {
      char escape[8];
      std::snprintf(escape, sizeof escape, "\\x%02x", byte);
      result += escape;
    } else {
      result += c;
    }
  }
  return result + "\"";
}

std::string text(const std::vector<Vec3>& points) {
  std::string result;
  for (const Vec3& p : points) result += (result.empty() ? "" : ", ") + text(p);
  return "[" + result + "]";
}

void addFields(Line& line, const Grab& grab) {
  line.add("p_B", text(grab.p_B))
      .add("p_W", text(grab.p_W))
      .add("frequency", text(grab.frequency))
      .add("max_acceleration", text(grab.max_acceleration));
}

void addFields(Line& line, const Pose& pose) {
  line.add("position", text(pose.p_WB)).add("orientation", text(pose.q_WB));
}

void addFields(Line& line, const Twist& twist) {
  line.add("velocity", text(twist.v_WB)).add("spin", text(twist.w_WB));
}

void addFields(Line& line, const Shape& shape) {
  line.add("shape", shapeName(shape));
  if (const auto* capsule = std::get_if<Capsule>(&shape)) {
    line.add("size", text(2.0 * capsule->radius)).add("half_length", text(capsule->half_length));
  } else if (const auto* hull = std::get_if<ConvexHull>(&shape)) {
    line.add("points", text(hull->polyhedron->vertices));
  } else if (std::holds_alternative<Sphere>(shape)) {
    line.add("size", text(fullExtents(shape).x()));
  } else if (!std::holds_alternative<Plane>(shape)) {
    line.add("size", text(fullExtents(shape)));
  }
}

std::string text(const BodyDef& body) {
  static const BodyDef usual;
  Line line;
  if (!body.name.empty()) line.add("name", quoted(body.name));
  addFields(line, body.shape);
  if (body.kind != usual.kind) line.add("kind", kindName(body.kind));
  line.addUnless(usual.pose.p_WB, "position", body.pose.p_WB)
      .addUnless(usual.pose.q_WB, "orientation", body.pose.q_WB)
      .addUnless(usual.twist.v_WB, "velocity", body.twist.v_WB)
      .addUnless(usual.twist.w_WB, "spin", body.twist.w_WB)
      .addGiven("mass", body.mass)
      .addGiven("density", body.density)
      .addUnless(usual.material.friction, "friction", body.material.friction)
      .addUnless(usual.material.restitution, "restitution", body.material.restitution)
      .addGiven("drag_coefficient", body.material.drag_coefficient)
      .addUnless(usual.material.rolling_resistance, "rolling_resistance", body.material.rolling_resistance)
      .addUnless(usual.material.torsional_resistance, "torsional_resistance",
                 body.material.torsional_resistance)
      .addGiven("color", body.color);
  if (body.group != usual.group) line.add("group", text(body.group));
  if (body.mask != usual.mask) line.add("mask", text(body.mask));
  return line.close();
}

std::string text(const std::vector<BodyDef>& bodies) {
  std::string result;
  for (const BodyDef& body : bodies) result += (result.empty() ? "" : ", ") + text(body);
  return "[" + result + "]";
}

std::string text(const Setting& setting, const std::optional<Goal>& goal) {
  if (setting == Setting(setting.preset) && !goal) return fidelityName(setting.preset);
  Line line;
  line.add("preset", fidelityName(setting.preset));
  if (setting.divisions != 1) line.add("divisions", std::to_string(setting.divisions));
  if (setting.sub_steps) line.add("sub_steps", std::to_string(*setting.sub_steps));
  line.addGiven("tolerance", setting.tolerance).addGiven("max_solve_ms", setting.max_solve_ms);
  if (goal) line.addGiven("max_error", goal->max_error).addGiven("max_step_ms", goal->max_step_ms);
  return line.close();
}

std::string text(const EffectOverrides& effects) {
  Line line;
  for (const auto& [effect, on] : effects) line.add(effectName(effect), on ? "on" : "off");
  return line.close();
}

}  // namespace scene_text

namespace {

using namespace scene_text;

std::string contactText(const SavedState::Contact& contact) {
  std::string points;
  for (const SavedState::Contact::Point& point : contact.points) {
    points += points.empty() ? "" : ", ";
    points += Line()
                  .add("feature", text(point.feature))
                  .add("normal", text(point.normal))
                  .add("tangent", text(point.tangent_W))
                  .close();
  }
  Line line;
  line.add("a", text(contact.a)).add("b", text(contact.b));
  if (contact.exact) line.add("exact", "1");
  line.add("normal", text(contact.n_W));
  if (contact.depth > 0.0) line.add("depth", text(contact.depth));
  if (contact.touching_steps > 0) line.add("touching", text(contact.touching_steps));
  return line.add("points", "[" + points + "]").close();
}

std::string userForcesText(const SavedState& state) {
  std::string result;
  if (!state.grabs.empty()) result += "  grabs:\n";
  for (const SavedState::Grabbed& grabbed : state.grabs) {
    Line line;
    line.add("body", text(grabbed.body));
    addFields(line, grabbed.grab);
    result += "    - " + line.close() + "\n";
  }
  if (!state.holds.empty()) result += "  holds:\n";
  for (const SavedState::Held& held : state.holds) {
    Line line;
    line.add("body", text(held.body));
    addFields(line, held.target);
    addFields(line, held.twist);
    result += "    - " + line.close() + "\n";
  }
  if (!state.frozen.empty()) result += "  frozen:\n";
  for (const SavedState::Frozen& frozen : state.frozen) {
    Line line;
    line.add("body", text(frozen.body));
    if (frozen.kinematic) line.add("kinematic", "1");
    result += "    - " + line.close() + "\n";
  }
  return result;
}

std::string stateText(const SavedState& state) {
  std::string result = "state:\n  time: " + text(state.time) + "\n  steps: " + text(state.steps) + "\n";
  if (!state.contacts.empty()) result += "  contacts:\n";
  for (const SavedState::Contact& contact : state.contacts) result += "    - " + contactText(contact) + "\n";
  if (!state.orientations.empty()) result += "  orientations:\n";
  for (const SavedState::Orientation& orientation : state.orientations)
    result += "    - " +
              Line()
                  .add("body", text(orientation.body))
                  .add("since", text(orientation.since))
                  .add("orientation", text(orientation.q_WB))
                  .close() +
              "\n";
  if (!state.rest.empty()) result += "  rest:\n";
  for (const SavedState::Rest& rest : state.rest) {
    Line line;
    line.add("body", text(rest.body)).add("steps", text(rest.steps));
    if (rest.asleep_with) line.add("asleep_with", text(*rest.asleep_with));
    result += "    - " + line.close() + "\n";
  }
  if (!state.wrenches.empty()) result += "  wrenches:\n";
  for (const SavedState::Wrench& wrench : state.wrenches) {
    Line line;
    line.add("body", text(wrench.body))
        .add("force", text(wrench.force_W))
        .add("torque", text(wrench.torque_W))
        .add("point", text(wrench.point_B))
        .add("until", text(wrench.until));
    if (wrench.commanded) line.add("commanded", "1");
    result += "    - " + line.close() + "\n";
  }
  return result + userForcesText(state);
}

std::string headText(const SceneDef& scene) {
  std::string result = "name: " + quoted(scene.name) + "\nproperty: " + quoted(scene.property) +
                       "\ngravity: " + text(scene.gravity) + "\nstep: " + text(scene.step) +
                       "\nfidelity: " + text(scene.fidelity, scene.goal) + "\nseed: " + text(scene.seed) +
                       "\n";
  forEachSurrounding([&](const char* key, auto surrounding, auto) {
    if (!(scene.*surrounding)) return;
    result += key + (": " + text(*(scene.*surrounding)) + "\n");
  });
  if (!scene.effects.empty()) result += "effects: " + text(scene.effects) + "\n";
  return result +
         "view: " + Line().add("eye", text(scene.view.eye)).add("target", text(scene.view.target)).close() +
         "\n";
}

}  // namespace

std::string writeScene(const SceneDef& scene, const std::optional<SavedState>& state) {
  std::vector<Problem> problems = validate(scene);
  if (!problems.empty()) throw InvalidInput(std::move(problems));
  std::string result = headText(scene) + (scene.bodies.empty() ? "bodies: []\n" : "bodies:\n");
  for (const BodyDef& body : scene.bodies) result += "  - " + text(body) + "\n";
  if (state) result += stateText(*state);
  if (scene.bodies.size() > kMostBodies)
    throw InvalidInput({{"bodies", std::to_string(scene.bodies.size()),
                         "at most " + std::to_string(kMostBodies) + " in a scene file"}});
  if (result.size() > kMostSceneBytes)
    throw InvalidInput({{"bodies", std::to_string(result.size()) + " bytes of text", "at most 64 MiB"}});
  return result;
}

}  // namespace rbs
