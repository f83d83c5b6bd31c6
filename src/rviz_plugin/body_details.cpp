// SPDX-License-Identifier: BSD-3-Clause
#include "body_details.h"

#include <cmath>

namespace rbs {
namespace {

using rigid_body_sim::BodyDetails;

std::optional<float> distanceOf(const BodyDetails& message, std::size_t k) {
  constexpr double kMost = 1e30;  // that a float can hold
  if (message.reference_distances.empty()) return std::nullopt;
  const double distance = message.reference_distances[k];
  if (!(distance >= 0.0 && distance <= kMost))
    throw BadMessage("distance " + std::to_string(distance) + " of body " + std::to_string(message.ids[k]) +
                     " from the reference run");
  return static_cast<float>(distance);
}

}  // namespace

std::vector<BodyDetail> readDetails(const BodyDetails& message, const BodyCatalog& catalog) {
  const std::size_t n = message.ids.size();
  const std::size_t distances = message.reference_distances.size();
  if (message.methods.size() != n || message.islands.size() != n || (distances != 0 && distances != n))
    throw BadMessage("lists of different lengths");
  std::unordered_map<std::uint64_t, BodyDetail> by_id;
  for (std::size_t k = 0; k < n; ++k) {
    if (message.methods[k] > BodyDetails::ADMM)
      throw BadMessage("method " + std::to_string(message.methods[k]) + " of body " +
                       std::to_string(message.ids[k]));
    by_id[message.ids[k]] = {message.methods[k], message.islands[k], distanceOf(message, k)};
  }
  std::vector<BodyDetail> details;
  details.reserve(catalog.bodies.size());
  for (const CatalogBody& body : catalog.bodies) {
    const auto known = by_id.find(body.id);
    details.push_back(known != by_id.end() ? known->second : BodyDetail{});
  }
  return details;
}

}  // namespace rbs
