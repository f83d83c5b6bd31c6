// SPDX-License-Identifier: BSD-3-Clause
// BodyColors: what the colour of a body may stand for. Palettes that the colour-blind can tell apart.
#pragma once

#include "body_catalog.h"

#include <string>
#include <utility>
#include <vector>

namespace rbs {

enum class ColorBy { Material, Island, Awake, Speed };

/// The colours of all bodies in the order of the catalog. Bodies that forces do not move are grey unless the
/// colour stands for the material. `links`: the pairs of bodies that touch, as places in the catalog; only
/// Island reads them. `fastest`: the speed at the end of the palette, m/s.
std::vector<Ogre::ColourValue> colorsOf(const BodyCatalog& catalog, const std::vector<BodyPlace>& places,
                                        ColorBy by,
                                        const std::vector<std::pair<std::size_t, std::size_t>>& links,
                                        float fastest);

/// Which colour stands for what, in a sentence.
std::string legendOf(ColorBy by, float fastest);

/// From dark blue through grey to yellow: lighter is more, also where hues are not seen. `share` 0 to 1.
Ogre::ColourValue scaleColor(float share);

/// The island of each body by its least member, or the body itself: dynamic bodies that links connect. What
/// forces do not move connects nothing.
std::vector<std::size_t> islandsOf(const BodyCatalog& catalog,
                                   const std::vector<std::pair<std::size_t, std::size_t>>& links);

}  // namespace rbs
