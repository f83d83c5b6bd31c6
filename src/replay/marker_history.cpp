// SPDX-License-Identifier: BSD-3-Clause
#include "marker_history.h"

#include <algorithm>

namespace rbs {

using visualization_msgs::Marker;

void MarkerHistory::add(std::uint32_t entry, const std::vector<Marker>& markers) {
  for (std::size_t place = 0; place < markers.size(); ++place) {
    const Marker& marker = markers[place];
    if (marker.action == Marker::DELETEALL) {
      for (auto& [key, changes] : changes_) changes.push_back({entry, kDeleted});
    } else {
      changes_[{marker.ns, marker.id}].push_back({entry, marker.action == Marker::DELETE ? kDeleted : place});
    }
  }
}

std::map<std::uint32_t, std::vector<std::size_t>> MarkerHistory::standing(std::size_t count) const {
  std::map<std::uint32_t, std::vector<std::size_t>> standing;
  for (const auto& [key, changes] : changes_) {
    const auto next = std::lower_bound(changes.begin(), changes.end(), count,
                                       [](const Change& change, std::size_t n) { return change.entry < n; });
    if (next == changes.begin()) continue;
    const Change& last = *(next - 1);
    if (last.place != kDeleted) standing[last.entry].push_back(last.place);
  }
  return standing;
}

}  // namespace rbs
