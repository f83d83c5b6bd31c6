// SPDX-License-Identifier: BSD-3-Clause
// Reading the list of bodies of a scene file.
#pragma once

#include "base/random.h"
#include "rigid_body_sim/scene.h"
#include "scene/yaml_fields.h"

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace rbs {

/// Reads the entries of the list one by one, and makes the bodies that each of them defines.
class BodyReader {
 public:
  /// Meshes are looked for in `folder`.
  BodyReader(FileProblems& problems, std::uint64_t seed, std::string folder)
      : problems_(problems), random_(seed), folder_(std::move(folder)) {}

  void read(const YamlNode& list);
  /// Reads the keys of the shape among those of a body. The points of a hull are in the frame that the pose of
  /// `body` is the pose of, which becomes that of the body.
  void readShape(Fields& fields, BodyDef& body);
  std::vector<BodyDef> takeBodies() { return std::move(bodies_); }
  /// Index of the entry that made each body.
  const std::vector<std::size_t>& entries() const { return entries_; }

 private:
  void readHull(Fields& fields, BodyDef& body);
  PlacedHull meshHull(const std::string& mesh, double scale, const std::string& path);
  void readEntry(const YamlNode& node, std::size_t index);
  void add(std::vector<BodyDef> bodies, std::size_t entry);

  FileProblems& problems_;
  SplitMix64 random_;
  std::string folder_;
  std::map<std::string, std::vector<Vec3>> mesh_points_;         ///< of the meshes that were read
  std::map<std::pair<std::string, double>, PlacedHull> meshes_;  ///< their hulls, by name and scale
  std::size_t hull_points_ = 0;                                  ///< that those hulls were made of
  std::vector<BodyDef> bodies_;
  std::vector<std::size_t> entries_;
};

}  // namespace rbs
