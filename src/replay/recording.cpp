// SPDX-License-Identifier: BSD-3-Clause
#include "recording.h"

#include "rigid_body_sim/quote.h"

#include <rigid_body_sim/BodyDescriptions.h>
#include <rigid_body_sim/BodyStates.h>
#include <rigid_body_sim/Contacts.h>
#include <rigid_body_sim/Event.h>
#include <rigid_body_sim/Status.h>
#include <rigid_body_sim/Wind.h>
#include <ros/ros.h>
#include <rosbag/view.h>
#include <tf2_msgs/TFMessage.h>
#include <visualization_msgs/MarkerArray.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <limits>
#include <numeric>
#include <optional>
#include <set>
#include <stdexcept>

namespace rbs {
namespace {

constexpr Nanoseconds kUnknown = -1;
const std::string kStates = "/body_states", kMagic = "#ROSBAG V2.0";
// What a simulator sends from the start on, and how long it takes until a recorder hears all of it.
const std::set<std::string> kSentFromTheStart = {
    "body_descriptions", "contacts", "status", "wind", "/tf", "visualization_marker_array"};
constexpr Nanoseconds kLongestStart = 500'000'000;

[[noreturn]] void refuse(const std::string& file, const std::string& why) {
  throw std::runtime_error(quoted(file, kLongestPath) + " " + why);
}

/// Receives the bytes of a message as it stands in the bag.
class Bytes {
 public:
  std::uint8_t* advance(std::uint32_t count) {
    bytes_.resize(count);
    return bytes_.data();
  }
  /// The stamp that begins at this byte, or kUnknown.
  Nanoseconds stampAt(std::size_t begin) const {
    std::uint32_t parts[2];
    if (bytes_.size() < begin + sizeof parts) return kUnknown;
    std::memcpy(parts, bytes_.data() + begin, sizeof parts);
    return Nanoseconds(parts[0]) * 1'000'000'000 + parts[1];
  }

