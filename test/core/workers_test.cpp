// SPDX-License-Identifier: BSD-3-Clause
// Threads that share loops: every part is done once, trouble comes out, and a world does the same for any number
// of them.
#include "base/workers.h"

#include "make_scene.h"
#include "rigid_body_sim/scenes.h"

#include <gtest/gtest.h>

#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <numeric>
#include <random>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace rbs::test {
namespace {

TEST(Workers, DoEachElementOnce) {
  for (const unsigned threads : {1u, 2u, 5u}) {
    Workers workers;
    workers.setCount(threads);
    for (int loop = 0; loop < 2000; ++loop) {
      const std::size_t n = static_cast<std::size_t>(loop) % 97,
                        length = 1 + static_cast<std::size_t>(loop) % 7;
      std::vector<int> done(n, 0);
      workers.share(n, length, [&](std::size_t part, std::size_t begin, std::size_t end) {
        EXPECT_EQ(begin, part * length);
        for (std::size_t k = begin; k < end; ++k) ++done[k];
      });
      ASSERT_EQ(done, std::vector<int>(n, 1)) << threads << " threads, loop " << loop;
    }
  }
}

TEST(Workers, ThrowWhatTheFirstPartThrows) {
  Workers workers;
  workers.setCount(3);
  for (int loop = 0; loop < 200; ++loop) {
    std::string what;
    try {
      workers.share(64, 1, [](std::size_t part, std::size_t, std::size_t) {
        if (part % 10 == 7) throw std::runtime_error(std::to_string(part));
      });
    } catch (const std::runtime_error& error) {
      what = error.what();
    }
    ASSERT_EQ(what, "7");
  }
  std::atomic<int> done{0};
  workers.share(64, 1, [&](std::size_t, std::size_t, std::size_t) { ++done; });
  EXPECT_EQ(done, 64);
}

// The threads of the parent are not there after a fork, and may have been waiting, or not, when it came.
TEST(Workers, OfAForkedProcessAreItsOwn) {
  for (int k = 0; k < 20; ++k) {
    auto workers = std::make_unique<Workers>();
    workers->setCount(4);
    const auto sum = [&] {
      std::atomic<std::size_t> total{0};
      workers->share(64, 1, [&](std::size_t part, std::size_t, std::size_t) { total += part; });
      return total.load();
    };
    ASSERT_EQ(sum(), 2016u);
    if (k % 2 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(2));  // they sleep
    const pid_t child = fork();
    if (child == 0) {
      alarm(20);
      const bool is_right = k % 4 >= 2 || sum() == 2016u;  // or goes without a loop of its own
      workers.reset();
      _exit(is_right ? 0 : 1);
    }
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    ASSERT_EQ(status, 0) << k;
    ASSERT_EQ(sum(), 2016u);
  }
}

TEST(Workers, MayBeOtherInNumberBetweenLoops) {
  Workers workers;
  for (const unsigned threads : {2u, 0u, 4u, 1u, 3u}) {
    workers.setCount(threads);
    EXPECT_EQ(workers.count(), std::max(threads, 1u));
    std::atomic<int> done{0};
    workers.share(100, 3, [&](std::size_t, std::size_t begin, std::size_t end) {
      done += static_cast<int>(end - begin);
    });
    EXPECT_EQ(done, 100);
  }
}

class ThreadsOf : public testing::TestWithParam<std::tuple<const char*, Fidelity>> {};
INSTANTIATE_TEST_SUITE_P(Scenes, ThreadsOf,
                         testing::Combine(testing::Values("mixed_rain", "sphere_rain", "pyramid"),
                                          testing::Values(Fidelity::Preview, Fidelity::Interactive)));

// Hundreds of bodies, so that there is something to share.
TEST_P(ThreadsOf, DoNotChangeAWorld) {
  const auto [name, fidelity] = GetParam();
  SceneDef scene = readScene(findScene(RBS_SCENES, name)).scene;
  scene.fidelity = fidelity;
  World one(scene), many(scene);
  many.setThreads(3);
  for (int k = 0; k < 60; ++k) {
    one.step(), many.step();
    ASSERT_EQ(one.stateHash(), many.stateHash()) << "after step " << k + 1;
    ASSERT_EQ(one.snapshot().report.overlap_tests, many.snapshot().report.overlap_tests);
  }
}

// Enough pairs in one island that threads share the passes over them, along an axis that is not the first.
TEST(Threads, ShareThePassesOverAHeapAndDoNotChangeIt) {
  SceneDef scene = onFloor(1.0 / 60.0, 0.5);
  scene.fidelity = Fidelity::Interactive;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> jitter(-0.05, 0.05);
  for (int k = 0; k < 800; ++k) {
    const Vec3 p_W(0.5 * (k % 8) + jitter(random), 0.5 * (k / 8 % 25) + jitter(random),
                   0.24 + 0.48 * (k / 200));
    const std::string name = "piece_" + std::to_string(k);
    scene.bodies.push_back(k % 3 ? box(name, Vec3::Constant(0.48), p_W) : ball(name, 0.24, p_W));
    scene.bodies.back().twist.w_WB = Vec3(jitter(random), jitter(random), jitter(random));
    scene.bodies.back().material.friction = k % 5 ? 0.5 : 0.0;
  }
  World one(scene);
  std::vector<std::unique_ptr<World>> many;
  for (const unsigned threads : {2u, 3u, 7u}) {
    many.push_back(std::make_unique<World>(scene));
    many.back()->setThreads(threads);
  }
  for (int k = 0; k < 40; ++k) {
    one.step();
    for (const std::unique_ptr<World>& world : many) {
      world->step();
      ASSERT_EQ(one.stateHash(), world->stateHash()) << world->threads() << " threads, after step " << k + 1;
    }
  }
}

// Towers, which the exact step takes at every setting but preview; one leans and takes more work than the others.
TEST(Threads, ShareTheIslandsOfTheExactStepAndDoNotChangeThem) {
  for (const Fidelity fidelity : {Fidelity::Interactive, Fidelity::Accurate}) {
    SceneDef scene = onFloor(1.0 / 60.0, 0.5);
    scene.fidelity = fidelity;
    for (int k = 0; k < 60; ++k) {
      const int tower = k / 6;
      scene.bodies.push_back(box("block_" + std::to_string(k), {1.0, 1.0, 1.0},
                                 {3.0 * tower + (tower == 4 ? 0.09 * (k % 6) : 0.0), 0.0, 0.5 + k % 6}));
    }
    World one(scene), many(scene);
    many.setThreads(3);
    for (int k = 0; k < 40; ++k) {
      one.step(), many.step();
      ASSERT_EQ(one.stateHash(), many.stateHash()) << fidelityName(fidelity) << ", after step " << k + 1;
    }
  }
}

TEST(Threads, AreAsManyAsWereSet) {
  World world(onFloor(1.0 / 60.0, 0.5));
  EXPECT_EQ(world.threads(), 1u);
  world.setThreads(2);
  EXPECT_EQ(World(world).threads(), 1u);
  world.clear();
  EXPECT_EQ(world.threads(), 2u);
  for (const unsigned bad : {0u, 257u, ~0u}) EXPECT_THROW(world.setThreads(bad), InvalidInput);
  EXPECT_EQ(world.threads(), 2u);
}

}  // namespace
}  // namespace rbs::test
