// SPDX-License-Identifier: BSD-3-Clause
// TrailsVisual: the ways that the centres of dynamic bodies have gone lately.
#pragma once

#include "body_catalog.h"
#include "eye.h"
#include "instance_groups.h"

#include <deque>

namespace rbs {

/// A trail fades with its age. A jump leaves none.
class TrailsVisual {
 public:
  explicit TrailsVisual(Ogre::SceneNode& node) : groups_(node) {}

  /// Adds the bodies' ways since the last call. `stamp`: of the places, s; `seconds`: how old a trail becomes.
  void draw(const BodyCatalog& catalog, const std::vector<BodyPlace>& places,
            const std::vector<Ogre::ColourValue>& colors, double stamp, double seconds, const Eye& eye);
  void clear();

 private:
  struct Piece {
    Instance line;
    double stamp;
  };
  void extend(const BodyCatalog& catalog, const std::vector<BodyPlace>& places,
              const std::vector<Ogre::ColourValue>& colors, double stamp);

  std::vector<Ogre::Vector3> ends_;  ///< of the trails, in the order of the catalog
  std::deque<Piece> pieces_;         ///< by age, the oldest first
  double stamp_ = 0.0;               ///< of the last call
  InstanceGroups groups_;
};

}  // namespace rbs
