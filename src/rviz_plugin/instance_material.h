// SPDX-License-Identifier: BSD-3-Clause
// The materials of instances, with the shaders that place, light and mark them.
#pragma once

#include "body_mesh.h"

#include <OgreMaterial.h>

namespace rbs {

/// How instances are drawn.
enum class Look {
  Solid,       ///< lit; hides what lies behind
  SeeThrough,  ///< lit, and blended with what lies behind
  Ground,      ///< lit; fades out with the distance from the eye, to nothing at the size of the instance
  Plain,       ///< in its colour, unlit
  Outline,  ///< the sides that face away, in its colour, unlit: behind a smaller body of the same shape its outline
  OnTop,  ///< lit, in front of everything
  Shadow  ///< a soft dark spot: the alpha is its strength in the middle
};

/// The material of this look for meshes with this pattern. Shared by all displays; made when first asked for.
///
/// All of them take part in RViz's picking: it draws scenes again with the handle in place of the colour, and
/// with the depth. What has the handle 0 is passed through by the mouse. Plain, Outline, OnTop and Shadow always are.
Ogre::MaterialPtr instanceMaterial(Look look, Pattern pattern);

}  // namespace rbs
