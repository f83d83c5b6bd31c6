// SPDX-License-Identifier: BSD-3-Clause
// Runs the commands of a recording again, and compares every state hash that it holds.
//
// Exit codes: 0 all hashes are equal, 1 some hash differs, 2 no recording that can be run again.
#include "rigid_body_sim/recording.h"

#include <rigid_body_sim/Command.h>
#include <rigid_body_sim/Status.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>

#include <boost/program_options.hpp>

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <map>
#include <set>
#include <stdexcept>

namespace {

using namespace rbs;
using CommandMsg = rigid_body_sim::Command;
using StatusMsg = rigid_body_sim::Status;

constexpr int kEqual = 0, kDiffers = 1, kNoRecording = 2;

struct Request {
  std::string bag, node;
};

std::uint64_t numberOf(const std::string& hash) {
  char* end = nullptr;
  const std::uint64_t number = std::strtoull(hash.c_str(), &end, 16);
  if (hash.size() != 16 || *end != '\0')
    throw std::runtime_error("a hash is no 16 hex digits: '" + hash + "'");
  return number;
}

/// 12,345.
std::string grouped(std::uint64_t number) {
  std::string text = std::to_string(number);
  for (int place = static_cast<int>(text.size()) - 3; place > 0; place -= 3) text.insert(place, ",");
  return text;
}

std::string counted(std::uint64_t number, const std::string& thing) {
  return grouped(number) + " " + thing + (number == 1 ? "" : thing.back() == 'h' ? "es" : "s");
}

/// Whether a file begins as every bag does.
bool beginsAsBag(const std::string& file) {
  const std::string mark = "#ROSBAG";
  std::string begin(mark.size(), '\0');
  std::ifstream(file, std::ios::binary).read(begin.data(), static_cast<std::streamsize>(begin.size()));
  return begin == mark;
}

void open(const std::string& file, rosbag::Bag& bag) {
  try {
    bag.open(file, rosbag::bagmode::Read);
  } catch (const rosbag::BagException& error) {
    if (beginsAsBag(file))
      throw std::runtime_error(file + " is cut off: `rosbag reindex " + file + "` saves what it has");
    throw std::runtime_error(file + " is no bag that can be read: " + error.what());
  }
}

/// The namespace of the simulator that was recorded: "/sim".
std::string simulatorIn(rosbag::Bag& bag, const Request& request) {
  const std::string ending = "/commands";
  std::set<std::string> nodes;
  rosbag::View all(bag, rosbag::TypeQuery(ros::message_traits::datatype<CommandMsg>()));
  for (const rosbag::ConnectionInfo* connection : all.getConnections()) {
    const std::string& topic = connection->topic;
    const bool usual = topic.size() > ending.size() &&
                       topic.compare(topic.size() - ending.size(), ending.size(), ending) == 0;
    if (usual) nodes.insert(topic.substr(0, topic.size() - ending.size()));
  }
  std::string names;
  for (const std::string& node : nodes) names += (names.empty() ? "" : ", ") + node;
  if (nodes.empty())
    throw std::runtime_error(request.bag +
                             " has no commands: record the topic ~commands of the simulator, too");
  if (!request.node.empty()) {
    if (nodes.count(request.node)) return request.node;
    throw std::runtime_error("no commands of --node " + request.node + "; simulators in the bag: " + names);
  }
  if (nodes.size() > 1)
    throw std::runtime_error(request.bag +
                             " has commands of several simulators: choose one by --node: " + names);
  return *nodes.begin();
}

template <class Message>
void requireDefinition(rosbag::View& view) {
  for (const rosbag::ConnectionInfo* connection : view.getConnections())
    if (connection->md5sum != ros::message_traits::md5sum<Message>())
      throw std::runtime_error(connection->topic + " was recorded by another version of " +
                               connection->datatype);
}

Recorded entryOf(const CommandMsg& msg) {
  const std::string source = "entry " + std::to_string(msg.sequence);
  Recorded entry{msg.sequence, msg.world, msg.step, msg.time, numberOf(msg.hash), Recorded::Checkpoint()};
  if (msg.kind == "checkpoint") {
    if (!msg.checkpoint.empty())
      entry.what = std::make_shared<const SceneFile>(parseScene(msg.checkpoint, source));
    return entry;
  }
  Recorded::Commands commands;
  for (const std::string& text : msg.commands) {
    if (text.empty()) throw std::runtime_error(source + " has a command that was too large to be recorded");
    commands.push_back(parseCommand(text, source));
  }
  entry.what = std::move(commands);
  return entry;
}

/// Shows on a terminal how far it is; elsewhere a line every ten seconds.
class Progress {
 public:
  explicit Progress(std::size_t entries) : entries_(entries) {}
  ~Progress() { clear(); }
  void clear() const {
    if (terminal_) std::fprintf(stderr, "\r\033[K");
  }
  void show(std::size_t entry, const Resimulation& run) const {
    const auto now = std::chrono::steady_clock::now();
    if (now - shown_ < (terminal_ ? std::chrono::milliseconds(200) : std::chrono::milliseconds(10000)))
      return;
    shown_ = now;
    std::fprintf(stderr, "%s%3d %%: %s, %s equal%s", terminal_ ? "\r\033[K" : "",
                 static_cast<int>(100 * entry / std::max<std::size_t>(entries_, 1)),
                 counted(run.steps(), "step").c_str(), counted(run.hashes(), "hash").c_str(),
                 terminal_ ? "" : "\n");
  }

