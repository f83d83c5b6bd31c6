// SPDX-License-Identifier: BSD-3-Clause
#include "step/constraints.h"

#include "effects_built.h"
#include "solver/constraint_kinds.h"

namespace rbs::constraints {

namespace {

template <class... Kinds>
void addEdgesOf(KindList<Kinds...>, const SceneStore& scene, std::vector<Edge>& edges) {
  (Kinds::addEdges(scene, edges), ...);
}

}  // namespace

Edge edgeOf(const Contacts& contacts, Index k) {
  return {ConstraintKind::Contact, k, {contacts.active[k].i, contacts.active[k].j, kNone, kNone}};
}

std::vector<Edge> otherEdges(const SceneStore& scene) {
  std::vector<Edge> found;
  addEdgesOf(OtherKinds(), scene, found);
  return found;
}

std::vector<Edge> edges(const SceneStore& scene) {
  std::vector<Edge> found;
  const Contacts& contacts = scene.contacts;
  for (Index k = 0; k < contacts.active.size(); ++k)
    if (contacts.active[k].state.isForSolver()) found.push_back(edgeOf(contacts, k));
  addEdgesOf(OtherKinds(), scene, found);
  return found;
}

std::vector<Edge> wakingEdges(const SceneStore& scene) {
  std::vector<Edge> found;
  for (Index k = 0; k < scene.contacts.active.size(); ++k) found.push_back(edgeOf(scene.contacts, k));
  addEdgesOf(OtherKinds(), scene, found);
  return found;
}

}  // namespace rbs::constraints
