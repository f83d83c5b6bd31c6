// SPDX-License-Identifier: BSD-3-Clause
// MarkerHistory: which markers stand at any time of a recording. Each message changes a few of them only.
#pragma once

#include <visualization_msgs/Marker.h>

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace rbs {

class MarkerHistory {
 public:
  /// The markers of the next message, which is this entry of the recording.
  void add(std::uint32_t entry, const std::vector<visualization_msgs::Marker>& markers);

  /// The markers that stand after the first `count` entries: places in the messages that set them, by entry.
  std::map<std::uint32_t, std::vector<std::size_t>> standing(std::size_t count) const;

 private:
  static constexpr std::size_t kDeleted = static_cast<std::size_t>(-1);
  struct Change {
    std::uint32_t entry;
    std::size_t place;  ///< in the message; or kDeleted
  };
  std::map<std::pair<std::string, std::int32_t>, std::vector<Change>> changes_;  ///< by namespace and id
};

}  // namespace rbs
