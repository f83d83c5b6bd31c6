// SPDX-License-Identifier: BSD-3-Clause
// Writing and reading commands, with the keys of scene files.
#include "rigid_body_sim/quote.h"
#include "scene/body_reader.h"
#include "scene/command_fields.h"
#include "scene/scene_fields_reader.h"
#include "scene/scene_limits.h"
#include "scene/scene_text.h"

#include <utility>

namespace rbs {
namespace {

using scene_text::Line;

std::string textOf(const BodyEdit& edit) {
  Line line;
  if (edit.name) line.add("name", scene_text::quoted(*edit.name));
  if (edit.shape) addFields(line, *edit.shape);
  if (edit.pose) addFields(line, *edit.pose);
  if (edit.twist) addFields(line, *edit.twist);
  if (edit.kind) line.add("kind", kindName(*edit.kind));
  return line.addGiven("mass", edit.mass)
      .addGiven("density", edit.density)
      .addGiven("friction", edit.friction)
      .addGiven("restitution", edit.restitution)
      .addGiven("drag_coefficient", edit.drag_coefficient)
      .addGiven("rolling_resistance", edit.rolling_resistance)
      .addGiven("torsional_resistance", edit.torsional_resistance)
      .addGiven("color", edit.color)
      .addGiven("group", edit.group)
      .addGiven("mask", edit.mask)
      .close();
}

// Adds a field to the line.
struct Writer {
  Line& line;

  void operator()(const char* key, const std::string& name) const { line.add(key, scene_text::quoted(name)); }
  void operator()(const char* key, const BodyEdit& edit) const { line.add(key, textOf(edit)); }
  void operator()(const char* key, const Setting& setting) const {
    line.add(key, scene_text::text(setting, std::nullopt));
  }
  void operator()(const char*, const Grab& grab) const { addFields(line, grab); }
  void operator()(const char*, const Pose& pose) const { addFields(line, pose); }
  void operator()(const char*, const std::optional<Goal>& goal) const {
    if (goal) line.addGiven("max_error", goal->max_error).addGiven("max_step_ms", goal->max_step_ms);
  }
  template <class Value>
  void operator()(const char* key, const std::optional<Value>& value) const {
    line.addGiven(key, value);
  }
  template <class Value>
  void operator()(const char* key, const Value& value) const {
    line.add(key, scene_text::text(value));
  }
};

void readEdit(Fields& fields, FileProblems& problems, BodyEdit& edit) {
  fields.read("name", edit.name);
  if (fields.find("shape")) {
    BodyDef body;
    BodyReader(problems, 0, ".").readShape(fields, body);
    edit.shape = body.shape;
  }
  if (fields.find("position") || fields.find("orientation")) readPose(fields, edit.pose.emplace());
  if (fields.find("velocity") || fields.find("spin")) readTwist(fields, edit.twist.emplace());
  const std::array kinds{BodyKind::Dynamic, BodyKind::Static, BodyKind::Kinematic};
  if (const auto kind = fields.choose("kind", {"dynamic", "static", "kinematic"})) edit.kind = kinds[*kind];
  fields.read("mass", edit.mass);
  fields.read("density", edit.density);
  fields.read("friction", edit.friction);
  fields.read("restitution", edit.restitution);
  fields.read("drag_coefficient", edit.drag_coefficient);
  fields.read("rolling_resistance", edit.rolling_resistance);
  fields.read("torsional_resistance", edit.torsional_resistance);
  fields.read("color", edit.color);
  fields.read("group", edit.group);
  fields.read("mask", edit.mask);
}

// Reads a field.
struct Reader {
  Fields& fields;
  FileProblems& problems;

  void operator()(const char* key, std::string& name) const { fields.require(key, "a name", name); }
  void operator()(const char* key, double& number) const { fields.require(key, "a number", number); }
  void operator()(const char* key, Vec3& v) const { fields.require(key, "[x, y, z]", v); }
  void operator()(const char* key, std::vector<BodyDef>& bodies) const {
    const YamlNode* list = fields.find(key);
    if (!list) return fields.report(key, "", "this key is needed: a list of bodies");
    BodyReader reader(problems, 0, ".");
    reader.read(*list);
    bodies = reader.takeBodies();
  }
  void operator()(const char* key, BodyEdit& edit) const {
    if (!fields.find(key)) fields.report(key, "", "this key is needed: what changes");
    readGroup(fields, key, problems, [&](Fields& set) { readEdit(set, problems, edit); });
  }
  void operator()(const char* key, Setting& setting) const {
    if (!fields.find(key)) fields.report(key, "", "this key is needed: a quality level");
    SceneDef scene;
    readFidelity(fields, problems, scene);
    if (scene.goal) fields.report(key, "a goal", "solver settings: a goal is set by set_goal");
    setting = scene.fidelity;
  }
  void operator()(const char* key, EffectOverrides& effects) const {
    if (!fields.find(key)) fields.report(key, "", "this key is needed: a mapping of effects to on or off");
    readEffects(fields, problems, effects);
  }
  void operator()(const char*, Grab& grab) const { readGrab(fields, grab); }
  void operator()(const char*, Pose& pose) const { readPose(fields, pose); }
  void operator()(const char*, std::optional<Goal>& goal) const {
    Goal read;
    const bool error = fields.read("max_error", read.max_error);
    if (fields.read("max_step_ms", read.max_step_ms) || error) goal = read;
  }
  template <class Surrounding>
  void operator()(const char* key, std::optional<Surrounding>& surrounding) const {
    readSurrounding(fields, key, problems, surrounding);
  }
};

template <std::size_t kKind = 0>
void readKind(std::size_t kind, const Reader& reader, commands::Any& change) {
  if constexpr (kKind < std::variant_size_v<commands::Any>) {
    if (kind != kKind) return readKind<kKind + 1>(kind, reader, change);
    auto& command = change.emplace<kKind>();
    visitFields(command, command, reader);
  }
}

}  // namespace

std::string writeCommand(const Command& command) {
  Line line;
  std::visit([&](const auto& change) { visitFields(change, change, Writer{line}); }, command.change);
  std::string text = std::string(command.name()) + ": " + line.close();
  if (text.size() > kMostSceneBytes)
    throw InvalidInput({{command.name(), std::to_string(text.size()) + " bytes", "at most 64 MiB"}});
  return text;
}

Command parseCommand(const std::string& text, const std::string& source) {
  if (text.size() > kMostSceneBytes)
    throw InvalidInput({{printable(source, kLongestPath), "more than 64 MiB", "at most 64 MiB"}});
  FileProblems problems(source);
  const YamlNode root = parseYaml(text, problems);
  Fields top(root, "", problems);
  Command command;
  std::size_t found = 0;
  for (std::size_t kind = 0; kind < commands::kNames.size(); ++kind) {
    if (!top.find(commands::kNames[kind])) continue;
    ++found;
    readGroup(top, commands::kNames[kind], problems, [&](Fields& fields) {
      readKind(kind, {fields, problems}, command.change);
    });
  }
  top.refuseOthers();
  if (found != 1 && problems.count() == 0)
    top.report("", "", "one command: its name, and a mapping of its fields");
  problems.throwIfAny();
  return command;
}

}  // namespace rbs
