// SPDX-License-Identifier: BSD-3-Clause
// GuidesVisual: what is drawn at bodies that move, on demand: axes, centres of mass, bounds.
#pragma once

#include "body_catalog.h"
#include "eye.h"
#include "instance_groups.h"

namespace rbs {

class GuidesVisual {
 public:
  /// Which of them are drawn.
  struct Shown {
    bool axes = false, centres = false, bounds = false;
    bool any() const { return axes || centres || bounds; }
  };

  explicit GuidesVisual(Ogre::SceneNode& node) : groups_(node) {}

  void draw(const BodyCatalog& catalog, const std::vector<BodyPlace>& places, const Shown& shown,
            const Eye& eye);
  void clear() { groups_.clear(); }

 private:
  InstanceGroups groups_;
};

}  // namespace rbs
