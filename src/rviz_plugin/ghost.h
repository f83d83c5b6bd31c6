// SPDX-License-Identifier: BSD-3-Clause
// Ghost: a body that is not there yet, drawn where it would be.
#pragma once

#include "body_mesh.h"
#include "instance_groups.h"

#include "rigid_body_sim/shape.h"

#include <OgreQuaternion.h>
#include <OgreVector3.h>

namespace Ogre {
class SceneManager;
class SceneNode;
}  // namespace Ogre

namespace rbs {

/// A shape that can be seen through. The mouse passes through it.
class Ghost {
 public:
  explicit Ghost(Ogre::SceneManager& scenes);
  ~Ghost();
  Ghost(const Ghost&) = delete;
  Ghost& operator=(const Ghost&) = delete;

  /// Draws this shape from the next show() on; not a plane.
  void setShape(const Shape& shape);
  /// Draws `size` times the shape with its centre of mass at `position`, in RViz's fixed frame, m. Nothing is
  /// drawn where the graphics driver cannot draw instances.
  void show(double size, const Ogre::Vector3& position, const Ogre::Quaternion& orientation);
  void hide();  ///< draws nothing

 private:
  Ogre::SceneNode* node_;
  InstanceGroups groups_;
  BodyMesh mesh_;
  Ogre::Vector3 factors_ = Ogre::Vector3::UNIT_SCALE;  ///< of the mesh
  double wall_ = 0.0;                                  ///< of a capsule: half the length of its wall, m
};

}  // namespace rbs
