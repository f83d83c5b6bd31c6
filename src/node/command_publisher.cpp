// SPDX-License-Identifier: BSD-3-Clause
#include "command_publisher.h"

#include "words.h"

#include <rigid_body_sim/Command.h>

#include <utility>

namespace rbs {
namespace {

/// Empty, with a warning, where the text would be too large.
template <class Write>
std::string textBy(const Write& write) {
  try {
    return write();
  } catch (const InvalidInput& refusal) {
    ROS_WARN_STREAM_NAMED("recording", "too large to be recorded: " << refusal.what());
    return "";
  }
}

void fill(const Recorded& entry, rigid_body_sim::Command& msg) {
  if (const auto* commands = std::get_if<Recorded::Commands>(&entry.what)) {
    msg.kind = "commands";
    for (const Command& command : *commands)
      msg.commands.push_back(textBy([&] { return writeCommand(command); }));
  } else {
    const SceneFile& world = *std::get<Recorded::Checkpoint>(entry.what);
    msg.kind = "checkpoint";
    msg.checkpoint = textBy([&] { return writeScene(world.scene, world.state); });
  }
}

}  // namespace

CommandPublisher::CommandPublisher(ros::NodeHandle& node, Simulator& simulator, const Timeline& timeline,
                                   double checkpoint_period)
    : simulator_(simulator), timeline_(timeline), checkpoint_period_(checkpoint_period) {
  constexpr std::uint32_t kUnbounded = 0;  // a recording with a gap cannot be run again
  publisher_ = node.advertise<rigid_body_sim::Command>(
      "commands", kUnbounded, [this](const ros::SingleSubscriberPublisher&) { chooseWhetherToRecord(true); },
      [this](const ros::SingleSubscriberPublisher&) { chooseWhetherToRecord(false); });
  thread_ = std::thread([this] { loop(); });
}

CommandPublisher::~CommandPublisher() {
  publisher_.shutdown();
  simulator_.record(nullptr);
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stop_ = true;
  }
  wake_.notify_one();
  thread_.join();
}

// Whoever comes needs a checkpoint to begin with, also beside another.
void CommandPublisher::chooseWhetherToRecord(bool newcomer) {
  const std::lock_guard<std::mutex> lock(subscribing_);
  const bool record = publisher_.getNumSubscribers() > 0;
  if (record == recording_ && !newcomer) return;
  recording_ = record;
  if (record) {
    simulator_.record([this](Recorded entry) { keep(std::move(entry)); }, checkpoint_period_);
  } else {
    simulator_.record(nullptr);
  }
}

void CommandPublisher::keep(Recorded entry) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    entries_.push_back(std::move(entry));
  }
  wake_.notify_one();
}

void CommandPublisher::loop() {
  for (;;) {
    std::vector<Recorded> entries;
    {
      std::unique_lock<std::mutex> lock(mutex_);
      wake_.wait(lock, [this] { return stop_ || !entries_.empty(); });
      if (stop_) return;
      entries = std::exchange(entries_, {});
    }
    for (const Recorded& entry : entries) publish(entry);
  }
}

void CommandPublisher::publish(const Recorded& entry) {
  rigid_body_sim::Command msg;
  msg.header.stamp = timeline_.stamp();
  msg.sequence = entry.sequence;
  msg.world = entry.world;
  msg.step = entry.step;
  msg.time = entry.time;
  fill(entry, msg);
  msg.hash = hexadecimal(entry.hash);
  publisher_.publish(msg);
}

}  // namespace rbs
