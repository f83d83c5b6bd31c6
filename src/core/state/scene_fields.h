// SPDX-License-Identifier: BSD-3-Clause
// What surrounds the bodies of a scene, key by key. The reader and the writer of scene files, the check, the
// state hash and the analysis go through these lists: a new surrounding is a member of SceneDef, and its
// lines here.
#pragma once

#include "rigid_body_sim/scene.h"

namespace rbs {

/// What a number may be; of a vector, its length.
struct Range {
  double low, high;
  const char* unit;
};

/// Which surrounding the fields are of.
template <class Surrounding>
struct Of {};

/// Visits each surrounding: its key, its member of SceneDef (a std::optional), and the type of its fields.
template <class Visit>
void forEachSurrounding(const Visit& visit) {
  visit("air", &SceneDef::air, Of<Air>{});
  visit("wind", &SceneDef::wind, Of<Wind>{});
  visit("fluid", &SceneDef::fluid, Of<Fluid>{});
}

/// Visits each field of a surrounding: its key, its member, and what it may be.
template <class Visit>
void forEachField(Of<Air>, const Visit& visit) {
  visit("density", &Air::density, Range{Limits::min_density, Limits::max_density, "kg/m^3"});
}
template <class Visit>
void forEachField(Of<Wind>, const Visit& visit) {
  visit("velocity", &Wind::velocity, Range{0.0, Limits::max_wind, "m/s"});
  visit("gust", &Wind::gust, Range{0.0, Limits::max_wind, "m/s"});
}
template <class Visit>
void forEachField(Of<Fluid>, const Visit& visit) {
  visit("density", &Fluid::density, Range{Limits::min_density, Limits::max_density, "kg/m^3"});
  visit("level", &Fluid::level, Range{-Limits::max_position, Limits::max_position, "m"});
}

/// Whether two scenes are the same to the stages, but for their bodies.
inline bool sameSurroundings(const SceneDef& a, const SceneDef& b) {
  bool same = a.gravity == b.gravity && a.fidelity == b.fidelity && a.effects == b.effects;
  forEachSurrounding([&](const char*, auto surrounding, auto type) {
    const auto &of_a = a.*surrounding, &of_b = b.*surrounding;
    same = same && of_a.has_value() == of_b.has_value();
    if (!same || !of_a) return;
    forEachField(type, [&](const char*, auto field, Range) { same = same && *of_a.*field == *of_b.*field; });
  });
  return same;
}

}  // namespace rbs
