// SPDX-License-Identifier: BSD-3-Clause
#include "body_colors.h"

#include "length_text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

namespace rbs {
namespace {

using Ogre::ColourValue;
using rigid_body_sim::BodyDetails;

const ColourValue kGrey(0.62f, 0.64f, 0.67f), kAwake(0.90f, 0.62f, 0.00f), kAsleep(0.22f, 0.45f, 0.70f),
    kFlying(0.93f, 0.94f, 0.95f);

// The palette of Okabe and Ito (2008) without black.
const std::array<ColourValue, 7> kIslands = {
    ColourValue(0.90f, 0.62f, 0.00f), ColourValue(0.34f, 0.71f, 0.91f), ColourValue(0.00f, 0.62f, 0.45f),
    ColourValue(0.94f, 0.89f, 0.26f), ColourValue(0.00f, 0.45f, 0.70f), ColourValue(0.84f, 0.37f, 0.00f),
    ColourValue(0.80f, 0.47f, 0.65f)};

/// The colour of a method of BodyDetails.
struct MethodColor {
  std::uint8_t method;
  const char* label;
  ColourValue color;
};
// From nothing to do to the most expensive. Of the same palette, with a white and a dark end.
const std::array<MethodColor, 9> kMethods = {
    MethodColor{BodyDetails::ASLEEP, "asleep", kIslands[4]},
    MethodColor{BodyDetails::BALLISTIC, "ballistic", kFlying},
    MethodColor{BodyDetails::FLIGHT, "free flight", kIslands[1]},
    MethodColor{BodyDetails::SOFT_STEP, "soft step", kIslands[2]},
    MethodColor{BodyDetails::WARM_START, "exact: warm start", kIslands[3]},
    MethodColor{BodyDetails::GAUSS_SEIDEL, "exact: Gauss-Seidel", kIslands[0]},
    MethodColor{BodyDetails::NEWTON, "exact: Newton", kIslands[5]},
    MethodColor{BodyDetails::INTERIOR_POINT, "exact: interior point", kIslands[6]},
    MethodColor{BodyDetails::ADMM, "exact: ADMM", ColourValue(0.20f, 0.10f, 0.25f)}};

constexpr float kErrorDecades = 3.0f;

bool flies(const BodyDetail& detail) {
  return detail.method == BodyDetails::FLIGHT || detail.method == BodyDetails::BALLISTIC;
}

// An island keeps its colour while it keeps its oldest body.
ColourValue islandColor(const BodyDetail& detail) {
  if (flies(detail)) return kFlying;
  return detail.island == 0 ? kGrey : kIslands[detail.island % kIslands.size()];
}

ColourValue methodColor(const BodyDetail& detail) {
  const auto known = std::find_if(kMethods.begin(), kMethods.end(),
                                  [&](const MethodColor& row) { return row.method == detail.method; });
  return known != kMethods.end() ? known->color : kGrey;
}

ColourValue errorColor(const BodyDetail& detail, float largest) {
  if (!detail.distance) return kGrey;
  if (*detail.distance <= 0.0f) return scaleColor(0.0f);
  return scaleColor(1.0f + std::log10(*detail.distance / largest) / kErrorDecades);
}

ColourValue awakeColor(const BodyPlace& place) {
  return place.velocity == Ogre::Vector3::ZERO && place.turn_rate == 0.0f ? kAsleep : kAwake;
}

ColourValue colorOf(const CatalogBody& body, const BodyPlace& place, const BodyDetail& detail,
                    const Coloring& coloring) {
  if (coloring.by == ColorBy::Material) return body.color;
  if (!body.is_dynamic) return kGrey;
  switch (coloring.by) {
    case ColorBy::Island:
      return islandColor(detail);
    case ColorBy::Awake:
      return awakeColor(place);
    case ColorBy::Speed:
      return scaleColor(place.velocity.length() / coloring.fastest);
    case ColorBy::Solver:
      return methodColor(detail);
    case ColorBy::Error:
      return errorColor(detail, coloring.largest);
    case ColorBy::Material:
      break;
  }
  return body.color;
}

template <class... Parts>
std::string words(const Parts&... parts) {
  std::ostringstream text;
  (text << ... << parts);
  return text.str();
}

LegendEntry scaleEntry(const std::string& label, const std::string& low, const std::string& high) {
  LegendEntry entry{label, {}, true, low, high};
  constexpr int kSamples = 9;
  for (int k = 0; k < kSamples; ++k)
    entry.colors.push_back(scaleColor(static_cast<float>(k) / static_cast<float>(kSamples - 1)));
  return entry;
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

std::vector<ColourValue> colorsOf(const BodyCatalog& catalog, const std::vector<BodyPlace>& places,
                                  const std::vector<BodyDetail>& details, const Coloring& coloring) {
  std::vector<ColourValue> colors;
  colors.reserve(places.size());
  for (std::size_t k = 0; k < places.size(); ++k) {
    const CatalogBody& body = catalog.bodies[k];
    const BodyDetail detail = k < details.size() ? details[k] : BodyDetail{};
    ColourValue& color = colors.emplace_back(colorOf(body, places[k], detail, coloring));
    color.a = body.color.a;
  }
  return colors;
}

std::vector<LegendEntry> legendOf(const Coloring& coloring) {
  std::vector<LegendEntry> legend;
  switch (coloring.by) {
    case ColorBy::Material:
      return {};
    case ColorBy::Island:
      legend.push_back({"islands, by turns", {kIslands.begin(), kIslands.end()}});
      legend.push_back({"touches nothing", {kFlying}});
      break;
    case ColorBy::Awake:
      legend.push_back({"awake", {kAwake}});
      legend.push_back({"asleep or at rest", {kAsleep}});
      break;
    case ColorBy::Speed:
      legend.push_back(scaleEntry("speed", "0", words(coloring.fastest, " m/s")));
      break;
    case ColorBy::Solver:
      for (const MethodColor& row : kMethods) legend.push_back({row.label, {row.color}});
      break;
    case ColorBy::Error:
      legend.push_back(
          scaleEntry("error", lengthText(coloring.largest * 1e-3f), lengthText(coloring.largest)));
      break;
  }
  legend.push_back({"not moved", {kGrey}});
  return legend;
}

std::string sentenceOf(const Coloring& coloring) {
  switch (coloring.by) {
    case ColorBy::Material:
      return "each body in its own colour";
    case ColorBy::Island:
      return "bodies that the solver takes as one island share a colour; seven colours take turns; white: "
             "touches nothing; grey: not moved by forces";
    case ColorBy::Awake:
      return "orange: awake; blue: asleep, or at rest to the last bit; grey: not moved by forces";
    case ColorBy::Speed:
      return words("dark blue: 0 m/s; grey: ", 0.5f * coloring.fastest, " m/s; yellow: ", coloring.fastest,
                   " m/s or more; bodies that forces do not move are grey");
    case ColorBy::Solver:
      return "what took each body through the last step: blue: asleep; white: ballistic; light blue: free "
             "flight; green: the soft step; yellow, orange, red, pink, dark: the exact step by its warm "
             "start, "
             "Gauss-Seidel, Newton, interior point, ADMM; grey: not moved by forces";
    case ColorBy::Error:
      return words("distance from the reference run, on a logarithmic scale: dark blue: ",
                   lengthText(coloring.largest * 1e-3f), " or less; yellow: ", lengthText(coloring.largest),
                   " or more; grey: not moved by forces");
  }
  return "";
}

float errorRange(const std::vector<BodyDetail>& details, float last) {
  constexpr float kLeast = 1e-6f;
  float largest = 0.0f;
  for (const BodyDetail& detail : details) largest = std::max(largest, detail.distance.value_or(0.0f));
  if (last > 0.0f && largest <= last && largest >= 1e-2f * last) return last;
  return std::max(kLeast, std::pow(10.0f, std::ceil(std::log10(std::max(largest, kLeast)) - 1e-3f)));
}

}  // namespace rbs
