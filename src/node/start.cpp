// SPDX-License-Identifier: BSD-3-Clause
#include "start.h"

#include <ros/ros.h>

#include <csignal>
#include <cstdio>
#include <vector>

namespace rbs {

void initOnWallTime(int argc, char** argv, const std::string& name) {
  static char remapping[] = "/use_sim_time:=~never_use_sim_time";
  std::vector<char*> arguments(argv, argv + argc);
  arguments.push_back(remapping);
  int count = static_cast<int>(arguments.size());
  arguments.push_back(nullptr);
  ros::init(count, arguments.data(), name);
}

void endInGoodOrder() {
  for (const int signal : {SIGTERM, SIGHUP}) {
    const auto before = std::signal(signal, [](int) { ros::requestShutdown(); });
    if (before == SIG_IGN) std::signal(signal, SIG_IGN);  // as nohup requires
  }
}

std::optional<int> answerWithoutNode(int argc, char** argv, const std::string& program,
                                     const std::string& version, std::string (*help)()) {
  std::vector<std::string> arguments;
  ros::removeROSArgs(argc, argv, arguments);
  if (arguments.size() <= 1) return {};
  const bool is_alone = arguments.size() == 2;
  if (is_alone && arguments[1] == "--version") {
    std::printf("rigid_body_sim %s\n", version.c_str());
    return 0;
  }
  if (is_alone && (arguments[1] == "--help" || arguments[1] == "-h")) {
    std::fputs(help().c_str(), stdout);
    return 0;
  }
  const std::string& wrong =
      arguments[1] == "--help" || arguments[1] == "--version" ? arguments[2] : arguments[1];
  std::fprintf(stderr, "%s: unknown argument '%.80s'; allowed: --help, --version, _PARAMETER:=VALUE\n",
               program.c_str(), wrong.c_str());
  return 2;
}

}  // namespace rbs
