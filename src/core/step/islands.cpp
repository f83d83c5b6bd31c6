// SPDX-License-Identifier: BSD-3-Clause
#include "step/islands.h"

#include "base/text.h"
#include "solver/residuals.h"
#include "step/constraints.h"
#include "step/solver_choice.h"

#include <algorithm>
#include <utility>

namespace rbs::islands {

Need need(const SceneAnalysis& c) {
  const Index dynamic = c.moved_by_forces - c.ballistic;
  if (dynamic == 0 && c.kinematic == 0)
    return {false, c.ballistic > 0 ? "all bodies are ballistic" : "nothing moves"};
  return {true,
          count(dynamic, "body", "bodies") + " that may meet others or feel more than gravity" +
              (c.kinematic > 0 ? ", " + count(c.kinematic, "body is", "bodies are") + " kinematic or dragged"
                               : "")};
}

void build(Context& context) {
  build(context, context.scene.lists.in_islands);
}

void build(Context& context, const std::vector<Index>& bodies) {
  const std::size_t first = context.step.islands.size();
  connect(context, bodies, constraints::edges(context.scene));
  for (std::size_t k = first; k < context.step.islands.size(); ++k) {
    Island& island = context.step.islands[k];
    island.touching = std::any_of(island.contacts.begin(), island.contacts.end(), [&](Index contact) {
      return context.scene.contacts.active[contact].state.isTouching();
    });
    chooseSolver(context, island);
  }
}

void connect(Context& context, const std::vector<Index>& bodies, const std::vector<Edge>& edges) {
  StepStore& step = context.step;
  const Index n = context.scene.bodies.size();
  DisjointSets sets(n);
  std::vector<char> dynamic(n, 0);
  for (const Index i : bodies) dynamic[i] = 1;
  // The first body of an edge that forces move; kNone where there is none.
  const auto firstMoved = [&](const Edge& edge) {
    for (const Index i : edge.bodies)
      if (i != kNone && dynamic[i]) return i;
    return kNone;
  };
  for (const Edge& edge : edges) {
    const Index first = firstMoved(edge);
    for (const Index i : edge.bodies)
      if (i != kNone && i != first && dynamic[i]) sets.unite(first, i);
  }
  for (const Index i : bodies) {
    const Index root = sets.root(i);
    if (root == i) {
      step.island[i] = static_cast<Index>(step.islands.size());
      step.islands.emplace_back().time = step.t0;
    }
    step.island[i] = step.island[root];
    Island& island = step.islands[step.island[i]];
    island.bodies.push_back(i);
    island.work_left += kWorkPerBody;
  }
  for (const Edge& edge : edges) {
    const Index first = firstMoved(edge);
    if (first == kNone) continue;
    Island& island = step.islands[step.island[first]];
    edge.kind == ConstraintKind::Contact ? island.contacts.push_back(edge.of) : island.edges.push_back(edge);
  }
}

DisjointSets candidateSets(const Context& context) {
  const std::vector<Index>& island = context.step.island;
  DisjointSets sets(context.scene.bodies.size());
  const auto unite = [&](Index i, Index j) {
    if (island[i] != kNone && island[j] != kNone) sets.unite(i, j);
  };
  for (const Contact& contact : context.scene.contacts.active) unite(contact.i, contact.j);
  for (const auto& [i, j] : context.step.impacted) unite(i, j);
  for (const Island& one : context.step.islands)
    for (const Index i : one.bodies) unite(one.bodies.front(), i);
  return sets;
}

Index merge(Context& context, Index a, Index b) {
  StepStore& step = context.step;
  if (a > b) std::swap(a, b);
  Island &kept = step.islands[a], &gone = step.islands[b];
  for (const Index body : gone.bodies) step.island[body] = a;
  kept.exact = isExactTogether(context, kept, gone);
  residuals::add(kept.residuals, gone.residuals);
  kept.work_left += gone.work_left;
  kept.moving_pairs += gone.moving_pairs;
  kept.cut_short = kept.cut_short || gone.cut_short;
  kept.impacts += gone.impacts;
  kept.deferred_impacts += gone.deferred_impacts;
  kept.warnings.insert(kept.warnings.end(), gone.warnings.begin(), gone.warnings.end());
  kept.append(gone);
  kept.touching = kept.touching || gone.touching;
  static_cast<Subgraph&>(gone) = {};
  return a;
}

}  // namespace rbs::islands
