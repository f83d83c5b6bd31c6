// SPDX-License-Identifier: BSD-3-Clause
// What a step of a world costs beside the bare arithmetic: 10,000 balls that collide with nothing, under
// gravity.
//
// The hand-written loop does the exact update over arrays of the same layout: poses and twists. The two take
// turns, each in a burst of steps; the ratio is of the least times, and of the medians.
#include "rigid_body_sim/world.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

namespace {

using namespace rbs;
using Clock = std::chrono::steady_clock;

constexpr int kBodies = 10000, kBurst = 50, kBursts = 200;

SceneDef balls(std::uint32_t mask) {
  SceneDef scene;
  for (int k = 0; k < kBodies; ++k) {
    BodyDef def;
    def.shape = Sphere{0.1};
    def.pose.p_WB = Vec3(k % 100, k / 100, 1000.0);
    def.twist.v_WB = Vec3(0.1, 0.2, 0.3);
    def.mask = mask;
    scene.bodies.push_back(def);
  }
  return scene;
}

struct Hand {
  std::vector<Pose> pose;
  std::vector<Twist> twist;
  // The loop that the world is measured against.
  void step(double h, const Vec3& g) {
    const Vec3 dv = h * g, half_dv = 0.5 * dv;
    for (std::size_t i = 0; i < pose.size(); ++i) {
      pose[i].p_WB += h * (twist[i].v_WB + half_dv);
      twist[i].v_WB += dv;
    }
  }
};

template <class Step>
double nanosecondsABody(Step step) {
  const auto start = Clock::now();
  for (int k = 0; k < kBurst; ++k) step();
  return 1e9 * std::chrono::duration<double>(Clock::now() - start).count() / (kBurst * double(kBodies));
}

double median(std::vector<double> times) {
  std::nth_element(times.begin(), times.begin() + times.size() / 2, times.end());
  return times[times.size() / 2];
}

}  // namespace

int main() {
  const SceneDef scene = balls(0);
  World world(scene), watched(scene), pictured(scene), meeting(balls(0xffffffffu));
  Hand hand;
  for (const BodyDef& def : scene.bodies) hand.pose.push_back(def.pose), hand.twist.push_back(def.twist);

  const std::vector<std::pair<const char*, std::function<void()>>> runs{
      {"the loop by hand", [&] { hand.step(scene.step, scene.gravity); }},
      {"World::step", [&] { world.step(); }},
      {"and totals (energy, momentum)", [&] { watched.step(), watched.totals(); }},
      {"and a snapshot", [&] { pictured.step(), pictured.snapshot(); }},
      {"with masks that let them meet", [&] { meeting.step(); }},
  };
  std::vector<std::vector<double>> times(runs.size());
  for (int burst = 0; burst < kBursts; ++burst)
    for (std::size_t k = 0; k < runs.size(); ++k)
      if (k < 2 || burst % 20 == 0) times[k].push_back(nanosecondsABody(runs[k].second));

  std::printf("%d balls, bursts of %d steps, compiled with %s\n", kBodies, kBurst, RBS_FLAGS);
  std::printf("  for (i) { p[i] += h * (v[i] + h g / 2); v[i] += h g; }\n\n");
  std::printf(
      "| run | least, ns a body and step | median | least against the loop | median against the loop "
      "|\n|---|--:|--:|--:|--:|\n");
  for (std::size_t k = 0; k < runs.size(); ++k) {
    const double least = *std::min_element(times[k].begin(), times[k].end());
    const double first = *std::min_element(times[0].begin(), times[0].end());
    std::printf("| %s | %.2f | %.2f | %.2f | %.2f |\n", runs[k].first, least, median(times[k]), least / first,
                median(times[k]) / median(times[0]));
  }
  const Vec3 apart = world.snapshot().states.back().pose.p_WB - hand.pose.back().p_WB;
  std::printf("\nLargest difference of the two after %d steps: %g m\n", kBurst * kBursts, apart.norm());
}