 private:
  const std::size_t entries_;
  const bool terminal_ = isatty(STDERR_FILENO) == 1;
  mutable std::chrono::steady_clock::time_point shown_ = std::chrono::steady_clock::now();
};

/// The bodies that differ most from the checkpoint, at most five.
void printBodies(const World& world, const SceneFile& checkpoint, const Recorded& entry) {
  std::map<std::string, Vec3> found;
  for (const BodyDef& body : world.capture().bodies) found[body.name] = body.pose.p_WB;
  std::vector<std::pair<double, std::string>> distances;
  std::size_t missing = 0;
  for (const BodyDef& body : checkpoint.scene.bodies) {
    const auto other = found.find(body.name);
    if (other == found.end()) {
      ++missing;
      continue;
    }
    const double distance = (other->second - body.pose.p_WB).norm();
    if (distance > 0.0) distances.emplace_back(distance, body.name);
    found.erase(other);
  }
  const std::size_t moved = distances.size();
  std::printf("At the checkpoint of step %s, ", grouped(entry.step).c_str());
  if (missing + found.size() > 0)
    std::printf("%zu recorded bodies are missing and %zu are not in the recording; ", missing, found.size());
  if (moved == 0) {
    const bool equal = world.stateHash() == entry.hash;
    std::printf("no body is elsewhere%s.\n", equal ? ", and the hash is equal again" : "");
    return;
  }
  std::printf("%zu of %zu bodies %s elsewhere; the farthest:\n", moved, checkpoint.scene.bodies.size(),
              moved == 1 ? "is" : "are");
  std::sort(distances.rbegin(), distances.rend());
  if (distances.size() > 5) distances.resize(5);
  for (const auto& [distance, name] : distances) std::printf("  %-24s %.3g m\n", name.c_str(), distance);
}

/// A recording in a bag: its entries are read one by one, since checkpoints are large.
class Recording {
 public:
  Recording(rosbag::Bag& bag, const std::string& node, const std::string& file)
      : commands_(bag, rosbag::TopicQuery(node + "/commands")),
        statuses_(bag, rosbag::TopicQuery(node + "/status")) {
    requireDefinition<CommandMsg>(commands_);
    requireDefinition<StatusMsg>(statuses_);
    if (commands_.size() == 0) throw std::runtime_error(file + " has no commands");
  }

  int run() {
    for (const rosbag::MessageInstance& instance : statuses_) {
      const auto status = instance.instantiate<StatusMsg>();
      run_.expect(status->world, status->steps, numberOf(status->hash), status->recorded);
    }
    std::optional<Mismatch> found = takeAll();
    if (!found && (found = run_.finish())) print(*found);
    std::printf("re-simulated %s (%.1f s) with %s: %s equal%s\n", counted(run_.steps(), "step").c_str(),
                run_.seconds(), counted(run_.commands(), "command").c_str(),
                counted(run_.hashes(), "hash").c_str(), found ? ", then one differs" : "");
    if (run_.uncovered() > 0)
      std::printf("The bag was cut off: it lacks the last commands, whose work the last %s of ~status has.\n",
                  counted(run_.uncovered(), "hash").c_str());
    return found ? kDiffers : kEqual;
  }

