// SPDX-License-Identifier: BSD-3-Clause
// Eye: from where a picture is taken, as visuals need it to choose what is drawn how finely.
#pragma once

#include <OgreVector3.h>

namespace Ogre {
class SceneNode;
}
namespace rviz {
class DisplayContext;
}

namespace rbs {

struct Eye {
  Ogre::Vector3 position = Ogre::Vector3::ZERO;  ///< in the frame of the scene node, m
  float pixels = 1000.0f;                        ///< by which a thing is high that is as high as it is far
};

/// The eye of RViz's main view. `node`: in whose frame it is wanted.
Eye eyeOf(rviz::DisplayContext& context, const Ogre::SceneNode& node);

}  // namespace rbs
