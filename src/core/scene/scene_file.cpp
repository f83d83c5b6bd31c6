// SPDX-License-Identifier: BSD-3-Clause
// Reading scene files. docs/scenes.md lists the keys; this file is their one definition.
//
// Everything that can be wrong is collected and thrown at once: what has the wrong form while reading,
// and what has a wrong value by validate(), whose paths are mapped to the lines of the file.
#include "base/number_text.h"
#include "rigid_body_sim/file_access.h"
#include "rigid_body_sim/quote.h"
#include "rigid_body_sim/scenes.h"
#include "scene/body_reader.h"
#include "scene/scene_fields_reader.h"
#include "scene/scene_limits.h"
#include "scene/yaml_fields.h"
#include "state/scene_fields.h"

#include <array>
#include <filesystem>
#include <fstream>
#include <limits>
#include <set>

namespace rbs {
namespace {

void readPreset(Fields& fields, const std::string& key, Setting& setting) {
  std::vector<std::string> names;
  for (const Fidelity fidelity : kFidelities) names.emplace_back(fidelityName(fidelity));
  if (const auto choice = fields.choose(key, names)) setting.preset = kFidelities[*choice];
}

}  // namespace

void readFidelity(Fields& top, FileProblems& problems, SceneDef& scene) {
  const YamlNode* node = top.find("fidelity");
  if (!node) return;
  if (node->kind != YamlNode::Kind::Map) return readPreset(top, "fidelity", scene.fidelity);
  readGroup(top, "fidelity", problems, [&](Fields& fidelity) {
    readPreset(fidelity, "preset", scene.fidelity);
    fidelity.read("divisions", scene.fidelity.divisions);
    fidelity.read("sub_steps", scene.fidelity.sub_steps);
    fidelity.read("tolerance", scene.fidelity.tolerance);
    fidelity.read("max_solve_ms", scene.fidelity.max_solve_ms);
    if (!fidelity.find("max_error") && !fidelity.find("max_step_ms")) return;
    scene.goal.emplace();
    fidelity.read("max_error", scene.goal->max_error);
    fidelity.read("max_step_ms", scene.goal->max_step_ms);
  });
}

void readEffects(Fields& top, FileProblems& problems, EffectOverrides& out) {
  readGroup(top, "effects", problems, [&](Fields& effects) {
    for (const Effect effect : kEffects)
      if (const auto choice = effects.choose(effectName(effect), {"off", "on", "auto"});
          choice && *choice < 2)
        out[effect] = *choice == 1;
  });
}

void readGrab(Fields& fields, Grab& grab) {
  fields.require("p_B", "the point of the body, [x, y, z]", grab.p_B);
  fields.require("p_W", "the point of the world, [x, y, z]", grab.p_W);
  fields.require("frequency", "the frequency of the spring", grab.frequency);
  fields.require("max_acceleration", "the cap on its force over the mass", grab.max_acceleration);
}

void readPose(Fields& fields, Pose& pose) {
  fields.require("position", "the position, [x, y, z]", pose.p_WB);
  fields.require("orientation", "the orientation, [x, y, z, w]", pose.q_WB);
}

void readTwist(Fields& fields, Twist& twist) {
  fields.require("velocity", "the velocity, [x, y, z]", twist.v_WB);
  fields.require("spin", "the angular velocity, [x, y, z]", twist.w_WB);
}

namespace {

void readSurroundings(Fields& top, FileProblems& problems, SceneDef& scene) {
  top.read("name", scene.name);
  top.read("property", scene.property);
  top.read("gravity", scene.gravity);
  top.read("step", scene.step);
  readFidelity(top, problems, scene);
  top.read("seed", scene.seed);
  forEachSurrounding([&](const char* key, auto surrounding, auto) {
    readSurrounding(top, key, problems, scene.*surrounding);
  });
  readEffects(top, problems, scene.effects);
  readGroup(top, "view", problems, [&](Fields& view) {
    view.read("eye", scene.view.eye);
    view.read("target", scene.view.target);
  });
}

template <class Read>
void readItems(Fields& parent, const std::string& key, FileProblems& problems, Read read) {
  const YamlNode* list = parent.find(key);
  if (!list) return;
  if (list->kind != YamlNode::Kind::Sequence) parent.report(key, describe(*list), "a list");
  for (std::size_t i = 0; i < list->items.size(); ++i) {
    Fields fields(list->items[i], parent.pathOf(key) + "[" + std::to_string(i) + "]", problems);
    read(fields);
    fields.refuseOthers();
  }
}

bool readFlag(Fields& item, const char* key) {
  std::uint32_t flag = 0;
  if (item.read(key, flag) && flag > 1) item.report(key, std::to_string(flag), "0 or 1");
  return flag == 1;
}

SavedState readState(Fields& fields, std::size_t bodies, FileProblems& problems) {
  const auto checkBody = [&](Fields& item, const char* key, std::size_t index) {
    if (index >= bodies)
      item.report(key, std::to_string(index), "the index of a body, below " + std::to_string(bodies));
  };
  const auto requireBody = [&](Fields& item, const char* key, auto& index) {
    if (item.require(key, "the index of a body", index)) checkBody(item, key, index);
  };
  SavedState state;
  if (fields.read("time", state.time) && state.time < 0.0) {
    fields.report("time", numberText(state.time), "0 s or more");
  }
  fields.read("steps", state.steps);
  readItems(fields, "contacts", problems, [&](Fields& item) {
    SavedState::Contact& contact = state.contacts.emplace_back();
    requireBody(item, "a", contact.a);
    requireBody(item, "b", contact.b);
    contact.exact = readFlag(item, "exact");
    item.read("normal", contact.n_W);
    item.read("depth", contact.depth);
    item.read("touching", contact.touching_steps);
    if (contact.a >= contact.b) item.report("b", std::to_string(contact.b), "more than a");
    readItems(item, "points", problems, [&](Fields& p) {
      SavedState::Contact::Point& point = contact.points.emplace_back();
      p.require("feature", "the number of the feature", point.feature);
      p.require("normal", "the normal force", point.normal);
      p.require("tangent", "the friction force, [x, y, z]", point.tangent_W);
    });
  });
  readItems(fields, "orientations", problems, [&](Fields& item) {
    SavedState::Orientation& orientation = state.orientations.emplace_back();
    requireBody(item, "body", orientation.body);
    item.require("since", "the time it holds for", orientation.since);
    item.require("orientation", "the orientation then, [x, y, z, w]", orientation.q_WB);
  });
  readItems(fields, "rest", problems, [&](Fields& item) {
    SavedState::Rest& rest = state.rest.emplace_back();
    requireBody(item, "body", rest.body);
    item.require("steps", "for how many steps it has rested", rest.steps);
    if (item.read("asleep_with", rest.asleep_with)) checkBody(item, "asleep_with", *rest.asleep_with);
  });
  readItems(fields, "wrenches", problems, [&](Fields& item) {
    SavedState::Wrench& wrench = state.wrenches.emplace_back();
    requireBody(item, "body", wrench.body);
    item.require("force", "the force, [x, y, z]", wrench.force_W);
    item.require("torque", "the torque, [x, y, z]", wrench.torque_W);
    item.require("point", "where the force acts on the body, [x, y, z]", wrench.point_B);
    item.require("until", "the time at which it ends", wrench.until);
    wrench.commanded = readFlag(item, "commanded");
  });
  readItems(fields, "grabs", problems, [&](Fields& item) {
    SavedState::Grabbed& grabbed = state.grabs.emplace_back();
    requireBody(item, "body", grabbed.body);
    readGrab(item, grabbed.grab);
  });
  readItems(fields, "holds", problems, [&](Fields& item) {
    SavedState::Held& held = state.holds.emplace_back();
    requireBody(item, "body", held.body);
    readPose(item, held.target);
    readTwist(item, held.twist);
  });
  readItems(fields, "frozen", problems, [&](Fields& item) {
    SavedState::Frozen& frozen = state.frozen.emplace_back();
    requireBody(item, "body", frozen.body);
    frozen.kinematic = readFlag(item, "kinematic");
  });
  return state;
}

/// Maps a path of the expanded scene to the entry of the file: "bodies[507].material.friction" to "bodies[2].friction".
std::string pathInFile(const std::string& path, const std::vector<std::size_t>& entries) {
  const std::string list = "bodies[", material = ".material";
  if (path.compare(0, list.size(), list) != 0) return path;
  std::size_t digits = 0;
  const std::size_t body = std::stoul(path.substr(list.size()), &digits);
  std::string field = path.substr(list.size() + digits);
  if (const std::size_t at = field.find(material + "."); at != field.npos) field.erase(at, material.size());
  return list + std::to_string(entries.at(body)) + field;
}

/// An entry that makes many bodies reports a fault once, with the value of its first body.
void addFaults(const SceneDef& scene, const std::vector<std::size_t>& entries, const YamlNode& root,
               FileProblems& problems) {
  std::set<std::pair<std::string, std::string>> reported;
  for (const Problem& problem : validate(scene)) {
    const std::string path = pathInFile(problem.path, entries);
    if (reported.emplace(path, problem.allowed).second) {
      problems.add(lineOf(root, path), path, problem.value, problem.allowed);
    }
  }
}

[[noreturn]] void refuseFile(const std::string& file, const std::string& value, const std::string& allowed) {
  throw InvalidInput({{printable(file, kLongestPath), value, allowed}});
}

/// Where a relative path was looked up; empty for an absolute one. A node runs in another folder than the shell
/// of its user.
std::string placeOfRelative(const std::string& file) {
  std::error_code error;
  if (std::filesystem::path(file).is_absolute()) return "";
  return "; a relative path begins in " +
         printable(std::filesystem::current_path(error).string(), kLongestPath);
}

std::string readText(const std::string& file) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(file, error);
  if (!std::filesystem::exists(status))
    refuseFile(file, "no such file", "a scene file" + placeOfRelative(file));
  if (!std::filesystem::is_regular_file(status)) refuseFile(file, "not a regular file", "a scene file");
  std::ifstream stream(file, std::ios::binary);
  if (!stream) refuseFile(file, "cannot be opened", "a file that may be read");
  std::string text;
  std::array<char, 1 << 16> block;
  do {
    stream.read(block.data(), block.size());
    text.append(block.data(), static_cast<std::size_t>(stream.gcount()));
  } while (stream && text.size() <= kMostSceneBytes);
  if (stream.bad()) refuseFile(file, "cannot be read", "a file that may be read");
  return text;
}

}  // namespace

