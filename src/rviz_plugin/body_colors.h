// SPDX-License-Identifier: BSD-3-Clause
// BodyColors: what the colour of a body may stand for. Palettes that the colour-blind can tell apart.
#pragma once

#include "body_catalog.h"
#include "body_details.h"

#include <string>
#include <vector>

namespace rbs {

enum class ColorBy { Material, Island, Awake, Speed, Solver, Error };

/// What colours stand for.
struct Coloring {
  ColorBy by = ColorBy::Material;
  float fastest = 5.0f;  ///< speed at the bright end of the scale, m/s, > 0
  float largest =
      1e-3f;  ///< error at the bright end of the scale, m, > 0; the dark end is a thousandth of it

  /// Whether it depends on ~body_details.
  bool needsDetails() const { return by == ColorBy::Island || by == ColorBy::Solver || by == ColorBy::Error; }
};

/// The colours of all bodies in the order of the catalog. Bodies that forces do not move are grey unless the
/// colour stands for the material; so are those of which `details` say nothing. That list may be empty.
std::vector<Ogre::ColourValue> colorsOf(const BodyCatalog& catalog, const std::vector<BodyPlace>& places,
                                        const std::vector<BodyDetail>& details, const Coloring& coloring);

/// One line of a legend.
struct LegendEntry {
  std::string label;
  std::vector<Ogre::ColourValue> colors;  ///< one colour, several that take turns, or samples of a scale
  bool is_scale = false;
  std::string low{}, high{};  ///< what the ends of a scale stand for
};
/// Which colour stands for what.
std::vector<LegendEntry> legendOf(const Coloring& coloring);
/// The same in a sentence.
std::string sentenceOf(const Coloring& coloring);

/// From dark blue through grey to yellow: lighter is more, also where hues are not seen. `share` 0 to 1.
Ogre::ColourValue scaleColor(float share);

/// The bright end for the errors of these details: a power of ten, m. `last`: the one before, which stays while
/// it fits; 0: there is none.
float errorRange(const std::vector<BodyDetail>& details, float last);

}  // namespace rbs
