// SPDX-License-Identifier: BSD-3-Clause
#include "step/missed_contacts.h"

#include "broadphase/bounds.h"
#include "broadphase/bounds_tree.h"
#include "narrowphase/collide.h"
#include "solver/contact_preparation.h"

#include <algorithm>

namespace rbs {

namespace {

constexpr double kMissed = 1e-7;  // of the smaller length: an overlap below it is none

// Those that the contact solver has looked at, or is not to look at.
IndexPairs knownPairs(const Contacts& contacts) {
  IndexPairs known;
  for (const Contact& contact : contacts.active)
    if (contact.state.isSolved() || contact.state.isDepenetrating()) known.emplace_back(contact.i, contact.j);
  std::sort(known.begin(), known.end());
  return known;
}

bool overlap(const Context& context, Index i, Index j) {
  const Bodies& bodies = context.scene.bodies;
  const double t1 = context.step.t1;
  const Manifold manifold = collide(bodies.traits[i].shape, context.step.poseAt(bodies, i, t1),
                                    bodies.traits[j].shape, context.step.poseAt(bodies, j, t1), 0.0);
  for (int p = 0; p < manifold.size; ++p)
    if (manifold.points[p].separation < -kMissed * smallerLength(bodies, i, j)) return true;
  return false;
}

}  // namespace

IndexPairs findMissedContacts(const Context& context) {
  const SceneStore& scene = context.scene;
  const StepStore& step = context.step;
  std::vector<Index> pushed;
  for (const Island& island : step.islands)
    if (!island.flies() && island.exact)
      pushed.insert(pushed.end(), island.bodies.begin(), island.bodies.end());
  if (pushed.empty()) return {};
  BoundsTree tree(scene.pair_search.order, step.bounds);
  for (const Index i : pushed) tree.move(i, sweptBounds(scene.bodies, {}, i, 0.0));

  const IndexPairs known = knownPairs(scene.contacts);
  IndexPairs found;
  const auto look = [&](Index a, Index b) {
    const Index i = std::min(a, b), j = std::max(a, b);
    if (!mayCollide(scene.bodies.traits[i], scene.bodies.traits[j])) return;
    if (scene.restitutionOf(i, j) > 0.0 || std::binary_search(known.begin(), known.end(), std::pair(i, j)))
      return;
    if (overlap(context, i, j)) found.emplace_back(i, j);
  };
  for (const Index i : pushed) {
    for (const Index j : tree.of(i)) look(i, j);
    for (const Index j : scene.lists.planes) look(i, j);
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

}  // namespace rbs
