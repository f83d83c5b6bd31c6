// SPDX-License-Identifier: BSD-3-Clause
#include "command_topics.h"

#include "convert.h"
#include "names.h"

namespace rbs {

CommandTopics::CommandTopics(Simulator& simulator) : simulator_(simulator) {
  ros::NodeHandle node("~");
  twist_ = node.subscribe("cmd_twist", 100, &CommandTopics::onTwist, this);
  wrench_ = node.subscribe("cmd_wrench", 100, &CommandTopics::onWrench, this);
}

void CommandTopics::onTwist(const geometry_msgs::TwistStamped& command) {
  edit("cmd_twist", [&](World& world) {
    const std::string& name = command.header.frame_id;
    const Quat q_WB = frameNamed(world, name).q_WB;
    const Twist twist_B = fromMsg(command.twist);
    BodyEdit edit;
    edit.twist = Twist{q_WB * twist_B.v_WB, q_WB * twist_B.w_WB};
    world.editBody(bodyNamed(world, name), edit);
  });
}

void CommandTopics::onWrench(const geometry_msgs::WrenchStamped& command) {
  edit("cmd_wrench", [&](World& world) {
    const std::string& name = command.header.frame_id;
    const Pose X_WB = frameNamed(world, name);
    const Vec3 force_W = X_WB.q_WB * fromMsg(command.wrench.force);
    const Vec3 torque_W = X_WB.q_WB * fromMsg(command.wrench.torque);
    world.applyWrench(bodyNamed(world, name), force_W, torque_W, X_WB.p_WB, kWrenchSeconds);
  });
}

void CommandTopics::edit(const char* topic, const std::function<void(World&)>& command) {
  try {
    simulator_.edit(command);
  } catch (const InvalidInput& refusal) {
    ROS_WARN_STREAM_THROTTLE_NAMED(1.0, topic, "~" << topic << ": " << refusal.what());
  }
}

}  // namespace rbs
