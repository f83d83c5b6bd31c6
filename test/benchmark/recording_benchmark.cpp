// SPDX-License-Identifier: BSD-3-Clause
// What recording costs: the size of a checkpoint, its time on the simulator's thread and as text, and the time of a
// command and of a step with and without a recorder. Times are the fastest of several.
#include "rigid_body_sim/recording.h"
#include "rigid_body_sim/scenes.h"
#include "simulator/recorder.h"

#include "make_scene.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <limits>
#include <string>

namespace {

using namespace rbs;

/// Fastest of so many runs, ms.
template <class Run>
double msOf(int runs, const Run& run) {
  using Clock = std::chrono::steady_clock;
  double fastest = std::numeric_limits<double>::infinity();
  for (int k = 0; k < runs; ++k) {
    const auto start = Clock::now();
    run();
    fastest = std::min(fastest, std::chrono::duration<double, std::milli>(Clock::now() - start).count());
  }
  return fastest;
}

/// A block of balls that falls on a floor.
SceneDef fallingBalls(int side, int layers) {
  SceneDef scene = test::onFloor(1.0 / 60.0, 0.5);
  scene.name = std::to_string(side * side * layers) + " balls in a heap";
  for (int k = 0; k < side * side * layers; ++k)
    scene.bodies.push_back(test::ball(
        "ball_" + std::to_string(k), 0.1,
        {0.21 * (k % side) + 0.01 * (k % 7), 0.21 * (k / side % side), 0.1 + 0.21 * (k / (side * side))}));
  return scene;
}

void measure(const SceneDef& scene) {
  World world(scene);
  for (int k = 0; k < 120; ++k) world.step();
  Recorder recorder;
  Recorded checkpoint;
  std::string text;
  const auto begin = [&] {
    recorder.begin([&](Recorded entry) { checkpoint = std::move(entry); }, 1e9, world, 0);
  };
  const double begin_ms = msOf(5, begin);
  const auto& file = std::get<Recorded::Checkpoint>(checkpoint.what);
  const double text_ms = msOf(3, [&] { text = writeScene(file->scene, file->state); });
  const BodyId body = world.find((*world.bodies()).back().name);
  const auto edit = [&] { world.grab(body, Grab{}); };
  edit();
  const double recorded_ms = msOf(20, [&] { edit(), recorder.flush(world); });
  recorder.begin(nullptr, 1.0, world, 0);
  const double edit_ms = msOf(20, edit);
  world.releaseAll();
  World other(world);
  const double plain = msOf(30, [&] { world.step(), recorder.stepped(world); });
  recorder.begin([](Recorded) {}, 1e9, other, 0);
  const double recorded = msOf(30, [&] { other.step(), recorder.stepped(other); });
  std::printf("%-28s %9.1f kB %9.3f ms %9.1f ms %11.4f ms %11.6f ms %9.3f ms %9.3f ms\n", scene.name.c_str(),
              text.size() / 1e3, begin_ms, text_ms, recorded_ms, edit_ms, plain, recorded);
}

}  // namespace

int main() {
  std::printf("%-28s %12s %12s %12s %14s %14s %12s %12s\n", "scene", "checkpoint", "its time", "its text",
              "recorded grab", "plain grab", "plain step", "recorded");
  for (const char* name : {"playground", "balls_666", "sphere_rain", "mixed_rain"})
    measure(readScene(std::string(RBS_SCENES "/") + name + ".yaml").scene);
  measure(fallingBalls(25, 8));
  return 0;
}
