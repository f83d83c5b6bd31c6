// SPDX-License-Identifier: BSD-3-Clause
#include "scene/yaml_fields.h"

#include "base/number_text.h"

#include <algorithm>
#include <charconv>
#include <limits>

namespace rbs {
namespace {

using Kind = YamlNode::Kind;

bool refuse(const YamlNode& node, const std::string& path, FileProblems& problems,
            const std::string& allowed) {
  problems.add(node.line, path, describe(node), allowed);
  return false;
}

std::string itemPath(const std::string& path, std::size_t index) {
  return path + "[" + std::to_string(index) + "]";
}

/// Reads a list of `least` to `most` values; `what` names it in messages.
template <class Value>
bool readList(const YamlNode& node, const std::string& path, FileProblems& problems, std::size_t least,
              std::size_t most, const std::string& what, std::vector<Value>& out) {
  const bool fits = node.kind == Kind::Sequence && node.items.size() >= least && node.items.size() <= most;
  if (!fits) return refuse(node, path, problems, what);
  std::vector<Value> values(node.items.size());
  bool sound = true;
  for (std::size_t i = 0; i < values.size(); ++i) {
    sound &= readValue(node.items[i], itemPath(path, i), problems, values[i]);
  }
  if (sound) out = std::move(values);
  return sound;
}

template <class Integer>
bool readInteger(const YamlNode& node, const std::string& path, FileProblems& problems, Integer& out) {
  const bool hex =
      node.text.size() > 2 && node.text[0] == '0' && (node.text[1] == 'x' || node.text[1] == 'X');
  const char* const begin = node.text.data() + (hex ? 2 : 0);
  const char* const end = node.text.data() + node.text.size();
  Integer value = 0;
  const auto [stop, error] = std::from_chars(begin, end, value, hex ? 16 : 10);
  if (node.kind != Kind::Scalar || node.quoted || error != std::errc() || stop != end) {
    return refuse(node, path, problems,
                  "a whole number from 0 to " + std::to_string(std::numeric_limits<Integer>::max()));
  }
  out = value;
  return true;
}

}  // namespace

bool readValue(const YamlNode& node, const std::string& path, FileProblems& problems, double& out) {
  const std::optional<double> number =
      node.kind == Kind::Scalar && !node.quoted ? parseNumber(node.text) : std::nullopt;
  if (!number) return refuse(node, path, problems, "a finite number");
  out = *number;
  return true;
}

bool readValue(const YamlNode& node, const std::string& path, FileProblems& problems, std::uint64_t& out) {
  return readInteger(node, path, problems, out);
}

bool readValue(const YamlNode& node, const std::string& path, FileProblems& problems, std::uint32_t& out) {
  return readInteger(node, path, problems, out);
}

bool readValue(const YamlNode& node, const std::string& path, FileProblems& problems, std::string& out) {
  if (node.kind != Kind::Scalar) return refuse(node, path, problems, "text");
  out = node.text;
  return true;
}

bool readValue(const YamlNode& node, const std::string& path, FileProblems& problems, Vec3& out) {
  std::vector<double> v;
  if (!readList(node, path, problems, 3, 3, "three numbers [x, y, z]", v)) return false;
  out = Vec3(v[0], v[1], v[2]);
  return true;
}

bool readValue(const YamlNode& node, const std::string& path, FileProblems& problems, Quat& out) {
  std::vector<double> q;
  if (!readList(node, path, problems, 4, 4, "a quaternion [x, y, z, w]", q)) return false;
  out = Quat(q[3], q[0], q[1], q[2]);
  return true;
}

bool readValue(const YamlNode& node, const std::string& path, FileProblems& problems, Color& out) {
  std::vector<double> c;
  if (!readList(node, path, problems, 3, 4, "[red, green, blue] or [red, green, blue, alpha]", c))
    return false;
  if (c.size() == 3) c.push_back(1.0);
  std::transform(c.begin(), c.end(), out.begin(), [](double channel) { return static_cast<float>(channel); });
  return true;
}

bool readValue(const YamlNode& node, const std::string& path, FileProblems& problems,
               std::array<std::uint32_t, 3>& out) {
  std::vector<std::uint32_t> values;
  if (!readList(node, path, problems, 3, 3, "three whole numbers [x, y, z]", values)) return false;
  std::copy(values.begin(), values.end(), out.begin());
  return true;
}

bool readValue(const YamlNode& node, const std::string& path, FileProblems& problems,
               std::array<double, 2>& out) {
  std::vector<double> values;
  if (!readList(node, path, problems, 2, 2, "two numbers [low, high]", values)) return false;
  std::copy(values.begin(), values.end(), out.begin());
  return true;
}

bool readValue(const YamlNode& node, const std::string& path, FileProblems& problems,
               std::vector<std::string>& out) {
  return readList(node, path, problems, 1, 16, "a list of 1 to 16 names", out);
}

bool readValue(const YamlNode& node, const std::string& path, FileProblems& problems,
               std::vector<Vec3>& out) {
  return readList(node, path, problems, 0, Limits::max_hull_points, "a list of points [x, y, z]", out);
}

Fields::Fields(const YamlNode& node, std::string path, FileProblems& problems)
    : node_(node), path_(std::move(path)), problems_(problems) {
  if (node_.kind != Kind::Map) refuse(node_, path_, problems_, "a mapping {key: value, ...}");
}

const YamlNode* Fields::find(const std::string& key) {
  if (std::find(known_.begin(), known_.end(), key) == known_.end()) known_.push_back(key);
  return node_.find(key);
}

std::optional<std::size_t> Fields::choose(const std::string& key, const std::vector<std::string>& names) {
  const YamlNode* node = find(key);
  if (!node) return std::nullopt;
  const auto found = std::find(names.begin(), names.end(), node->text);
  if (node->kind == Kind::Scalar && found != names.end()) {
    return static_cast<std::size_t>(found - names.begin());
  }
  std::string allowed;
  for (const std::string& name : names) allowed += (allowed.empty() ? "" : ", ") + name;
  report(key, describe(*node), allowed);
  return std::nullopt;
}

void Fields::report(const std::string& key, const std::string& value, const std::string& allowed) {
  const YamlNode* node = node_.find(key);
  problems_.add(node ? node->line : node_.line, pathOf(key), value, allowed);
}

void Fields::report(const Problem& problem) {
  problems_.add(lineOf(node_, problem.path.substr(path_.size())), problem.path, problem.value,
                problem.allowed);
}

void Fields::refuseOthers() {
  if (node_.kind != Kind::Map) return;
  for (const YamlNode& item : node_.items) {
    if (std::find(known_.begin(), known_.end(), item.key) != known_.end()) continue;
    const std::string near = nearestName(item.key, known_);
    std::string text = "unknown key";
    if (!near.empty()) text += "; did you mean '" + near + "'?";
    text += "; keys:";
    for (const std::string& key : known_) text += " " + key;
    report(item.key, "", text);
  }
}

}  // namespace rbs
