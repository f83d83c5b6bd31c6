// SPDX-License-Identifier: BSD-3-Clause
#include "command_topics.h"

#include "convert.h"
#include "names.h"

#include "rigid_body_sim/quote.h"

namespace rbs {

namespace {

// A vector of a command, in the axes of the body, and what World calls it.
struct Sent {
  std::string path, in_world;
  Vec3 value_B;
};

// Makes an edit. An error names the field of the message, the body, and the value that the message holds.
void edit(const std::string& body, const std::vector<Sent>& sent, const std::function<void()>& make) {
  const auto place = [&](const Sent& one) { return one.path + " for " + rbs::quoted(body); };
  for (const Sent& one : sent) finiteVector(one.value_B, place(one));
  try {
    make();
  } catch (const InvalidInput& refusal) {
    std::vector<Problem> problems = refusal.problems();
    for (Problem& problem : problems)
      for (const Sent& one : sent)
        if (problem.path == one.in_world) {
          problem.path = place(one);
          problem.value = words('[', one.value_B.x(), ", ", one.value_B.y(), ", ", one.value_B.z(), ']');
        }
    throw InvalidInput(problems);
  }
}

}  // namespace

CommandTopics::CommandTopics(Simulator& simulator) : simulator_(simulator) {
  ros::NodeHandle node("~");
  twist_ = node.subscribe("cmd_twist", 100, &CommandTopics::onTwist, this);
  wrench_ = node.subscribe("cmd_wrench", 100, &CommandTopics::onWrench, this);
}

void CommandTopics::onTwist(const geometry_msgs::TwistStamped& command) {
  send("cmd_twist", [command](World& world) {
    const BodyId body = bodyOfFrame(world, command.header.frame_id, "header.frame_id");
    const Quat q_WB = world.pose(body).q_WB;
    const Twist twist_B = fromMsg(command.twist);
    BodyEdit change;
    change.twist = Twist{q_WB * twist_B.v_WB, q_WB * twist_B.w_WB};
    edit(command.header.frame_id,
         {{"twist.linear", "body.velocity", twist_B.v_WB}, {"twist.angular", "body.spin", twist_B.w_WB}},
         [&] { world.editBody(body, change); });
  });
}

void CommandTopics::onWrench(const geometry_msgs::WrenchStamped& command) {
  send("cmd_wrench", [command](World& world) {
    const BodyId body = bodyOfFrame(world, command.header.frame_id, "header.frame_id");
    const Pose X_WB = world.pose(body);
    const Vec3 force_B = fromMsg(command.wrench.force), torque_B = fromMsg(command.wrench.torque);
    edit(command.header.frame_id, {{"wrench.force", "force", force_B}, {"wrench.torque", "torque", torque_B}},
         [&] {
           world.commandWrench(body, X_WB.q_WB * force_B, X_WB.q_WB * torque_B, X_WB.p_WB, kWrenchSeconds);
         });
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
