// SPDX-License-Identifier: BSD-3-Clause
// From the fields of a request to a body or an edit, with the defaults of what was left out.
#pragma once

#include "rigid_body_sim/world.h"

#include <rigid_body_sim/BodyChange.h>
#include <rigid_body_sim/BodySpec.h>
#include <rigid_body_sim/SetBody.h>
#include <rigid_body_sim/SpawnBody.h>

#include <string>
#include <vector>

namespace rbs {

/// A shape, and its body's frame B seen from the frame P that the pose of a request is about: that of the
/// points of a hull; of other shapes B itself.
struct PlacedShape {
  Shape shape;
  std::optional<PlacedHull> hull;

  Pose poseOfB(const Pose& X_WP) const { return hull ? hull->poseOfB(X_WP) : X_WP; }
};

/// The shape that a request describes; a mesh is read and its hull made. Throws InvalidInput.
PlacedShape shapeFrom(const rigid_body_sim::BodySpec& spec, const std::string& path);

/// The bodies of a request to spawn. Its shapes, which need no world and may take seconds, are made at once.
class SpawnPlan {
 public:
  explicit SpawnPlan(std::vector<rigid_body_sim::BodySpec> specs);
  explicit SpawnPlan(const rigid_body_sim::SpawnBody::Request& request);

  /// The bodies to be made, in order; those without a pose at free places above the origin. Throws
  /// InvalidInput with every problem of every body.
  std::vector<BodyDef> bodiesIn(const World& world) const;

 private:
  std::vector<rigid_body_sim::BodySpec> specs_;
  std::vector<std::string> paths_;
  std::vector<PlacedShape> shapes_;
  std::vector<Problem> problems_;  ///< with the shapes
};

/// The properties to change. Throws InvalidInput with every list that holds more than one.
BodyEdit editFrom(const rigid_body_sim::SetBody::Request& request);
/// The same of a change to a body of this shape; it begins the paths of its errors with `path`.
BodyEdit editFrom(const rigid_body_sim::BodyChange& change, const Shape& shape, const std::string& path);
/// Whether an edit changes nothing.
bool isEmpty(const BodyEdit& edit);

}  // namespace rbs
