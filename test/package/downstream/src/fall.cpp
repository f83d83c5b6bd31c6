// SPDX-License-Identifier: BSD-3-Clause
// Lets a ball fall for a second, by the core alone, and puts it into a message.
#include <rigid_body_sim/BodyState.h>
#include <rigid_body_sim/SpawnBody.h>
#include <rigid_body_sim/world.h>

#include <cstdio>

int main() {
  rbs::SceneDef scene;
  rbs::BodyDef ball;
  ball.name = "ball";
  ball.shape = rbs::Sphere{0.1};
  ball.pose.p_WB = {0.0, 0.0, 10.0};
  scene.bodies.push_back(ball);

  rbs::World world(scene);
  for (int k = 0; k < 60; ++k) world.step();

  rigid_body_sim::BodyState message;
  message.description.name = "ball";
  message.pose.position.z = world.snapshot().states.front().pose.p_WB.z();
  std::printf("%s at z = %.3f m\n", message.description.name.c_str(), message.pose.position.z);
}
