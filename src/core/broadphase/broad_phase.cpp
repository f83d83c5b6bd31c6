// SPDX-License-Identifier: BSD-3-Clause
#include "broadphase/broad_phase.h"

#include "base/text.h"
#include "broadphase/bounds.h"
#include "broadphase/bounds_tree.h"
#include "broadphase/sweep_and_prune.h"

#include <algorithm>
#include <numeric>

namespace rbs::broad_phase {

namespace {

// An axis other than d is taken for less than half of the tests: d is at home in scenes built along x, y and
// z.
constexpr int kDiagonal = 3;
constexpr const char* kAxisNames[] = {"x", "y", "z", "(1, 1, 1)"};
// A sweep with fewer tests a body than the first is not worth improving. The tree takes about as long as one with
// the second.
constexpr std::uint64_t kFewTests = 16, kTestsOfTree = 32;
// Bodies of which a thread takes the bounds at a time.
constexpr std::size_t kBodiesOfAPart = 256;

// Chosen anew when an eighth of the bodies are others, and when the bodies have moved so that the search takes twice
// the tests.
void choose(PairSearch& search, const std::vector<Bounds>& bounds) {
  const std::uint64_t n = search.order.size();
  search.axis = kDiagonal;
  search.sweep_tests = sweepTests(kDiagonal, search.order, bounds);
  search.fresh = false;
  search.changed = 0;
  if (search.sweep_tests > kFewTests * n) {
    for (const int axis : {0, 1, 2}) {
      const std::uint64_t tests = sweepTests(axis, search.order, bounds);
      if (tests < (search.axis == kDiagonal ? search.sweep_tests / 2 : search.sweep_tests))
        search.axis = axis, search.sweep_tests = tests;
    }
  }
  search.by_tree = search.sweep_tests > kTestsOfTree * n;
  if (search.by_tree) sortByPlace(search.order, bounds);
}

std::uint64_t findPairs(Context& context, IndexPairs& found) {
  PairSearch& search = context.scene.pair_search;
  const std::vector<Bounds>& bounds = context.step.bounds;
  const std::vector<Traits>& traits = context.scene.bodies.traits;
  Workers& workers = *context.step.workers;
  if (search.by_tree) return BoundsTree(search.order, bounds).findPairs(traits, workers, found);
  sortByLowerEnd(search.axis, search.order, bounds);
  return sweepAlong(search.axis, search.order, bounds, traits, workers, found);
}

// A plane has no bounds: its distance to a body's bounds is taken instead. Point x of the bounds is at s =
// n.(x - p) above a plane through p with the unit normal n. Where the plane moves with (v, w), s falls no
// faster than
//   -ds/dt = n.v - (w x n).(x - p) <= |v| + |w| |x - p|,
// and no faster than n.v where it does not turn.
void sweepPlanes(const Context& context, IndexPairs& found) {
  const Bodies& bodies = context.scene.bodies;
  const double h = context.step.h();
  for (const Index plane : context.scene.lists.planes) {
    const Vec3 n = bodies.pose[plane].q_WB * Vec3::UnitZ(), p = bodies.pose[plane].p_WB;
    const Twist twist = bodies.traits[plane].is_kinematic() ? bodies.twist[plane] : Twist();
    const double turn = h * twist.w_WB.norm(), path = h * twist.v_WB.norm();
    const double rise = turn > 0.0 ? path : std::max(h * n.dot(twist.v_WB), 0.0);
    const double offset = n.dot(p) + rise;
    for (const Index b : context.scene.lists.collidable) {
      const Vec3 lo = context.step.bounds[b].lo.head<3>(), hi = context.step.bounds[b].hi.head<3>();
      double lowest = 0.5 * (n.dot(lo + hi) - n.cwiseAbs().dot(hi - lo));
      if (turn > 0.0) lowest -= turn * ((0.5 * (lo + hi) - p).norm() + 0.5 * (hi - lo).norm() + path);
      if (lowest <= offset && mayCollide(bodies.traits[plane], bodies.traits[b]))
        found.push_back(std::minmax(plane, b));
    }
  }
}

// By the first body, then by the second: a list for each first body, in their order, sorts most of it.
void sortPairs(std::size_t bodies, IndexPairs& pairs) {
  std::vector<std::size_t> first(bodies + 1, 0);
  for (const auto& [i, j] : pairs) ++first[i + 1];
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<std::size_t> next(first.begin(), first.end() - 1);
  IndexPairs sorted(pairs.size());
  for (const auto& pair : pairs) sorted[next[pair.first]++] = pair;
  const auto at = [&](std::size_t k) { return sorted.begin() + static_cast<std::ptrdiff_t>(k); };
  for (std::size_t i = 0; i < bodies; ++i)
    if (first[i + 1] - first[i] > 1) std::sort(at(first[i]), at(first[i + 1]));
  pairs = std::move(sorted);
}

}  // namespace

void findPairs(Context& context) {
  SceneStore& scene = context.scene;
  StepStore& step = context.step;
  const std::vector<Index>& collidable = scene.lists.collidable;

  step.workers->share(collidable.size(), kBodiesOfAPart, [&](auto, auto begin, auto end) {
    for (std::size_t k = begin; k < end; ++k) {
      const Index i = collidable[k];
      step.bounds[i] = sweptBounds(scene.bodies, step.load[i], i, step.h());
    }
  });
  PairSearch& search = scene.pair_search;
  const bool chosen = search.fresh || 8 * search.changed > collidable.size();
  if (chosen) choose(search, step.bounds);
  IndexPairs found;
  const std::uint64_t tests = findPairs(context, found);
  if (chosen) search.tests = tests;
  search.fresh = tests > 2 * search.tests + kFewTests * collidable.size();
  step.report.overlap_tests = tests;

  sweepPlanes(context, found);
  sortPairs(scene.bodies.size(), found);
  scene.contacts.update(scene.bodies, found, [&](const Contact& contact) { return scene.isAsleep(contact); });
  step.report.pairs = static_cast<std::uint32_t>(found.size());
}

std::string describe(const SceneStore& scene) {
  const PairSearch& search = scene.pair_search;
  if (search.order.empty() || search.fresh) return "";
  const std::uint64_t tests = search.sweep_tests / search.order.size();
  const std::string sweep = std::string("a sweep along ") + kAxisNames[search.axis];
  return search.by_tree
             ? "by a tree of bounds: " + sweep + " would take " + count(tests, "test", "tests") + " a body"
             : "by " + sweep + ": " + count(tests, "test", "tests") + " a body";
}

}  // namespace rbs::broad_phase
