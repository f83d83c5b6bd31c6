// SPDX-License-Identifier: BSD-3-Clause
#include "mouse_ray.h"

#include <OgreCamera.h>
#include <OgreViewport.h>
#include <rviz/viewport_mouse_event.h>

namespace rbs {

Ogre::Ray mouseRay(const rviz::ViewportMouseEvent& event) {
  const float width = event.viewport->getActualWidth() - 1, height = event.viewport->getActualHeight() - 1;
  return event.viewport->getCamera()->getCameraToViewportRay((event.x + 0.5f) / width,
                                                             (event.y + 0.5f) / height);
}

}  // namespace rbs
