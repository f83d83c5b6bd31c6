// SPDX-License-Identifier: BSD-3-Clause
#include "instance_groups.h"

#include <OgreRenderQueue.h>

#include <algorithm>

namespace rbs {

InstanceGroups::~InstanceGroups() {
  clear();
}

void InstanceGroups::begin() {
  for (auto& [key, group] : groups_) group.instances.clear();
}

void InstanceGroups::add(const BodyMesh& mesh, Look look, const Instance& instance) {
  const auto key = std::make_pair(&mesh, look);
  if (!last_ || key != last_key_) {
    last_key_ = key;
    last_ = &groups_[key];
  }
  last_->instances.push_back(instance);
}

void InstanceGroups::end(const Ogre::Vector3& eye) {
  for (auto& [key, group] : groups_) {
    const auto& [mesh, look] = key;
    if (!group.drawn) {
      group.drawn = std::make_unique<Instances>(*mesh, instanceMaterial(look, mesh->pattern));
      if (look == Look::OnTop) group.drawn->setRenderQueueGroup(Ogre::RENDER_QUEUE_8);
      if (look == Look::Ground) group.drawn->setRenderQueueGroup(Ogre::RENDER_QUEUE_4);  // before all else
      node_.attachObject(group.drawn.get());
    }
    if (look == Look::SeeThrough) {
      std::stable_sort(group.instances.begin(), group.instances.end(),
                       [&](const Instance& a, const Instance& b) {
                         return (a.position - eye).squaredLength() > (b.position - eye).squaredLength();
                       });
    }
    group.drawn->set(group.instances);
  }
}

void InstanceGroups::clear() {
  for (auto& [key, group] : groups_)
    if (group.drawn) group.drawn->detachFromParent();
  groups_.clear();
  last_ = nullptr;
}

}  // namespace rbs
