// SPDX-License-Identifier: BSD-3-Clause
#include "state/contact.h"

#include <algorithm>
#include <iterator>

namespace rbs {

namespace {

bool isBefore(const Contact& a, const Contact& b) {
  return a.key < b.key;
}

}  // namespace

void Contact::addEarlier(const SolvedPoint& point) {
  if (point.normal_impulse == 0.0 && point.friction_impulse_W.isZero(0.0)) return;
  const auto place =
      std::lower_bound(earlier.begin(), earlier.end(), point,
                       [](const SolvedPoint& a, const SolvedPoint& b) { return a.feature < b.feature; });
  if (place == earlier.end() || place->feature != point.feature) {
    earlier.insert(place, point);
  } else {
    const SolvedPoint before = std::exchange(*place, point);
    place->addImpulseOf(before);
  }
}

void Contact::addEarlier() {
  for (const SolvedPoint& point : points) addEarlier(point);
}

void Contact::beginSolve() {
  if (solved) addEarlier();
  if (!has_before) points_before.swap(points), exact_before = exact;
  points.clear();
  solved = has_before = true;
}

void Contact::takeBackSolves() {
  if (has_before) points.swap(points_before), exact = exact_before;
  solved = has_before = false;
}

void Contacts::update(const Bodies& bodies, const IndexPairs& found,
                      const std::function<bool(const Contact&)>& rests) {
  active.swap(last_active_), dormant.swap(last_dormant_);
  for (const auto& [i, j] : found) active.push_back(newContact(bodies, i, j));
  for (std::vector<Contact>* last : {&last_active_, &last_dormant_}) {
    auto place = active.begin();
    for (Contact& old : *last) {
      while (place != active.end() && place->key < old.key) ++place;
      if (place != active.end() && place->key == old.key) {
        place->exact = old.exact, place->axis.n_A = old.axis.n_A, place->touching_from = old.touching_from;
        place->points = std::move(old.points), place->earlier = std::move(old.earlier);
        place->points_before = std::move(old.points_before);  // for its room alone
      } else if (const bool stays = !old.points.empty() && rests(old); stays || !old.earlier.empty()) {
        if (!stays) old.points.clear(), old.exact = false;  // what they gave is in `earlier`
        old.state = {}, old.solved = old.has_before = false,
        old.axis.queries = old.axis.kept = 0;  // of the part that has ended
        dormant.push_back(std::move(old));
      }
    }
    last->clear();
  }
  std::sort(dormant.begin(), dormant.end(), isBefore);
}

void Contacts::sortActive() {
  const auto added = std::is_sorted_until(active.begin(), active.end(), isBefore);
  std::sort(added, active.end(), isBefore);
  std::inplace_merge(active.begin(), added, active.end(), isBefore);
}

void Contacts::endStep(const std::function<bool(const Contact&)>& rests) {
  sortActive();
  for (Contact& contact : active) {
    if (!contact.solved && !contact.points.empty() && !rests(contact)) contact.points.clear();
    if (contact.points.empty()) contact.exact = false;
  }
}

Index Contacts::find(Index i, Index j, std::size_t sorted) const {
  const std::pair key(i, j);
  const auto keyOf = [](const Contact& contact) { return std::pair(contact.i, contact.j); };
  const auto end = active.begin() + static_cast<std::ptrdiff_t>(sorted);
  const auto known = std::lower_bound(
      active.begin(), end, key,
      [&](const Contact& contact, const std::pair<Index, Index>& k) { return keyOf(contact) < k; });
  if (known != end && keyOf(*known) == key) return static_cast<Index>(known - active.begin());
  const auto added =
      std::find_if(end, active.end(), [&](const Contact& contact) { return keyOf(contact) == key; });
  return added == active.end() ? kNone : static_cast<Index>(added - active.begin());
}

Contact& Contacts::dormantOf(const Bodies& bodies, Index i, Index j) {
  Contact contact = newContact(bodies, i, j);
  auto place = std::lower_bound(dormant.begin(), dormant.end(), contact, isBefore);
  if (place == dormant.end() || !(place->key == contact.key)) place = dormant.insert(place, contact);
  place->i = i, place->j = j;
  return *place;
}

Index Contacts::add(const Bodies& bodies, Index i, Index j) {
  Contact& known = dormantOf(bodies, i, j);
  active.push_back(std::move(known));
  dormant.erase(dormant.begin() + (&known - dormant.data()));
  return static_cast<Index>(active.size() - 1);
}

std::vector<const Contact*> Contacts::withPoints() const {
  std::vector<const Contact*> all;
  for (const std::vector<Contact>* list : {&active, &dormant})
    for (const Contact& contact : *list)
      if (!contact.points.empty() || !contact.earlier.empty()) all.push_back(&contact);
  std::sort(all.begin(), all.end(), [](const Contact* a, const Contact* b) { return isBefore(*a, *b); });
  return all;
}

void Contacts::forget(BodyId body) {
  for (std::vector<Contact>* list : {&active, &dormant})
    for (Contact& contact : *list)
      if (contact.isOf(body)) contact.forget();
}

void Contacts::remove(BodyId body) {
  const auto isOfBody = [body](const Contact& contact) { return contact.isOf(body); };
  for (std::vector<Contact>* list : {&active, &dormant})
    list->erase(std::remove_if(list->begin(), list->end(), isOfBody), list->end());
}

void Contacts::beginWorldStep() {
  for (std::vector<Contact>* list : {&active, &dormant})
    for (Contact& contact : *list) {
      contact.earlier.clear();
      if (contact.points.empty()) contact.touching_from = 0;
    }
}

void Contacts::endWorldStep(const Bodies& bodies, std::uint64_t step, double seconds, double least) {
  const auto touches = [&](const Contact& contact) {
    const Traits &a = bodies.traits[contact.i], &b = bodies.traits[contact.j];
    const double mass = !a.movable() ? b.mass : !b.movable() ? a.mass : std::min(a.mass, b.mass);
    if (contact.points.empty() || !(a.asleep || b.asleep)) return contact.pushed(least * mass);
    // What sleeps is pushed by the forces with which it fell asleep.
    return contact.touching_from > 0 ? contact.bears() : contact.lastNormal(least * mass / seconds).loaded;
  };
  for (std::vector<Contact>* list : {&active, &dormant})
    for (Contact& contact : *list) {
      if (!touches(contact)) {
        contact.touching_from = 0;
      } else if (contact.touching_from == 0) {
        contact.touching_from = step;
      }
    }
}

Contact newContact(const Bodies& bodies, Index i, Index j) {
  Contact contact;
  contact.key = {bodies.id[i], bodies.id[j]};
  contact.i = i, contact.j = j;
  return contact;
}

}  // namespace rbs
