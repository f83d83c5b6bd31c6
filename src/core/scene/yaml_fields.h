// SPDX-License-Identifier: BSD-3-Clause
// Reads the values of one mapping by name and type, and finds unknown keys.
#pragma once

#include "rigid_body_sim/scene.h"
#include "scene/yaml_tree.h"

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace rbs {

// Each readValue() sets `out` and returns true, or reports the fault and leaves `out` unchanged.
bool readValue(const YamlNode& node, const std::string& path, FileProblems& problems, double& out);
bool readValue(const YamlNode& node, const std::string& path, FileProblems& problems, std::uint64_t& out);
bool readValue(const YamlNode& node, const std::string& path, FileProblems& problems, std::uint32_t& out);
bool readValue(const YamlNode& node, const std::string& path, FileProblems& problems, std::string& out);
bool readValue(const YamlNode& node, const std::string& path, FileProblems& problems, Vec3& out);
bool readValue(const YamlNode& node, const std::string& path, FileProblems& problems,
               Quat& out);  ///< [x, y, z, w]
bool readValue(const YamlNode& node, const std::string& path, FileProblems& problems,
               Color& out);  ///< 3 or 4
bool readValue(const YamlNode& node, const std::string& path, FileProblems& problems,
               std::array<std::uint32_t, 3>& out);
bool readValue(const YamlNode& node, const std::string& path, FileProblems& problems,
               std::array<double, 2>& out);
bool readValue(const YamlNode& node, const std::string& path, FileProblems& problems,
               std::vector<std::string>& out);
bool readValue(const YamlNode& node, const std::string& path, FileProblems& problems, std::vector<Vec3>& out);

class Fields {
 public:
  /// `node` should be a mapping; anything else is reported and read as an empty one.
  Fields(const YamlNode& node, std::string path, FileProblems& problems);

  /// The value of a key, or null; either way the key is known from now on.
  const YamlNode* find(const std::string& key);
  /// Reads the value where there is one; whether it was there and sound.
  template <class Value>
  bool read(const std::string& key, Value& out) {
    const YamlNode* node = find(key);
    return node && readValue(*node, pathOf(key), problems_, out);
  }
  template <class Value>
  bool read(const std::string& key, std::optional<Value>& out) {
    Value value{};
    if (!read(key, value)) return false;
    out = value;
    return true;
  }
  /// Like read(), and reports a missing key; `what` says what it should hold.
  template <class Value>
  bool require(const std::string& key, const std::string& what, Value& out) {
    if (!find(key)) report(key, "", "this key is needed: " + what);
    return read(key, out);
  }
  /// Position of the value among `names`; empty when it is absent, or reported when it is none of them.
  std::optional<std::size_t> choose(const std::string& key, const std::vector<std::string>& names);

  /// Reports at the line of the key, or of the mapping when it has no such key.
  void report(const std::string& key, const std::string& value, const std::string& allowed);
  /// Reports a problem whose path begins with that of the mapping, at the line that it is about.
  void report(const Problem& problem);
  /// Reports every key that was never read. To be called once all are read.
  void refuseOthers();

  /// Of this key; of the mapping itself for "".
  std::string pathOf(const std::string& key) const {
    return path_ + (path_.empty() || key.empty() ? "" : ".") + key;
  }

 private:
  const YamlNode& node_;
  std::string path_;
  FileProblems& problems_;
  std::vector<std::string> known_;
};

/// Reads the mapping of this key, where it is present, with `read(Fields&)`.
template <class Read>
void readGroup(Fields& parent, const std::string& key, FileProblems& problems, Read read) {
  if (const YamlNode* node = parent.find(key)) {
    Fields fields(*node, parent.pathOf(key), problems);
    read(fields);
    fields.refuseOthers();
  }
}

}  // namespace rbs
