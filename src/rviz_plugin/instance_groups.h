// SPDX-License-Identifier: BSD-3-Clause
// InstanceGroups: what a visual draws in a picture, sorted by mesh and look into few draw calls.
#pragma once

#include "instance_material.h"
#include "instances.h"

#include <OgreSceneNode.h>

#include <map>
#include <memory>
#include <utility>

namespace rbs {

class InstanceGroups {
 public:
  explicit InstanceGroups(Ogre::SceneNode& node) : node_(node) {}
  ~InstanceGroups();

  /// From begin() to end() the instances of a picture are added; the meshes must live on until clear().
  void begin();
  void add(const BodyMesh& mesh, Look look, const Instance& instance);
  /// Draws what was added, and no more what was added before. What can be seen through goes from the farthest
  /// to the nearest as seen from `eye`.
  void end(const Ogre::Vector3& eye);
  /// Draws nothing, and forgets the meshes.
  void clear();

 private:
  struct Group {
    std::unique_ptr<Instances> drawn;
    std::vector<Instance> instances;
  };

  Ogre::SceneNode& node_;
  std::map<std::pair<const BodyMesh*, Look>, Group> groups_;
  std::pair<const BodyMesh*, Look> last_key_;  ///< bodies of one kind mostly follow each other
  Group* last_ = nullptr;
};

}  // namespace rbs
