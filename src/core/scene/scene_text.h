// SPDX-License-Identifier: BSD-3-Clause
// Text of scene files and commands: values as YAML on one line, which is read back bit for bit.
#pragma once

#include "rigid_body_sim/world.h"
#include "state/scene_fields.h"

#include <optional>
#include <string>
#include <vector>

namespace rbs::scene_text {

bool sameBits(double a, double b);
bool sameBits(const Vec3& a, const Vec3& b);
bool sameBits(const Quat& a, const Quat& b);

std::string text(double number);
std::string text(std::uint32_t number);
std::string text(std::uint64_t number);
std::string text(const Vec3& v);
std::string text(const Quat& q);
std::string text(const Color& c);
std::string text(const std::vector<Vec3>& points);
std::string text(const BodyDef& body);
std::string text(const std::vector<BodyDef>& bodies);
std::string text(const Setting& setting, const std::optional<Goal>& goal);
std::string text(const EffectOverrides& effects);
/// The fields of air, wind or a fluid.
template <class Surrounding>
std::string text(const Surrounding& surrounding);

/// A double-quoted scalar of YAML.
std::string quoted(const std::string& text);

/// A mapping on one line: {key: value, key: value}.
class Line {
 public:
  Line& add(const std::string& key, const std::string& value) {
    text_ += (text_.empty() ? "" : ", ") + key + ": " + value;
    return *this;
  }
  template <class Value>
  Line& addUnless(const Value& usual, const std::string& key, const Value& value) {
    return sameBits(usual, value) ? *this : add(key, scene_text::text(value));
  }
  template <class Value>
  Line& addGiven(const std::string& key, const std::optional<Value>& value) {
    return value ? add(key, scene_text::text(*value)) : *this;
  }
  std::string close() const { return "{" + text_ + "}"; }

 private:
  std::string text_;
};

/// Adds the keys of a value to those of another.
void addFields(Line& line, const Grab& grab);
void addFields(Line& line, const Pose& pose);
void addFields(Line& line, const Twist& twist);
void addFields(Line& line, const Shape& shape);

template <class Surrounding>
std::string text(const Surrounding& surrounding) {
  Line line;
  forEachField(Of<Surrounding>{},
               [&](const char* name, auto field, Range) { line.add(name, text(surrounding.*field)); });
  return line.close();
}

}  // namespace rbs::scene_text
