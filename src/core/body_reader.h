// Reading the list of bodies of a scene file.
#pragma once

#include "random.h"
#include "rigid_body_sim/scene.h"
#include "yaml_fields.h"

#include <cstdint>
#include <string>
#include <vector>

namespace rbs {

/// Reads the entries of the list one by one, and makes the bodies that each of them asks for.
class BodyReader {
 public:
  BodyReader(FileProblems& problems, std::uint64_t seed) : problems_(problems), random_(seed) {}

  void read(const YamlNode& list);
  std::vector<BodyDef> takeBodies() { return std::move(bodies_); }
  /// Index of the entry that made each body.
  const std::vector<std::size_t>& entries() const { return entries_; }

 private:
  void readEntry(const YamlNode& node, std::size_t index);
  void add(std::vector<BodyDef> bodies, std::size_t entry);

  FileProblems& problems_;
  SplitMix64 random_;
  std::vector<BodyDef> bodies_;
  std::vector<std::size_t> entries_;
};

}  // namespace rbs