 private:
  std::optional<Mismatch> takeAll() {
    const Progress progress(commands_.size());
    std::size_t n = 0;
    bool has_begun = false;
    for (auto at = commands_.begin(); at != commands_.end(); ++at, ++n) {
      const Recorded entry = next(*at);
      // A recorder may hear of entries for others before it gets its own checkpoint.
      has_begun = has_begun || std::holds_alternative<Recorded::Checkpoint>(entry.what);
      if (!has_begun) continue;
      const std::optional<Mismatch> found = run_.take(entry);
      if (found) {
        progress.clear();
        print(*found);
        if (!compareBodies(found->world, entry)) lookAhead(found->world, ++at);
        return found;
      }
      progress.show(n, run_);
    }
    if (!has_begun) throw std::runtime_error("the bag has no checkpoint to begin with");
    return std::nullopt;
  }

  Recorded next(const rosbag::MessageInstance& instance) {
    const CommandMsg::ConstPtr message = instance.instantiate<CommandMsg>();
    const CommandMsg& msg = *message;
    if (sequence_ && msg.sequence != *sequence_ + 1)
      throw std::runtime_error(
          "entry " + std::to_string(*sequence_) + " of the commands is followed by entry " +
          std::to_string(msg.sequence) +
          (msg.sequence > *sequence_
               ? ": those between were lost while recording"
               : ": the simulator was started anew, and a bag should have one run of it"));
    sequence_ = msg.sequence;
    return entryOf(msg);
  }

  /// Goes on after a mismatch in this world to its next checkpoint, and says where the bodies are by then.
  void lookAhead(std::uint64_t world, rosbag::View::iterator at) {
    try {
      for (; at != commands_.end(); ++at) {
        const Recorded entry = next(*at);
        if (entry.world != world) break;
        run_.take(entry);
        if (compareBodies(world, entry)) return;
      }
    } catch (const std::exception&) {  // no recording from there on: the mismatch has been reported
    }
    std::printf("No checkpoint of this world follows, so where the bodies are is not known.\n");
  }

  /// Returns whether the entry has the bodies of this world.
  bool compareBodies(std::uint64_t world, const Recorded& entry) {
    const auto* checkpoint = std::get_if<Recorded::Checkpoint>(&entry.what);
    if (entry.world != world || !checkpoint || !*checkpoint) return false;
    printBodies(run_.world(), **checkpoint, entry);
    return true;
  }

  void print(const Mismatch& found) {
    std::printf("step %s of world %" PRIu64 " (%.6g s), %s: ", grouped(found.step).c_str(), found.world,
                found.time, found.at.c_str());
    if (found.refusal.empty()) {
      std::printf("hash %016" PRIx64 " is recorded, %016" PRIx64 " found\n", found.expected, found.found);
    } else {
      std::printf("the command was taken when it was recorded, and is refused now: %s\n",
                  found.refusal.c_str());
    }
    if (found.clocked)
      std::printf("The solver settings had max_solve_ms: results then depend on the clock.\n");
  }

  rosbag::View commands_, statuses_;
  Resimulation run_;
  std::optional<std::uint64_t> sequence_;
};

int resimulate(const Request& request) {
  rosbag::Bag bag;
  open(request.bag, bag);
  const std::string node = simulatorIn(bag, request);
  return Recording(bag, node, request.bag).run();
}

}  // namespace

int main(int argc, char** argv) {
  namespace po = boost::program_options;
  Request request;
  po::options_description options(
      "Runs the commands of a recording again and compares every state hash.\n"
      "Usage: resimulate BAG [OPTIONS]\n"
      "Exit codes: 0 all hashes are equal, 1 some hash differs, 2 no recording that can be run again");
  auto add = options.add_options();
  add("help", "print this");
  add("bag", po::value(&request.bag), "a bag with ~commands of a simulator, and best its ~status");
  add("node", po::value(&request.node), "name of the simulator, where the bag has several: /left/sim");
  po::positional_options_description positions;
  positions.add("bag", 1);
  try {
    po::variables_map given;
    po::store(po::command_line_parser(argc, argv).options(options).positional(positions).run(), given);
    po::notify(given);
    if (given.count("help") || request.bag.empty()) {
      std::cout << options;
      return given.count("help") ? 0 : kNoRecording;
    }
    return resimulate(request);
  } catch (const po::error& error) {
    std::cerr << "resimulate: " << error.what() << "\n\n" << options;
    return kNoRecording;
  } catch (const std::exception& error) {
    std::cerr << "resimulate: " << error.what() << '\n';
    return kNoRecording;
  }
}