 private:
  std::vector<std::uint8_t> bytes_;
};

template <class... Messages>
bool isOneOf(const std::string& type) {
  return ((type == ros::message_traits::datatype<Messages>()) || ...);
}

// A header begins with the number of the message, which takes four bytes; a list with its length, which takes four.
std::optional<std::size_t> placeOfStamp(const std::string& type) {
  using namespace rigid_body_sim;
  if (isOneOf<BodyDescriptions, BodyStates, Contacts, Status, Event, Wind>(type)) return 4;
  if (isOneOf<tf2_msgs::TFMessage>(type)) return 8;
  return std::nullopt;
}

/// Whether it is a topic on which all nodes publish.
bool isOfAll(const std::string& topic) {
  return topic == "/tf" || topic == "/tf_static";
}

/// A message that this build reads otherwise than it was written, in words; empty where there is none.
template <class... Messages>
std::string otherVersion(const rosbag::ConnectionInfo& connection) {
  const bool is_other = ((connection.datatype == ros::message_traits::datatype<Messages>() &&
                          connection.md5sum != ros::message_traits::md5sum<Messages>()) ||
                         ...);
  return is_other ? connection.datatype : "";
}

}  // namespace

Recording::Recording(const std::string& file, const std::string& simulator) {
  open(file);
  try {
    chooseSimulator(file, simulator);
    readIndex(file);
    findMarkers();
  } catch (const rosbag::BagException& error) {
    refuse(file, std::string("is damaged (") + printable(error.what(), kLongestPath) +
                     "). 'rosbag reindex' may save the part before the damage");
  } catch (const ros::serialization::StreamOverrunException&) {
    refuse(file, "is damaged: a message in it ends too early");
  } catch (const std::bad_alloc&) {
    refuse(file, "is damaged: a message in it is longer than the memory");
  } catch (const std::length_error&) {
    refuse(file, "is damaged: a message in it is longer than any");
  }
}

void Recording::open(const std::string& file) {
  const std::string cut = "was cut off: it has no index. 'rosbag reindex " + printable(file, kLongestPath) +
                          "' makes one; then replay it again";
  const bool is_active = file.size() > 7 && file.compare(file.size() - 7, 7, ".active") == 0;
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  std::string first(kMagic.size(), '\0');
  stream.read(first.data(), static_cast<std::streamsize>(first.size()));
  if (errno != 0) refuse(file, std::string("cannot be read: ") + std::strerror(errno));
  if (first != kMagic) refuse(file, "is no bag of ROS");
  try {
    bag_.open(file, rosbag::bagmode::Read);
  } catch (const rosbag::BagUnindexedException&) {
    refuse(file, is_active ? "is still being recorded, or " + cut : cut);
  } catch (const rosbag::BagIOException&) {  // it ends before the place where its head says that the index is
    refuse(file, cut);
  } catch (const rosbag::BagException& error) {
    refuse(file, std::string("cannot be read: ") + printable(error.what(), kLongestPath));
  }
}

void Recording::chooseSimulator(const std::string& file, const std::string& wanted) {
  rosbag::View all(bag_);
  std::set<std::string> simulators;
  for (const rosbag::ConnectionInfo* const connection : all.getConnections()) {
    using namespace rigid_body_sim;
    const std::string other =
        otherVersion<BodyDescriptions, BodyStates, Contacts, Status, Event, Wind>(*connection);
    if (!other.empty())
      refuse(file, "was recorded with another version of rigid_body_sim: " + other + " differs");
    const std::string& topic = connection->topic;
    if (!isOneOf<BodyStates>(connection->datatype) || topic.size() <= kStates.size()) continue;
    simulators.insert(topic.substr(0, topic.size() - kStates.size()));
  }
  if (simulators.empty())
    refuse(file,
           "has no states of bodies (~body_states), so it is no recording of a simulator; record.launch "
           "makes one");
  const std::string list =
      std::accumulate(std::next(simulators.begin()), simulators.end(), *simulators.begin(),
                      [](const std::string& names, const std::string& name) { return names + ", " + name; });
  if (wanted.empty() && simulators.size() > 1)
    refuse(file, "has several simulators; choose one by ~simulator: " + list);
  if (!wanted.empty() && simulators.count(wanted) == 0)
    refuse(file, "has no simulator " + quoted(wanted) + "; it has " + list);
  simulator_ = wanted.empty() ? *simulators.begin() : wanted;
}

// In the order in which the messages came; of equal times, in that of the topics.
void Recording::readIndex(const std::string& file) {
  const std::string prefix = simulator_ + "/";
  std::vector<Entry> unsorted;
  std::map<const void*, std::size_t> channels;    // by the header of their connection
  std::map<std::string, Nanoseconds> last_stamp;  // by topic
  Nanoseconds part = 0, part_begin = std::numeric_limits<Nanoseconds>::min(), latest = kUnknown;
  Bytes bytes;
  const auto is_ours = [&](const rosbag::ConnectionInfo* connection) {
    const std::string& topic = connection->topic;
    return isOfAll(topic) || topic.compare(0, prefix.size(), prefix) == 0;
  };
  rosbag::View view(bag_, is_ours);
  for (const rosbag::MessageInstance& message : view) {
    if (ros::isShuttingDown()) refuse(file, "was not read to its end");
    const auto [known, is_new] = channels.emplace(message.getConnectionHeader().get(), channels_.size());
    const std::string& topic = message.getTopic();
    if (is_new) channels_.push_back({isOfAll(topic) ? topic : topic.substr(prefix.size()), {}});
    Nanoseconds time = latest;
    const std::optional<std::size_t> place = placeOfStamp(message.getDataType());
    const bool is_simulators =
        topic != "/tf_static" && (topic != "/tf" || message.getCallerId() == simulator_);
    if (place && is_simulators) {
      message.write(bytes);
      const Nanoseconds stamp = bytes.stampAt(*place);
      if (stamp == kUnknown) continue;
      const auto before = last_stamp.find(topic);
      if (before != last_stamp.end() && stamp < before->second) {  // the simulator was started again
        part_begin = latest + 1;
        part = part_begin - stamp;
        last_stamp.clear();
      }
      last_stamp[topic] = stamp;
      time = std::max(stamp + part, part_begin);  // another topic may have begun earlier
      latest = std::max(latest, time);
    }
    unsorted.push_back({time, part, known->second, message});
  }
  const auto first = std::find_if(unsorted.begin(), unsorted.end(), [this](const Entry& entry) {
    return "/" + channels_[entry.channel].topic == kStates;
  });
  if (first == unsorted.end()) refuse(file, "has no state of bodies: it ended before the simulation began");
  begin_ = beginOf(unsorted, first->time);
  sortByTime(std::move(unsorted));
}

// A recorder hears one topic after the other. The first state for which all of them have been heard.
Nanoseconds Recording::beginOf(const std::vector<Entry>& unsorted, Nanoseconds first_state) const {
  Nanoseconds complete = first_state;
  std::set<std::size_t> heard;
  for (const Entry& entry : unsorted) {
    if (entry.time > first_state + kLongestStart) break;
    if (heard.insert(entry.channel).second && kSentFromTheStart.count(channels_[entry.channel].topic))
      complete = std::max(complete, entry.time);
  }
  for (const Entry& entry : unsorted)
    if (entry.time >= complete && "/" + channels_[entry.channel].topic == kStates) return entry.time;
  return first_state;
}

void Recording::sortByTime(std::vector<Entry> unsorted) {
  for (Entry& entry : unsorted) {
    entry.time = std::max<Nanoseconds>(0, entry.time - begin_);
    entry.offset -= begin_;
  }
  std::vector<std::uint32_t> order(unsorted.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return unsorted[a].time < unsorted[b].time; });
  entries_.reserve(order.size());
  for (const std::uint32_t place : order) {
    const auto number = static_cast<std::uint32_t>(entries_.size());
    entries_.push_back(unsorted[place]);
    Channel& channel = channels_[entries_.back().channel];
    channel.entries.push_back(number);
    if ("/" + channel.topic == kStates) states_.push_back(number);
  }
  length_ = entries_.back().time;
}

