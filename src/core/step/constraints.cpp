// SPDX-License-Identifier: BSD-3-Clause
#include "step/constraints.h"

#include <array>

namespace rbs::constraints {

namespace {

using AddEdges = void (*)(const SceneStore&, std::vector<Edge>&);

void contactsForSolver(const SceneStore& scene, std::vector<Edge>& edges) {
  const Contacts& contacts = scene.contacts;
  for (Index k = 0; k < contacts.active.size(); ++k)
    if (contacts.active[k].state.isForSolver()) edges.push_back(edgeOf(contacts, k));
}

void activeContacts(const SceneStore& scene, std::vector<Edge>& edges) {
  for (Index k = 0; k < scene.contacts.active.size(); ++k) edges.push_back(edgeOf(scene.contacts, k));
}

struct Kind {
  AddEdges tying, waking;
};
constexpr std::array kKinds{
    Kind{contactsForSolver, activeContacts},
};

std::vector<Edge> edgesOf(const SceneStore& scene, AddEdges Kind::*role) {
  std::vector<Edge> edges;
  for (const Kind& kind : kKinds) (kind.*role)(scene, edges);
  return edges;
}

}  // namespace

Edge edgeOf(const Contacts& contacts, Index k) {
  return {ConstraintKind::Contact, k, {contacts.active[k].i, contacts.active[k].j, kNone, kNone}};
}

std::vector<Edge> tying(const SceneStore& scene) {
  return edgesOf(scene, &Kind::tying);
}

std::vector<Edge> waking(const SceneStore& scene) {
  return edgesOf(scene, &Kind::waking);
}

}  // namespace rbs::constraints
