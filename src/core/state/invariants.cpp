// SPDX-License-Identifier: BSD-3-Clause
#include "state/invariants.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iostream>

namespace rbs::invariants {

namespace {

// Products of rotations are normalised, but for the rounding of the last few.
constexpr double kUnit = 1e-9;

std::string of(const Bodies& bodies, Index i, const char* fault) {
  return "body '" + bodies.name[i] + "': " + fault;
}

bool isUnit(double squared) {
  return std::abs(squared - 1.0) <= kUnit;
}

bool isList(const std::vector<Index>& list, Index n) {
  const bool in_order =
      std::adjacent_find(list.begin(), list.end(), std::greater_equal<Index>()) == list.end();
  return in_order && (list.empty() || list.back() < n);
}

bool has(const std::vector<Index>& list, Index i) {
  return std::binary_search(list.begin(), list.end(), i);
}

template <class... Columns>
bool haveSize(std::size_t n, const Columns&... columns) {
  return ((columns.size() == n) && ...);
}

std::string brokenBody(const Bodies& bodies, Index i) {
  const Traits& t = bodies.traits[i];
  const Inertia& m = bodies.inertia[i];
  const auto is = [&](const char* fault) { return of(bodies, i, fault); };
  if (i > 0 && !(bodies.id[i - 1] < bodies.id[i])) return is("its number is not above the last one's");
  if (!bodies.pose[i].p_WB.allFinite()) return is("its position is not finite");
  if (!isUnit(bodies.pose[i].q_WB.squaredNorm())) return is("its quaternion is not of unit length");
  if (!bodies.twist[i].v_WB.allFinite() || !bodies.twist[i].w_WB.allFinite())
    return is("its velocity is not finite");
  if (t.moved_by_forces() != (m.inv_mass > 0.0)) return is("its inverse mass is not that of its kind");
  if (!(m.inv_moments.minCoeff() >= 0.0)) return is("an inverse moment of inertia is below zero");
  if (t.moved_by_forces() && !(m.moments.minCoeff() > 0.0))
    return is("a moment of inertia is not above zero");
  if ((m.steady || !t.moved_by_forces()) && !m.inv_moments.isZero(0.0))
    return is("something may turn it, although nothing turns it");
  return "";
}

std::string brokenLists(const SceneStore& scene) {
  const BodyLists& r = scene.lists;
  const Index n = scene.bodies.size();
  for (const auto* list : {&r.ballistic, &r.tumbling, &r.in_islands, &r.kinematic, &r.collidable, &r.planes})
    if (!isList(*list, n)) return "a list of bodies is not in order";
  for (const std::vector<Index>& list : r.feeling)
    if (!isList(list, n)) return "a list of bodies that feel an effect is not in order";
  for (Index i = 0; i < n; ++i) {
    const Traits& t = scene.bodies.traits[i];
    const int lists = has(r.ballistic, i) + has(r.in_islands, i);
    if (lists != int{t.moved_by_forces()})
      return of(scene.bodies, i, "it is not on exactly one list of awake dynamic bodies");
    if (has(r.kinematic, i) != t.is_kinematic())
      return of(scene.bodies, i, "the list of kinematic bodies is wrong about it");
  }
  std::vector<Index> order = scene.pair_search.order;
  std::sort(order.begin(), order.end());
  return order == r.collidable ? "" : "the broad phase does not sort the bodies that may meet";
}

std::string brokenContact(const Contact& contact) {
  if (!(contact.key.i < contact.key.j)) return "the bodies of a contact are not in canonical order";
  for (const std::vector<SolvedPoint>* points : {&contact.points, &contact.earlier})
    for (const SolvedPoint& point : *points) {
      if (!isUnit(point.n_W.squaredNorm())) return "the normal of a contact point is not of unit length";
      if (!(point.normal >= 0.0)) return "a contact point pulls";
    }
  return "";
}

std::string brokenContacts(const std::vector<Contact>& contacts) {
  const auto inOrder = [](const Contact& a, const Contact& b) { return !(a.key < b.key); };
  if (std::adjacent_find(contacts.begin(), contacts.end(), inOrder) != contacts.end())
    return "contacts are not in order";
  for (const Contact& contact : contacts)
    if (std::string fault = brokenContact(contact); !fault.empty()) return fault;
  return "";
}

// In a step a contact knows the places of its bodies, and those that impacts add are not sorted yet.
std::string brokenActive(const SceneStore& scene) {
  for (const Contact& contact : scene.contacts.active) {
    if (contact.i >= scene.bodies.size() || contact.j >= scene.bodies.size())
      return "a contact has a body that is not there";
    if (scene.bodies.id[contact.i] != contact.key.i || scene.bodies.id[contact.j] != contact.key.j)
      return "a contact has other bodies than its key says";
    if (std::string fault = brokenContact(contact); !fault.empty()) return fault;
  }
  return "";
}

std::string brokenIslands(const SceneStore& scene, const StepStore& step) {
  std::vector<char> found(scene.bodies.size(), 0);
  for (std::size_t k = 0; k < step.islands.size(); ++k) {
    const Island& island = step.islands[k];
    for (const Index i : island.bodies) {
      if (i >= found.size() || found[i]++ != 0) return "a body is in two islands";
      if (step.island[i] != k) return of(scene.bodies, i, "it does not know its island");
    }
    for (const Index contact : island.contacts)
      if (contact >= scene.contacts.active.size()) return "an island has a contact that is not there";
    if (!island.bodies.empty() && island.time != step.t1)
      return "an island has not come to the end of the step";
  }
  for (Index i = 0; i < found.size(); ++i)
    if (bool{found[i] != 0} != has(scene.lists.in_islands, i))
      return of(scene.bodies, i, "the islands do not hold the awake dynamic bodies");
  return "";
}

}  // namespace

std::string broken(const SceneStore& scene) {
  const Bodies& b = scene.bodies;
  const Index n = b.size();
  if (!haveSize(n, b.pose, b.since, b.twist, b.inertia, b.traits, b.name, b.color, b.advance))
    return "the arrays of bodies differ in size";
  if (scene.counts.entries.size() != n) return "the analysis has counted other bodies";
  if (!scene.rest.empty() && scene.rest.size() != n) return "the list of rest is of other bodies";
  for (Index i = 0; i < n; ++i)
    if (std::string fault = brokenBody(b, i); !fault.empty()) return fault;
  if (std::string fault = brokenLists(scene); !fault.empty()) return fault;
  if (std::string fault = brokenContacts(scene.contacts.active); !fault.empty()) return fault;
  return brokenContacts(scene.contacts.dormant);
}

std::string broken(const SceneStore& scene, const StepStore& step) {
  const std::size_t n = step.load.size();
  if (n != 0 && n != scene.bodies.size()) return "the step has arrays of other bodies";
  if (!haveSize(n, step.bounds, step.supported, step.touched, step.stamp, step.last_impact, step.island,
                step.slot, step.before, step.twist_before))
    return "the arrays of the step differ in size";
  if (std::any_of(step.slot.begin(), step.slot.end(), [](Index slot) { return slot != kNone; }))
    return "a place in a problem was not given back";
  if (std::string fault = brokenActive(scene); !fault.empty()) return fault;
  return n == 0 ? "" : brokenIslands(scene, step);
}

bool hold(const std::string& fault) {
  if (!fault.empty()) std::cerr << "a store is broken: " << fault << std::endl;
  return fault.empty();
}

}  // namespace rbs::invariants
