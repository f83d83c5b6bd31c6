// SPDX-License-Identifier: BSD-3-Clause
#include "broadphase/sweep_and_prune.h"

#include "broadphase/bounds.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace rbs::sweep_and_prune {

namespace {

// An axis other than d is taken for less than half of the tests: d is at home in scenes built along x, y and
// z.
constexpr int kDiagonal = 3;
// A sweep with fewer tests a body than this is not worth improving.
constexpr std::uint64_t kFewTests = 16;
// Bodies of which a thread takes the bounds, or the tests, at a time.
constexpr std::size_t kBodiesOfAPart = 256;

// How many pairs of intervals overlap along an axis, which is what a sweep tests: all pairs but those where
// one ends before the other begins.
std::uint64_t testsAlong(int axis, const std::vector<Index>& order, const std::vector<Bounds>& bounds) {
  std::vector<double> begins, ends;
  for (const Index i : order) begins.push_back(bounds[i].lo[axis]), ends.push_back(bounds[i].hi[axis]);
  std::sort(begins.begin(), begins.end());
  std::sort(ends.begin(), ends.end());
  const std::uint64_t n = order.size();
  std::uint64_t tests = n * (n - 1) / 2, ended = 0;
  for (const double begin : begins) {
    while (ended < n && ends[ended] < begin) ++ended;
    tests -= ended;
  }
  return tests;
}

// Chosen anew when other bodies take part, and when the bodies have moved so that the sweep takes twice the
// tests.
void chooseAxis(Sweep& sweep, const std::vector<Bounds>& bounds) {
  sweep.axis = kDiagonal;
  sweep.tests = testsAlong(kDiagonal, sweep.order, bounds);
  sweep.fresh = false;
  const std::uint64_t few = kFewTests * sweep.order.size();
  if (sweep.tests <= few) return;
  for (const int axis : {0, 1, 2}) {
    const std::uint64_t tests = testsAlong(axis, sweep.order, bounds);
    if (tests < (sweep.axis == kDiagonal ? sweep.tests / 2 : sweep.tests))
      sweep.axis = axis, sweep.tests = tests;
  }
}

// Sorts the order of the last step by the lower ends of today's intervals. Bodies move little from step to
// step, so insertion sort needs about as many moves as bodies that overtook each other. Ties go by index, so
// that the result does not depend on the past.
void sortByLowerEnd(Sweep& sweep, const std::vector<Bounds>& bounds) {
  const int axis = sweep.axis;
  const auto before = [&](Index a, Index b) {
    return bounds[a].lo[axis] < bounds[b].lo[axis] || (bounds[a].lo[axis] == bounds[b].lo[axis] && a < b);
  };
  std::vector<Index>& order = sweep.order;
  std::size_t moves = 0;
  const std::size_t enough = 8 * order.size() + 64;
  for (std::size_t k = 1; k < order.size(); ++k) {
    const Index body = order[k];
    std::size_t at = k;
    for (; at > 0 && before(body, order[at - 1]); --at, ++moves) order[at] = order[at - 1];
    order[at] = body;
    if (moves > enough) {  // much has jumped: sort afresh
      std::sort(order.begin(), order.end(), before);
      return;
    }
  }
}

using Pairs = std::vector<std::pair<Index, Index>>;  // i before j

void addPair(Index a, Index b, Pairs& found) {
  found.emplace_back(std::min(a, b), std::max(a, b));
}

// The bounds stand in the order of the sweep, so that it runs through memory from front to back.
std::uint64_t sweepAlong(Context& context, int axis, Pairs& found) {
  const Bodies& bodies = context.scene.bodies;
  const std::vector<Index>& order = context.scene.sweep.order;
  std::vector<Bounds> sorted;
  sorted.reserve(order.size());
  for (const Index i : order) sorted.push_back(context.step.bounds[i]);
  struct Part {
    Pairs found;
    std::uint64_t tests = 0;
  };
  std::vector<Part> parts(Workers::parts(sorted.size(), kBodiesOfAPart));
  context.step.workers->share(sorted.size(), kBodiesOfAPart, [&](auto part, auto begin, auto end) {
    for (std::size_t k = begin; k < end; ++k) {
      const Bounds a = sorted[k];
      std::size_t m = k + 1;
      for (; m < sorted.size() && sorted[m].lo[axis] <= a.hi[axis]; ++m)
        if (a.overlaps(sorted[m]) && mayCollide(bodies.traits[order[k]], bodies.traits[order[m]]))
          addPair(order[k], order[m], parts[part].found);
      parts[part].tests += m - k - 1;
    }
  });
  std::uint64_t tests = 0;
  for (const Part& part : parts) {
    found.insert(found.end(), part.found.begin(), part.found.end());
    tests += part.tests;
  }
  return tests;
}

// A plane has no bounds: its distance to a body's bounds is taken instead. Point x of the bounds is at s =
// n.(x - p) above a plane through p with the unit normal n. Where the plane moves with (v, w), s falls no
// faster than
//   -ds/dt = n.v - (w x n).(x - p) <= |v| + |w| |x - p|,
// and no faster than n.v where it does not turn.
void sweepPlanes(const Context& context, Pairs& found) {
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
      if (lowest <= offset && mayCollide(bodies.traits[plane], bodies.traits[b])) addPair(plane, b, found);
    }
  }
}

}  // namespace

bool mayCollide(const Traits& a, const Traits& b) {
  const bool moving = a.moved_by_forces() || b.moved_by_forces() || (a.asleep && b.is_kinematic()) ||
                      (b.asleep && a.is_kinematic());
  return moving && (a.group & b.mask) && (b.group & a.mask);
}

void run(Context& context) {
  SceneStore& scene = context.scene;
  StepStore& step = context.step;
  const std::vector<Index>& collidable = scene.lists.collidable;

  step.workers->share(collidable.size(), kBodiesOfAPart, [&](auto, auto begin, auto end) {
    for (std::size_t k = begin; k < end; ++k) {
      const Index i = collidable[k];
      step.bounds[i] = sweptBounds(scene.bodies, step.load[i], i, step.h());
    }
  });
  Sweep& sweep = scene.sweep;
  if (sweep.fresh) chooseAxis(sweep, step.bounds);
  sortByLowerEnd(sweep, step.bounds);
  Pairs found;
  step.report.overlap_tests = sweepAlong(context, sweep.axis, found);
  sweep.fresh = step.report.overlap_tests > 2 * sweep.tests + kFewTests * collidable.size();
  sweepPlanes(context, found);
  std::sort(found.begin(), found.end());
  scene.contacts.update(scene.bodies, found, [&](const Contact& contact) { return scene.isAsleep(contact); });
  step.report.pairs = static_cast<std::uint32_t>(found.size());
}

}  // namespace rbs::sweep_and_prune
