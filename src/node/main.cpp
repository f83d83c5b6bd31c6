// SPDX-License-Identifier: BSD-3-Clause
// The simulator as a ROS node: a session, its services and commands, and what it publishes.
#include "command_topics.h"
#include "names.h"
#include "publishers.h"
#include "services.h"
#include "session.h"
#include "tf_frames.h"

#include "rigid_body_sim/file_access.h"
#include "rigid_body_sim/mesh_file.h"
#include "rigid_body_sim/quote.h"

#include <ros/package.h>
#include <ros/ros.h>

#include <cstdio>
#include <memory>
#include <vector>

namespace {

/// Starts the node on wall time, whatever the rest of the graph lives on: the interactive markers need a
/// clock that goes on while the simulation is paused, and this node is the source of the other one.
void initOnWallTime(int argc, char** argv) {
  static char remapping[] = "/use_sim_time:=~never_use_sim_time";
  std::vector<char*> arguments(argv, argv + argc);
  arguments.push_back(remapping);
  int count = static_cast<int>(arguments.size());
  arguments.push_back(nullptr);
  ros::init(count, arguments.data(), "sim");
}

rbs::Session::Options sessionOptions(const ros::NodeHandle& node) {
  rbs::Session::Options options;
  options.folder = node.param("scenes", ros::package::getPath("rigid_body_sim") + "/scenes");
  options.scene = node.param("scene", options.scene);
  const int seed = node.param("seed", -1);
  if (seed >= 0) options.seed = static_cast<std::uint64_t>(seed);
  const std::string fidelity = node.param<std::string>("fidelity", "");
  if (!fidelity.empty()) options.fidelity = rbs::fidelityNamed(fidelity);
  options.wall_stamps = !node.param("publish_clock", true);
  options.run.paused = node.param("paused", options.run.paused);
  options.run.speed = node.param("speed", options.run.speed);
  return options;
}

rbs::Publishers::Options publisherOptions(const ros::NodeHandle& node) {
  rbs::Publishers::Options options;
  options.clock = node.param("publish_clock", options.clock);
  options.status_line = node.param("status_line", options.status_line);
  options.tf_prefix = node.param("tf_prefix", options.tf_prefix);
  const std::string tf = node.param<std::string>("tf", "all");
  if (tf != "all" && tf != "none") throw rbs::InvalidInput({{"~tf", rbs::quoted(tf), "all or none"}});
  options.tf = tf == "all" ? rbs::TfMode::All : rbs::TfMode::None;
  return options;
}

void run() {
  ros::NodeHandle node("~");
  rbs::nameFrames(node.param<std::string>("world_frame", rbs::kWorldName), node.param<std::string>("tf_prefix", ""));
  rbs::confineFilesTo(node.param<std::string>("file_root", ""));
  rbs::TfFrames frames(node);
  rbs::findFramesBy([&](const std::string& frame_id) { return frames.find(frame_id); });
  rbs::Session session(sessionOptions(node));
  rbs::Ghost ghost(node, session.simulator());
  rbs::Publishers publishers(session.simulator(), session.timeline(), ghost, publisherOptions(node));
  rbs::Services services(session, ghost);
  rbs::CommandTopics commands(session.simulator());
  constexpr int kThreads = 4;  // so that one client's long step() holds up no other client
  ros::AsyncSpinner spinner(kThreads);
  spinner.start();
  ros::waitForShutdown();
}

}  // namespace

int main(int argc, char** argv) {
  initOnWallTime(argc, argv);
  rbs::findPackagesBy(ros::package::getPath);
  rbs::interruptReadingBy([] { return ros::isShuttingDown() || !ros::ok(); });
  try {
    run();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "rigid_body_sim: %s\n", error.what());
    return 1;
  }
  return 0;
}
