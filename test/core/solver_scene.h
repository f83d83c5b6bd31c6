// SPDX-License-Identifier: BSD-3-Clause
// What the solvers see of a scene: its stores, with all bodies that forces move in one island.
#pragma once

#include "solver/methods.h"
#include "step/analyse_scene.h"
#include "step/islands.h"

#include <vector>

namespace rbs::test {

struct SolverScene {
  SceneStore store;
  StepStore step;
  SceneAnalysis analysis;
  Context context{store, step, analysis};
  Subgraph batch;

  /// To be called when the store has its bodies: a step of length h, s, begins.
  void begin(double h) {
    analysis = analyseScene(store);
    step.begin(store, 0.0, h);
    step.islands.resize(1);
    for (const Index i : store.lists.in_islands) step.island[i] = 0, batch.bodies.push_back(i);
  }
  /// Two bodies touch, i < j. Nothing where forces move neither.
  void touch(Index i, Index j) {
    if (step.island[i] == kNone && step.island[j] == kNone) return;
    batch.contacts.push_back(store.contacts.add(store.bodies, i, j));
    store.contacts.active.back().state.touch();
  }
};

}  // namespace rbs::test
