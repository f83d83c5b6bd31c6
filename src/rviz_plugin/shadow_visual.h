// SPDX-License-Identifier: BSD-3-Clause
// ShadowVisual: a soft spot on the floor under each body, which shows how high it is.
#pragma once

#include "body_catalog.h"
#include "eye.h"
#include "instance_groups.h"

namespace rbs {

/// Straight below the body, whatever lights the scene: the higher, the wider and the fainter. Only on planes
/// that face up; what stands on another body has its spot on the plane below. What is see-through has none.
class ShadowVisual {
 public:
  explicit ShadowVisual(Ogre::SceneNode& node) : groups_(node) {}

  void draw(const BodyCatalog& catalog, const std::vector<BodyPlace>& places, const Eye& eye);
  void clear() { groups_.clear(); }

 private:
  InstanceGroups groups_;
};

}  // namespace rbs