void Recording::findMarkers() {
  using visualization_msgs::Marker;
  using visualization_msgs::MarkerArray;
  for (std::size_t c = 0; c < channels_.size(); ++c) {
    for (const std::uint32_t number : channels_[c].entries) {
      const rosbag::MessageInstance& message = entries_[number].message;
      if (const auto array = message.instantiate<MarkerArray>()) {
        markers_[c].add(number, array->markers);
      } else if (const auto marker = message.instantiate<Marker>()) {
        markers_[c].add(number, {*marker});
      } else {
        break;
      }
    }
  }
}

std::size_t Recording::countUntil(Nanoseconds time) const {
  const auto after =
      std::upper_bound(entries_.begin(), entries_.end(), time,
                       [](Nanoseconds until, const Entry& entry) { return until < entry.time; });
  return static_cast<std::size_t>(after - entries_.begin());
}

std::uint32_t Recording::statesAfter(std::size_t count) const {
  return static_cast<std::uint32_t>(states_.end() - std::lower_bound(states_.begin(), states_.end(), count));
}

std::size_t Recording::countUntilState(std::size_t count, std::uint32_t n) const {
  return *(std::lower_bound(states_.begin(), states_.end(), count) + (n - 1)) + 1;
}

const Recording::Entry* Recording::last(const Channel& channel, std::size_t count) const {
  const auto next = std::lower_bound(channel.entries.begin(), channel.entries.end(), count);
  return next == channel.entries.begin() ? nullptr : &entries_[*(next - 1)];
}

}  // namespace rbs
