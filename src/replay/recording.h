// SPDX-License-Identifier: BSD-3-Clause
// Recording: the bag of one simulator, with its messages in the order of its own time.
//
// The time of a recording is that of the simulator's stamps: a second of it is a second of the simulation, however slow
// that ran, and a pause takes none. It starts with the first state for which every topic of the simulator has been
// heard. A message without a stamp has the time of the last one before it. Where the simulator was started again its
// stamps begin anew, and the recording goes on with a new part.
#pragma once

#include "marker_history.h"

#include <rosbag/bag.h>
#include <rosbag/message_instance.h>

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace rbs {

using Nanoseconds = std::int64_t;

class Recording {
 public:
  struct Entry {
    Nanoseconds time;     ///< from the start of the recording; 0 also for what came before
    Nanoseconds offset;   ///< from a stamp in the message to the time of the recording
    std::size_t channel;  ///< place in channels()
    rosbag::MessageInstance message;
  };
  /// A topic as one node has published it.
  struct Channel {
    std::string topic;                   ///< in the simulator ("body_states"), or "/tf", "/tf_static"
    std::vector<std::uint32_t> entries;  ///< places in entries()
  };

  /// Opens a bag. `simulator`: full name of its node; empty: the only one that it has. Throws
  /// std::runtime_error, which names the file, for one that cannot be read, was cut off, or is no recording of a
  /// simulator.
  Recording(const std::string& file, const std::string& simulator);

  const std::string& simulator() const { return simulator_; }  ///< full name of its node
  Nanoseconds length() const { return length_; }               ///< time of the last message
  Nanoseconds begin() const { return begin_; }                 ///< stamp at the start
  const std::vector<Entry>& entries() const { return entries_; }
  const std::vector<Channel>& channels() const { return channels_; }
  /// Of the topics that carry markers, by channel.
  const std::map<std::size_t, MarkerHistory>& markers() const { return markers_; }

  /// The number of entries up to this time, those at it included.
  std::size_t countUntil(Nanoseconds time) const;
  /// The number of states after the first `count` entries.
  std::uint32_t statesAfter(std::size_t count) const;
  /// The number of entries up to the n-th of those; n from 1 on.
  std::size_t countUntilState(std::size_t count, std::uint32_t n) const;
  /// The last entry of a channel among the first `count`; null: none.
  const Entry* last(const Channel& channel, std::size_t count) const;

 private:
  void open(const std::string& file);
  void chooseSimulator(const std::string& file, const std::string& wanted);
  void readIndex(const std::string& file);
  Nanoseconds beginOf(const std::vector<Entry>& unsorted, Nanoseconds first_state) const;
  void sortByTime(std::vector<Entry> unsorted);
  void findMarkers();

  rosbag::Bag bag_;
  std::string simulator_;
  Nanoseconds begin_ = 0, length_ = 0;
  std::vector<Entry> entries_;
  std::vector<Channel> channels_;
  std::vector<std::uint32_t> states_;  ///< places of the states in entries_
  std::map<std::size_t, MarkerHistory> markers_;
};

}  // namespace rbs