SceneFile parseScene(const std::string& text, const std::string& file, std::optional<std::uint64_t> seed) {
  if (text.size() > kMostSceneBytes) refuseFile(file, "more than 64 MiB", "at most 64 MiB");
  FileProblems problems(file);
  const YamlNode root = parseYaml(text, problems);
  Fields top(root, "", problems);
  SceneFile result;
  readSurroundings(top, problems, result.scene);
  if (seed) result.scene.seed = *seed;

  const std::string folder = std::filesystem::path(file).parent_path().string();
  BodyReader reader(problems, result.scene.seed, folder.empty() ? "." : folder);
  if (const YamlNode* bodies = top.find("bodies")) reader.read(*bodies);
  result.scene.bodies = reader.takeBodies();
  const bool complete = problems.count() == 0;
  readGroup(top, "state", problems, [&](Fields& fields) {
    const std::size_t bodies =
        complete ? result.scene.bodies.size() : std::numeric_limits<std::size_t>::max();
    result.state = readState(fields, bodies, problems);
  });
  top.refuseOthers();
  addFaults(result.scene, reader.entries(), root, problems);
  problems.throwIfAny();
  return result;
}

// A fault is reported with the value in the file. Nothing is quoted from a file that is no scene: the user
// may not be allowed to read it.
SceneFile readScene(const std::string& file, std::optional<std::uint64_t> seed) {
  stopIfInterrupted(file);
  const std::string text = readText(file);
  try {
    SceneFile result = parseScene(text, file, seed);
    if (result.scene.name == SceneDef{}.name) result.scene.name = std::filesystem::path(file).stem().string();
    return result;
  } catch (const InvalidInput&) {
    const bool is_scene = text.find("bodies") != std::string::npos;
    if (!is_scene) refuseFile(file, "not a scene", "a scene file: YAML with the key bodies");
    throw;
  }
}

}  // namespace rbs
