// SPDX-License-Identifier: BSD-3-Clause
// ReplayServices: the services of the simulator that a replay stands in for. Those that steer its time do so here;
// all others refuse, and say why.
#pragma once

#include "player.h"

#include <ros/ros.h>

#include <string>
#include <vector>

namespace rbs {

class ReplayServices {
 public:
  /// Offers them under the name of the simulator.
  ReplayServices(Player& player, const std::string& simulator);

 private:
  template <class Service, class Handler>
  void offer(const std::string& name, Handler handler);
  template <class Service>
  void refuse(const std::string& name);
  void offerTime();
  void refuseEdits();

  Player& player_;
  ros::NodeHandle node_;
  std::vector<ros::ServiceServer> servers_;
};

}  // namespace rbs
