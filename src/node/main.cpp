// SPDX-License-Identifier: BSD-3-Clause
// The simulator as a ROS node: a session, its services and commands, and what it publishes.
#include "command_publisher.h"
#include "command_topics.h"
#include "names.h"
#include "parameters.h"
#include "publishers.h"
#include "resume.h"
#include "services.h"
#include "session.h"
#include "start.h"
#include "tf_frames.h"

#include "rigid_body_sim/file_access.h"
#include "rigid_body_sim/mesh_file.h"
#include "rigid_body_sim/quote.h"

#include <ros/package.h>
#include <ros/ros.h>
#include <boost/filesystem.hpp>

#include <algorithm>
#include <cstdio>
#include <limits>
#include <optional>
#include <thread>

namespace {

struct Options {
  rbs::Session::Options session;
  rbs::Publishers::Options publishers;
  std::string world_frame;
  std::string file_root;  ///< files are read and written below it alone; empty: anywhere
  bool resume = false;
  std::string state_file;           ///< of resume; empty: nowhere
  double checkpoint_period = 10.0;  ///< of ~commands, s of simulated time
};

// One core is left to RViz. More than four threads have little to share.
unsigned usualThreads() {
  return std::clamp(std::thread::hardware_concurrency(), 2u, 5u) - 1u;
}

Options readOptions(rbs::Parameters& parameters, const std::string& scenes) {
  Options options;
  rbs::Session::Options& session = options.session;
  session.scene =
      parameters.text("scene", session.scene, "a scene of the catalogue, or a path to a .yaml file");
  session.folder = parameters.text("scenes", scenes, "folder of the catalogue");
  session.run.paused = parameters.flag("paused", false, "start paused");
  const int seed =
      parameters.integer("seed", -1, -1, std::numeric_limits<int>::max(),
                         "seed of the gusts and of randomly placed bodies; -1: that of the scene");
  if (seed >= 0) session.seed = static_cast<std::uint64_t>(seed);
  const std::string fidelity =
      parameters.choice("fidelity", "", {"", "preview", "interactive", "accurate", "reference"},
                        "quality level of the solver; empty: that of the scene");
  if (!fidelity.empty()) session.fidelity = rbs::fidelityNamed(fidelity);
  constexpr double kFastest = 1e6;
  session.run.speed = parameters.number("speed", session.run.speed, 0.0, kFastest,
                                        "requested real-time factor; 0 is as fast as possible");
  const int threads = parameters.integer("threads", 0, 0, 256,
                                         "threads that a step may use; 0: all cores but one, at most 4");
  session.run.threads = threads > 0 ? static_cast<unsigned>(threads) : usualThreads();
  options.publishers.clock =
      parameters.flag("publish_clock", true, "publish /clock; otherwise messages are stamped with wall time");
  session.wall_stamps = !options.publishers.clock;
  options.publishers.tf = parameters.choice("tf", "all", {"all", "none"}, "transforms to publish") == "all"
                              ? rbs::TfMode::All
                              : rbs::TfMode::None;
  options.world_frame = parameters.text("world_frame", rbs::kWorldName,
                                        "name of the world's frame, the parent of every body's frame");
  options.publishers.tf_prefix = parameters.text("tf_prefix", "", "prefix of the name of every body's frame");
  options.publishers.contacts_rate =
      parameters.number("contacts_rate", options.publishers.contacts_rate, 0.0, 1e6,
                        "most messages of ~contacts a second; 0: one with every ~body_states");
  parameters.number("diagnostic_period", 1.0, 0.01, 1e6,
                    "period of /diagnostics, s; may be changed while the node runs");
  options.publishers.repeat_period =
      parameters.number("repeat_period", options.publishers.repeat_period, 0.0, 1e6,
                        "period after which descriptions and markers are sent again, s; 0: never");
  options.checkpoint_period =
      parameters.number("checkpoint_period", options.checkpoint_period, 0.1, 1e6,
                        "simulated time from one checkpoint on ~commands to the next, s");
  options.publishers.status_line = parameters.flag("status_line", false, "print one line of status a second");
  options.file_root = parameters.text(
      "file_root", "", "folder that scenes, states and meshes are read and written in; empty: anywhere");
  options.resume =
      parameters.flag("resume", false, "go on from the state that was kept when the node last ended");
  options.state_file =
      parameters.text("state_file", "",
                      "file of the saved state, an absolute path; empty: by node name in $ROS_HOME; "
                      "none: nowhere");
  if (options.state_file == "none") {
    options.state_file.clear();
  } else if (options.state_file.empty()) {
    options.state_file = rbs::Resume::usualFile(ros::this_node::getName());
  } else if (options.state_file[0] != '/') {
    parameters.refuse("state_file", options.state_file, "an absolute path, or none");
  } else if (boost::system::error_code error; boost::filesystem::is_directory(options.state_file, error)) {
    parameters.refuse("state_file", options.state_file, "a file: this is a folder");
  }
  return options;
}

/// What was given on the parameter server, with a warning for each name that means nothing to this node. Throws InvalidInput for
/// values that are not allowed.
Options givenOptions(const ros::NodeHandle& node) {
  XmlRpc::XmlRpcValue given;
  ros::param::get(node.getNamespace(), given);
  rbs::Parameters parameters(given);
  const Options options = readOptions(parameters, ros::package::getPath("rigid_body_sim") + "/scenes");
  for (const std::string& sentence : parameters.unknown())
    ROS_WARN_NAMED("parameters", "%s", sentence.c_str());
  parameters.check();
  return options;
}

std::string help() {
  rbs::Parameters parameters;
  readOptions(parameters, "that of the package");
  return "The node of rigid_body_sim. Usage: simulator_node [--help] [--version] [_PARAMETER:=VALUE ...]\n"
         "Parameters and their defaults:\n" +
         parameters.list();
}

void run() {
  ros::NodeHandle node("~");
  const Options options = givenOptions(node);
  rbs::nameFrames(options.world_frame, options.publishers.tf_prefix);
  rbs::confineFilesTo(options.file_root);
  rbs::TfFrames frames(node);
  rbs::findFramesBy([&](const std::string& frame_id) { return frames.find(frame_id); });
  rbs::Session session(options.session);
  rbs::Resume resume(session, options.state_file, options.resume);
  rbs::ReferenceRun reference_run(node, session.simulator());
  rbs::Publishers publishers(session.simulator(), session.timeline(), reference_run, options.publishers);
  rbs::Services services(session, reference_run);
  rbs::CommandTopics commands(session.simulator());
  rbs::CommandPublisher recording(node, session.simulator(), session.timeline(), options.checkpoint_period);
  constexpr int kThreads = 4;  // so that a client that waits for a load holds up no other client
  ros::AsyncSpinner spinner(kThreads);
  spinner.start();
  ros::waitForShutdown();
  resume.keep();
}

}  // namespace

int main(int argc, char** argv) {
  if (const std::optional<int> code = rbs::answerWithoutNode(argc, argv, "simulator_node", RBS_VERSION, help))
    return *code;
  rbs::initOnWallTime(argc, argv, "sim");
  rbs::endInGoodOrder();
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
