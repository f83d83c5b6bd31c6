// SPDX-License-Identifier: BSD-3-Clause
#include "eye.h"

#include <OgreCamera.h>
#include <OgreSceneNode.h>
#include <OgreViewport.h>
#include <rviz/display_context.h>
#include <rviz/view_controller.h>
#include <rviz/view_manager.h>

#include <cmath>

namespace rbs {

Eye eyeOf(rviz::DisplayContext& context, const Ogre::SceneNode& node) {
  Eye eye;
  rviz::ViewController* const view = context.getViewManager()->getCurrent();
  Ogre::Camera* const camera = view ? view->getCamera() : nullptr;
  if (!camera) return eye;
  eye.position =
      node._getDerivedOrientation().Inverse() * (camera->getDerivedPosition() - node._getDerivedPosition());
  const Ogre::Viewport* const viewport = camera->getViewport();
  if (!viewport) return eye;
  const float half_angle = 0.5f * camera->getFOVy().valueRadians();
  eye.pixels = static_cast<float>(viewport->getActualHeight()) / (2.0f * std::tan(half_angle));
  return eye;
}

}  // namespace rbs
