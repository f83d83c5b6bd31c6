// SPDX-License-Identifier: BSD-3-Clause
// NamesVisual: the names of the bodies nearest to the eye.
#pragma once

#include "body_catalog.h"
#include "eye.h"

#include <OgreSceneNode.h>
#include <rviz/ogre_helpers/movable_text.h>

#include <memory>
#include <vector>

namespace rbs {

class NamesVisual {
 public:
  /// More would hide each other, and each is a draw call.
  static constexpr std::size_t kMost = 100;

  explicit NamesVisual(Ogre::SceneNode& node) : node_(node) {}
  ~NamesVisual();

  void draw(const BodyCatalog& catalog, const std::vector<BodyPlace>& places, const Eye& eye);
  void clear();

 private:
  struct Label {
    Ogre::SceneNode* node;
    std::unique_ptr<rviz::MovableText> text;
  };
  Label& label(std::size_t number);

  Ogre::SceneNode& node_;
  std::vector<Label> labels_;
};

}  // namespace rbs
