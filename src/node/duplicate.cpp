// SPDX-License-Identifier: BSD-3-Clause
#include "duplicate.h"

#include "names.h"
#include "rigid_body_sim/quote.h"

#include <algorithm>
#include <limits>
#include <unordered_map>

namespace rbs {
namespace {

constexpr std::uint64_t kMostCopies = 100'000;

// From the lowest to the highest point of the balls that hold the bodies, and a hundredth more.
Vec3 above(const std::vector<BodyDef>& originals) {
  constexpr double kClear = 1.01, kInfinity = std::numeric_limits<double>::infinity();
  double low = kInfinity, high = -kInfinity;
  for (const BodyDef& body : originals) {
    const double radius = boundingRadius(body.shape), z = body.pose.p_WB.z();
    low = std::min(low, z - radius);
    high = std::max(high, z + radius);
  }
  return {0.0, 0.0, kClear * (high - low)};
}

}  // namespace

std::vector<std::size_t> indicesNamed(const World& world, const std::vector<std::string>& names,
                                      const std::string& field) {
  if (names.empty()) throw InvalidInput({{field, "empty", "at least one"}});
  const auto bodies = world.bodies();
  std::unordered_map<std::string, std::size_t> known;
  for (std::size_t i = 0; i < bodies->size(); ++i) known.emplace((*bodies)[i].name, i);
  std::vector<bool> given(bodies->size(), false);
  std::vector<std::size_t> indices;
  for (std::size_t k = 0; k < names.size(); ++k) {
    const auto it = known.find(names[k]);
    if (it == known.end()) bodyNamed(world, names[k], field);  // throws
    if (given[it->second]) throw InvalidInput({{field, quoted(names[k]) + " twice", "each body once"}});
    given[it->second] = true;
    indices.push_back(it->second);
  }
  return indices;
}

std::vector<BodyId> duplicate(World& world, const std::vector<std::string>& names, std::uint32_t count,
                              const Vec3& offset) {
  const std::vector<std::size_t> indices = indicesNamed(world, names);
  if (count * std::uint64_t(names.size()) > kMostCopies)
    throw InvalidInput({{"count", std::to_string(count), "at most 100,000 copies of all bodies together"}});
  const std::vector<BodyDef> all = world.capture().bodies;
  std::vector<BodyDef> originals, copies;
  for (const std::size_t i : indices) originals.push_back(all[i]);
  const Vec3 step = finiteVector(offset, "offset").isZero(0.0) ? above(originals) : offset;
  if (!step.allFinite())
    throw InvalidInput({{"offset", "zero", "an offset, since one of the bodies is a plane"}});
  for (const BodyDef& original : originals) {
    for (std::uint32_t k = 1; k <= count; ++k) {
      BodyDef copy = original;
      copy.name.clear();
      copy.pose.p_WB += k * step;
      copies.push_back(copy);
    }
  }
  return world.addBodies(copies);
}

}  // namespace rbs
