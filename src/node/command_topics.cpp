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
  send("cmd_twist", [command](World& world) {
    const BodyId body = bodyNamed(world, command.header.frame_id, "header.frame_id");
    const Quat q_WB = world.pose(body).q_WB;
    const Twist twist_B = fromMsg(command.twist);
    BodyEdit edit;
    edit.twist = Twist{q_WB * finiteVector(twist_B.v_WB, "twist.linear"),
                       q_WB * finiteVector(twist_B.w_WB, "twist.angular")};
    world.editBody(body, edit);
  });
}

void CommandTopics::onWrench(const geometry_msgs::WrenchStamped& command) {
  send("cmd_wrench", [command](World& world) {
    const BodyId body = bodyNamed(world, command.header.frame_id, "header.frame_id");
    const Pose X_WB = world.pose(body);
    const Vec3 force_W = X_WB.q_WB * finiteVector(fromMsg(command.wrench.force), "wrench.force");
    const Vec3 torque_W = X_WB.q_WB * finiteVector(fromMsg(command.wrench.torque), "wrench.torque");
    world.commandWrench(body, force_W, torque_W, X_WB.p_WB, kWrenchSeconds);
  });
}

// Nobody waits: a controller sends faster than a slow scene steps, and must hold up nobody else.
void CommandTopics::send(const char* topic, std::function<void(World&)> command) {
  simulator_.send([topic, command = std::move(command)](World& world) {
    try {
      command(world);
    } catch (const InvalidInput& refusal) {
      ROS_WARN_STREAM_THROTTLE_NAMED(1.0, topic, "~" << topic << ": " << refusal.what());
    }
  });
}

}  // namespace rbs
