// SPDX-License-Identifier: BSD-3-Clause
// Passes that threads share by regions of bodies: each pair comes once, after all pairs before it that move its bodies.
#include "solver/pass_regions.h"

#include "make_scene.h"
#include "solver_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <numeric>
#include <random>
#include <stdexcept>
#include <vector>

namespace rbs::test {
namespace {

constexpr double kStep = 1.0 / 60.0;

// Balls on the nodes of a grid, each of which overlaps those beside it; the pairs in a random order.
class Grid {
 public:
  Grid(std::array<int, 3> size, unsigned seed) {
    SceneStore& store = scene_.store;
    store.settings.step = kStep;
    std::vector<std::array<int, 3>> nodes;
    for (int x = 0; x < size[0]; ++x)
      for (int y = 0; y < size[1]; ++y)
        for (int z = 0; z < size[2]; ++z) nodes.push_back({x, y, z});
    for (const auto& [x, y, z] : nodes) {
      BodyDef def = ball("ball_" + std::to_string(store.bodies.size()), 0.51, Vec3(x, y, z));
      if (z == 0) def.kind = BodyKind::Static;
      store.bodies.append({store.bodies.size() + 1}, def);
    }
    scene_.begin(kStep);
    std::vector<std::array<Index, 2>> pairs;
    for (Index i = 0; i < nodes.size(); ++i)
      for (Index j = i + 1; j < nodes.size(); ++j) {
        int steps = 0;
        for (int c = 0; c < 3; ++c) steps += std::abs(nodes[i][c] - nodes[j][c]);
        if (steps == 1 && nodes[j][2] > 0) pairs.push_back({i, j});
      }
    std::shuffle(pairs.begin(), pairs.end(), std::mt19937(seed));
    for (const auto& [i, j] : pairs) scene_.touch(i, j);
    contacts.find(0.0, kStep, kStep);
  }

 private:
  SolverScene scene_;
  SolverContacts::Stores stores_;

 public:
  SolverContacts contacts{scene_.context, scene_.batch, stores_};
};

// A pair to a bundle: the pairs of each region by level, and which pairs have to be done before.
struct Schedule {
  std::vector<std::vector<std::size_t>> before;  // by block
  std::vector<Index> level;                      // by block
  std::vector<std::size_t> blocks;               // by bundle
  PassRegions regions;

  Schedule(const SolverContacts& contacts, unsigned threads) {
    std::vector<std::vector<std::size_t>> of_body(contacts.bodies.size());
    for (std::size_t k = 0; k < contacts.blocks.size(); ++k) {
      std::vector<std::size_t>& mine = before.emplace_back();
      Index& own = level.emplace_back(0);
      for (const Index body : {contacts.blocks[k].i, contacts.blocks[k].j}) {
        if (contacts.bodies[body].inv_mass == 0.0) continue;
        mine.insert(mine.end(), of_body[body].begin(), of_body[body].end());
        of_body[body].push_back(k);
      }
      for (const std::size_t one : mine) own = std::max(own, level[one] + 1);
    }
    regions.split(contacts, level, threads);
    blocks.resize(contacts.blocks.size());
    std::iota(blocks.begin(), blocks.end(), 0u);
    const auto region = [&](std::size_t k) { return regions.of(contacts, contacts.blocks[k]); };
    std::stable_sort(blocks.begin(), blocks.end(), [&](std::size_t a, std::size_t b) {
      return std::make_pair(region(a), level[a]) < std::make_pair(region(b), level[b]);
    });
    if (regions.count() == 1) return;
    std::vector<std::size_t> first(regions.count() + 1, 0), bundle(blocks.size());
    for (std::size_t b = 0; b < blocks.size(); ++b) bundle[blocks[b]] = b, ++first[region(blocks[b]) + 1];
    std::partial_sum(first.begin(), first.end(), first.begin());
    regions.setBundles(first);
    for (std::size_t b = 0; b < blocks.size(); ++b)
      for (const std::size_t one : before[blocks[b]]) regions.need(b, bundle[one]);
    regions.finish();
  }
};

class RegionsOf : public testing::TestWithParam<std::array<int, 3>> {};
INSTANTIATE_TEST_SUITE_P(Grids, RegionsOf,
                         testing::Values(std::array<int, 3>{120, 6, 3}, std::array<int, 3>{5, 130, 4},
                                         std::array<int, 3>{6, 6, 60}, std::array<int, 3>{14, 14, 14}));

TEST_P(RegionsOf, TakeEveryPairOnceAndAfterThoseThatItNeeds) {
  Grid grid(GetParam(), 7);
  for (const unsigned threads : {2u, 3u, 4u}) {
    Schedule schedule(grid.contacts, threads);
    ASSERT_EQ(schedule.regions.count(), threads);
    std::vector<int> of_body(grid.contacts.bodies.size(), 0);
    for (std::size_t r = 0; r < threads; ++r)
      for (const Index s : schedule.regions.bodies(r)) ++of_body[s];
    EXPECT_EQ(of_body, std::vector<int>(of_body.size(), 1));

    Workers workers;
    workers.setCount(threads);
    const std::size_t blocks = schedule.blocks.size();
    for (int pass = 0; pass < 30; ++pass) {
      std::vector<std::atomic<int>> done(blocks);
      std::atomic<int> early{0};
      schedule.regions.inOrder(workers, [&](std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b) {
          const std::size_t block = schedule.blocks[b];
          for (const std::size_t one : schedule.before[block]) early += done[one] == 0;
          ++done[block];
        }
      });
      ASSERT_EQ(early, 0) << threads << " threads, pass " << pass;
      for (const std::atomic<int>& times : done) ASSERT_EQ(times, 1);

      std::vector<std::atomic<int>> called(threads);
      schedule.regions.each(workers, [&](std::size_t region) { ++called[region]; });
      for (const std::atomic<int>& times : called) ASSERT_EQ(times, 1);
    }
  }
}

TEST_P(RegionsOf, EndAtAnExceptionAndGoOnInTheNextPass) {
  Grid grid(GetParam(), 8);
  Schedule schedule(grid.contacts, 3);
  Workers workers;
  workers.setCount(3);
  for (std::size_t bad = 0; bad < schedule.blocks.size(); bad += schedule.blocks.size() / 5) {
    EXPECT_THROW(schedule.regions.inOrder(workers,
                                          [&](std::size_t begin, std::size_t end) {
                                            if (begin <= bad && bad < end) throw std::runtime_error("bad");
                                          }),
                 std::runtime_error);
    std::atomic<std::size_t> done{0};
    schedule.regions.inOrder(workers, [&](std::size_t begin, std::size_t end) { done += end - begin; });
    EXPECT_EQ(done, schedule.blocks.size());
  }
}

TEST(Regions, AreOneWhereThereIsLittleToShare) {
  for (const std::array<int, 3> size : {std::array<int, 3>{10, 10, 2}, std::array<int, 3>{2, 2, 60}}) {
    Grid grid(size, 9);
    EXPECT_EQ(Schedule(grid.contacts, 4).regions.count(), 1u);
  }
  Grid grid({120, 6, 3}, 9);
  EXPECT_EQ(Schedule(grid.contacts, 1).regions.count(), 1u);
}

}  // namespace
}  // namespace rbs::test
