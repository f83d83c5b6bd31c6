// SPDX-License-Identifier: BSD-3-Clause
#include "words.h"

#include <cinttypes>
#include <cstdio>

namespace rbs {

std::string inWords(const Vec3& v) {
  return words('(', v.x(), ", ", v.y(), ", ", v.z(), ')');
}

std::string hexadecimal(std::uint64_t number) {
  char digits[17];
  std::snprintf(digits, sizeof digits, "%016" PRIx64, number);
  return digits;
}

std::string bodyCount(std::size_t n) {
  return words(n, n == 1 ? " body" : " bodies");
}

std::string describe(const BodyDescription& body) {
  std::string text = words(kindName(body.kind), ' ', shapeName(body.shape));
  if (!std::holds_alternative<Plane>(body.shape)) {
    text += words(", size ", inWords(fullExtents(body.shape)), " m");
    if (const auto* hull = std::get_if<ConvexHull>(&body.shape)) {
      text += words(", ", hull->polyhedron->vertices.size(), " vertices");
    }
    text += words(", mass ", body.mass, " kg");
  }
  text += words(", friction ", body.material.friction, ", restitution ", body.material.restitution);
  if (body.material.rolling_resistance > 0.0)
    text += words(", rolling resistance ", body.material.rolling_resistance);
  if (body.material.torsional_resistance > 0.0)
    text += words(", torsional resistance ", body.material.torsional_resistance);
  return body.frozen ? text + ", frozen" : text;
}

std::string describe(const AirState& air) {
  if (!air.air) return "no air";
  if (!air.wind) return words("air of ", air.density, " kg/m^3 at rest");
  return words("air of ", air.density, " kg/m^3, wind ", inWords(air.mean), " m/s, gust ", air.gust, " m/s");
}

std::vector<std::string> stageChanges(const std::vector<StageInfo>& before,
                                      const std::vector<StageInfo>& after) {
  std::vector<std::string> lines;
  for (std::size_t k = 0; k < after.size(); ++k) {
    if (after[k].active == before[k].active && after[k].reason == before[k].reason) continue;
    lines.push_back(words(after[k].name, after[k].active ? " on: " : " off: ", after[k].reason));
  }
  return lines;
}

}  // namespace rbs
