// SPDX-License-Identifier: BSD-3-Clause
#include "body_colors.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <sstream>

namespace rbs {
namespace {

using Ogre::ColourValue;
using Links = std::vector<std::pair<std::size_t, std::size_t>>;

const ColourValue kGrey(0.62f, 0.64f, 0.67f), kAwake(0.90f, 0.62f, 0.00f), kAsleep(0.22f, 0.45f, 0.70f);

// The palette of Okabe and Ito (2008) without black.
const std::array<ColourValue, 7> kIslands = {
    ColourValue(0.90f, 0.62f, 0.00f), ColourValue(0.34f, 0.71f, 0.91f), ColourValue(0.00f, 0.62f, 0.45f),
    ColourValue(0.94f, 0.89f, 0.26f), ColourValue(0.00f, 0.45f, 0.70f), ColourValue(0.84f, 0.37f, 0.00f),
    ColourValue(0.80f, 0.47f, 0.65f)};

// An island keeps its colour while it keeps its first body.
ColourValue islandColor(std::uint64_t first_id) {
  return kIslands[first_id % kIslands.size()];
}

ColourValue colorOf(const BodyPlace& place, ColorBy by, float fastest) {
  if (by == ColorBy::Speed) return scaleColor(place.velocity.length() / fastest);
  const bool is_asleep = place.velocity == Ogre::Vector3::ZERO && place.turn_rate == 0.0f;
  return is_asleep ? kAsleep : kAwake;
}

}  // namespace

ColourValue scaleColor(float share) {
  // Samples of the scale "cividis" (Nunez, Anderton and Renslow 2018).
  static const std::array<ColourValue, 5> kScale = {
      ColourValue(0.00f, 0.13f, 0.30f), ColourValue(0.25f, 0.30f, 0.42f), ColourValue(0.48f, 0.48f, 0.47f),
      ColourValue(0.73f, 0.68f, 0.42f), ColourValue(1.00f, 0.92f, 0.27f)};
  const float at = std::clamp(share, 0.0f, 1.0f) * static_cast<float>(kScale.size() - 1);
  const std::size_t k = std::min(static_cast<std::size_t>(at), kScale.size() - 2);
  return kScale[k] + (at - static_cast<float>(k)) * (kScale[k + 1] - kScale[k]);
}

std::vector<std::size_t> islandsOf(const BodyCatalog& catalog, const Links& links) {
  std::vector<std::size_t> first(catalog.bodies.size());
  std::iota(first.begin(), first.end(), std::size_t{0});
  const auto root = [&](std::size_t k) {
    while (first[k] != k) k = first[k] = first[first[k]];
    return k;
  };
  for (const auto& [a, b] : links) {
    if (!catalog.bodies[a].is_dynamic || !catalog.bodies[b].is_dynamic) continue;
    const std::size_t one = root(a), other = root(b);
    first[std::max(one, other)] = std::min(one, other);
  }
  for (std::size_t k = 0; k < first.size(); ++k) first[k] = root(k);
  return first;
}

std::vector<ColourValue> colorsOf(const BodyCatalog& catalog, const std::vector<BodyPlace>& places,
                                  ColorBy by, const Links& links, float fastest) {
  const auto islands = by == ColorBy::Island ? islandsOf(catalog, links) : std::vector<std::size_t>();
  std::vector<ColourValue> colors;
  colors.reserve(places.size());
  for (std::size_t k = 0; k < places.size(); ++k) {
    const CatalogBody& body = catalog.bodies[k];
    ColourValue color = body.color;
    if (by != ColorBy::Material) {
      color = !body.is_dynamic        ? kGrey
              : by == ColorBy::Island ? islandColor(catalog.bodies[islands[k]].id)
                                      : colorOf(places[k], by, fastest);
      color.a = body.color.a;
    }
    colors.push_back(color);
  }
  return colors;
}

std::string legendOf(ColorBy by, float fastest) {
  std::ostringstream text;
  switch (by) {
    case ColorBy::Material:
      return "each body in its own colour";
    case ColorBy::Island:
      return "bodies that contacts connect share a colour; seven colours take turns";
    case ColorBy::Awake:
      return "orange: awake; blue: asleep, or at rest to the last bit; grey: not moved by forces";
    case ColorBy::Speed:
      text << "dark blue: 0 m/s; grey: " << 0.5f * fastest << " m/s; yellow: " << fastest
           << " m/s or more; bodies that forces do not move are grey";
  }
  return text.str();
}

}  // namespace rbs
