// SPDX-License-Identifier: BSD-3-Clause
// The ray through the pixel under the mouse.
#pragma once

#include <OgreRay.h>

namespace rviz {
class ViewportMouseEvent;
}

namespace rbs {

/// From the eye, in RViz's fixed frame; its direction has length 1.
Ogre::Ray mouseRay(const rviz::ViewportMouseEvent& event);

}  // namespace rbs
