// SPDX-License-Identifier: BSD-3-Clause
// The replay of a recording as a ROS node: it stands in for the simulator that was recorded, under its name.
#include "player.h"
#include "recording.h"
#include "replay_services.h"
#include "viewer_selection.h"

#include "parameters.h"
#include "start.h"

#include "rigid_body_sim/types.h"

#include <ros/ros.h>

#include <cstdio>
#include <optional>
#include <string>

namespace {

struct Options {
  std::string bag, simulator;
  rbs::Player::Options player;
};

Options readOptions(rbs::Parameters& parameters) {
  constexpr double kFastest = 1e6;
  Options options;
  options.bag = parameters.text("bag", "", "the recording, a bag of record.launch");
  options.simulator = parameters.text("simulator", "",
                                      "full name of the simulator to replay; empty: the only one in the bag");
  options.player.paused = parameters.flag("paused", false, "start paused");
  options.player.speed = parameters.number("speed", 1.0, 0.0, kFastest,
                                           "time of the recording over wall time; 0 is as fast as possible");
  options.player.clock = parameters.flag("publish_clock", true, "publish /clock");
  return options;
}

/// Throws InvalidInput for parameters that are not allowed.
Options givenOptions() {
  XmlRpc::XmlRpcValue given;
  ros::param::get(ros::this_node::getName(), given);
  rbs::Parameters parameters(given);
  const Options options = readOptions(parameters);
  for (const std::string& sentence : parameters.unknown()) ROS_WARN("%s", sentence.c_str());
  parameters.check();
  if (options.bag.empty())
    throw rbs::InvalidInput({{"bag", "", "the path of a recording, such as bag:=/home/me/sim.bag"}});
  return options;
}

/// Throws InvalidInput where the name is taken.
void checkNobodyRuns(const std::string& simulator) {
  if (ros::service::exists(simulator + "/pause", false))
    throw rbs::InvalidInput({{"bag", simulator, "the name of a simulator that does not run: end it first"}});
}

std::string help() {
  rbs::Parameters parameters;
  readOptions(parameters);
  return "Replays a recording in place of its simulator. Usage: replay_node [--help] [--version] "
         "[_PARAMETER:=VALUE ...]\nParameters and their defaults:\n" +
         parameters.list();
}

void run() {
  const ros::NodeHandle node;  // so that Ctrl-C ends the reading of a long bag
  const Options options = givenOptions();
  const rbs::Recording recording(options.bag, options.simulator);
  checkNobodyRuns(recording.simulator());
  rbs::Player player(recording, options.player);
  const rbs::ReplayServices services(player, recording.simulator());
  const rbs::ViewerSelection selection(player, recording.simulator());
  ROS_INFO("replaying %s from %s: %.1f s, %zu messages", recording.simulator().c_str(), options.bag.c_str(),
           1e-9 * static_cast<double>(recording.length()), recording.entries().size());
  constexpr int kThreads = 2;
  ros::AsyncSpinner spinner(kThreads);
  spinner.start();
  ros::waitForShutdown();
}

}  // namespace

int main(int argc, char** argv) {
  if (const std::optional<int> code = rbs::answerWithoutNode(argc, argv, "replay_node", RBS_VERSION, help))
    return *code;
  rbs::initOnWallTime(argc, argv, "replay");
  rbs::endInGoodOrder();
  try {
    run();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "replay_node: %s\n", error.what());
    return 1;
  }
  return 0;
}
