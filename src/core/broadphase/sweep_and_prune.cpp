#include "broadphase/sweep_and_prune.h"

#include "broadphase/bounds.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace rbs::sweep_and_prune {

namespace {

// Sorts the order of the last step by the lower ends of today's intervals. Bodies move little from step to
// step, so insertion sort needs about as many moves as bodies that overtook each other. Ties go by index, so
// that the result does not depend on the past.
void sortByLowerEnd(std::vector<Index>& order, const std::vector<Interval>& intervals) {
  const auto before = [&](Index a, Index b) {
    return intervals[a].lo < intervals[b].lo || (intervals[a].lo == intervals[b].lo && a < b);
  };
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

void addPair(Context& context, Index a, Index b) {
  const Bodies& bodies = context.scene.bodies;
  ContactPair pair;
  pair.i = std::min(a, b);
  pair.j = std::max(a, b);
  pair.id_i = bodies.id[pair.i];
  pair.id_j = bodies.id[pair.j];
  context.step.contacts.pairs.push_back(pair);
}

void sweep(Context& context, const std::vector<Interval>& intervals) {
  const Bodies& bodies = context.scene.bodies;
  const std::vector<Index>& order = context.scene.sort_order;
  const std::vector<Aabb>& bounds = context.step.bounds;
  for (std::size_t k = 0; k < order.size(); ++k) {
    const Index a = order[k];
    for (std::size_t m = k + 1; m < order.size() && intervals[order[m]].lo <= intervals[a].hi; ++m) {
      const Index b = order[m];
      if (bounds[a].overlaps(bounds[b]) && mayCollide(bodies.traits[a], bodies.traits[b]))
        addPair(context, a, b);
    }
  }
}

// A plane has no bounds: its distance to a body's bounds is taken instead.
void sweepPlanes(Context& context) {
  const Bodies& bodies = context.scene.bodies;
  for (const Index plane : context.scene.rosters.planes) {
    const Vec3 n = bodies.pose[plane].q_WB * Vec3::UnitZ();
    const double offset = n.dot(bodies.pose[plane].p_WB);
    for (const Index b : context.scene.rosters.collidable) {
      const Aabb& box = context.step.bounds[b];
      const double lowest = 0.5 * (n.dot(box.lo + box.hi) - n.cwiseAbs().dot(box.hi - box.lo));
      if (lowest <= offset && mayCollide(bodies.traits[plane], bodies.traits[b])) addPair(context, plane, b);
    }
  }
}

// Hands the touches of the last step's pairs on to the same pairs of this one; both are sorted by key.
void inheritTouches(const Contacts& last, StepStore& step) {
  auto old = last.pairs.begin();
  for (ContactPair& pair : step.contacts.pairs) {
    while (old != last.pairs.end() && old->key() < pair.key()) ++old;
    if (old == last.pairs.end() || old->key() != pair.key()) continue;
    pair.first = static_cast<Index>(step.contacts.touches.size());
    pair.size = old->size;
    const auto touches = last.touches.begin() + old->first;
    step.contacts.touches.insert(step.contacts.touches.end(), touches, touches + old->size);
  }
  step.inherited = static_cast<Index>(step.contacts.touches.size());
}

}  // namespace

Need need(const Census& c) {
  if (c.collidable < 2) return {false, "fewer than two bodies can collide"};
  if (c.moved_by_forces == 0 && c.led == 0) return {false, "nothing moves"};
  return {true, std::to_string(c.collidable) + " bodies can collide"};
}

bool mayCollide(const Traits& a, const Traits& b) {
  return (a.moved_by_forces() || b.moved_by_forces()) && (a.group & b.mask) && (b.group & a.mask);
}

void run(Context& context) {
  SceneStore& scene = context.scene;
  StepStore& step = context.step;
  const std::vector<Index>& collidable = scene.rosters.collidable;

  std::vector<Interval> intervals(scene.bodies.size());
  for (const Index i : collidable) {
    step.bounds[i] = sweptBounds(scene.bodies, step.load[i], i, step.h());
    intervals[i] = diagonalInterval(scene.bodies, step.load[i], i, step.h());
  }
  if (scene.sort_order.size() != collidable.size()) scene.sort_order = collidable;
  sortByLowerEnd(scene.sort_order, intervals);

  sweep(context, intervals);
  sweepPlanes(context);
  std::vector<ContactPair>& pairs = step.contacts.pairs;
  std::sort(pairs.begin(), pairs.end(),
            [](const ContactPair& a, const ContactPair& b) { return a.key() < b.key(); });
  inheritTouches(scene.contacts, step);
  step.standing.assign(pairs.size(), Standing::Open);
  step.report.pairs = static_cast<std::uint32_t>(pairs.size());
}

}  // namespace rbs::sweep_and_prune
