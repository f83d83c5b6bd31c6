// SPDX-License-Identifier: BSD-3-Clause
#include "islands.h"

#include "algebra.h"
#include "fidelity.h"
#include "impact_loop.h"
#include "methods/methods.h"
#include "overlaps.h"
#include "overlooked.h"
#include "promotion.h"
#include "text.h"

#include <algorithm>
#include <numeric>

namespace rbs {

Pose StepStore::poseAt(const Bodies& bodies, Index i, double t) const {
  Pose pose = bodies.pose[i];
  if (island[i] != kNone || !bodies.traits[i].led() || t == t0) return pose;
  pose.p_WB += (t - t0) * bodies.twist[i].v_WB;
  pose.q_WB = (rotationBy((t - t0) * bodies.twist[i].w_WB) * pose.q_WB).normalized();
  return pose;
}

namespace islands {

namespace {

// Union-find over bodies; the root of a set is its smallest member, so that islands come in canonical order.
class DisjointSets {
 public:
  explicit DisjointSets(Index n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0u); }
  Index root(Index i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void unite(Index a, Index b) {
    a = root(a), b = root(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<Index> parent_;
};

void append(std::vector<Index>& to, const std::vector<Index>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

void advanceBatch(Context& context, const IslandBatch& batch, bool exact, double t0, double t1) {
  if (!(t1 > t0) || batch.bodies.empty()) return;
  if (batch.contacts.empty()) {
    flight::advance(context, batch, t0, t1);
  } else if (!exact || !exact_step::advance(context, batch, t0, t1)) {
    soft_step::advance(context, batch, t0, t1);
  }
}

// Whether an island is advanced by sub-steps of its own.
bool isHasty(const Context& context, const Island& island) {
  const std::uint32_t sub_steps = settingsOf(context.scene.settings.fidelity).sub_steps;
  return soft_step::subStep(context, island.contacts) < context.step.h() / sub_steps;
}

// What is left of the step. Islands that no impact has cut are advanced together, by method.
void finish(Context& context) {
  StepStore& step = context.step;
  IslandBatch flyers, touching;
  for (Island& island : step.islands) {
    const bool alone = !island.contacts.empty() && (island.exact || isHasty(context, island));
    if (island.time > step.t0 || alone) {
      bringTo(context, island, step.t1);
    } else {
      IslandBatch& batch = island.contacts.empty() ? flyers : touching;
      append(batch.bodies, island.bodies);
      append(batch.contacts, island.contacts);
      island.time = step.t1;
    }
    step.report.flying += island.contacts.empty() ? static_cast<std::uint32_t>(island.bodies.size()) : 0;
    step.report.islands += island.contacts.empty() ? 0 : 1;
  }
  std::sort(touching.contacts.begin(), touching.contacts.end());
  advanceBatch(context, flyers, false, step.t0, step.t1);
  advanceBatch(context, touching, false, step.t0, step.t1);
}

// What a step changes, as it is before any body moves.
struct Beginning {
  Contacts contacts;
  std::vector<Bounds> bounds;
  StepReport report;
};

// Puts the step back to its beginning, but for these pairs, which contacts are to solve with.
void beginAgain(Context& context, Beginning& beginning, const std::vector<std::pair<Index, Index>>& pairs) {
  Bodies& bodies = context.scene.bodies;
  StepStore& step = context.step;
  for (const Index i : context.scene.rosters.movers)
    bodies.pose[i] = step.before[i], bodies.twist[i] = step.twist_before[i];
  for (const auto& [i, j] : pairs) beginning.contacts.open(bodies, i, j);
  context.scene.contacts = beginning.contacts;
  step.bounds = beginning.bounds;
  step.report = beginning.report;
  std::fill(step.stamp.begin(), step.stamp.end(), 0);
  step.islands.clear();
  link(context);
}

// Whether contacts may push something: some are there, or impacts may leave bodies in contact.
bool mayOverlook(const Context& context) {
  const StepStore& step = context.step;
  if (!settingsOf(context.scene.settings.fidelity).exact || context.scene.rosters.movers.size() < 2)
    return false;
  const std::vector<Contact>& contacts = context.scene.contacts.active;
  const auto stays = [&](const Contact& contact) {
    return context.scene.restitutionOf(contact.i, contact.j) == 0.0;
  };
  const auto inContact = [](const Island& island) { return !island.contacts.empty(); };
  return std::any_of(step.islands.begin(), step.islands.end(), inContact) ||
         (!step.impacts.empty() && std::any_of(contacts.begin(), contacts.end(), stays));
}

// Contacts push bodies off the courses on which they were predicted to pass others. Where that makes a pair
// overlap, the step is taken again with this pair among the contacts.
void advanceOverlookingNone(Context& context) {
  constexpr int kMostTimes = 8;  // each push may reach one body further
  Beginning beginning{context.scene.contacts, context.step.bounds, context.step.report};
  for (int times = 1;; ++times) {
    takeImpacts(context);
    finish(context);
    if (times == kMostTimes || context.step.isLate()) return;
    const std::vector<std::pair<Index, Index>> overlooked = findOverlooked(context);
    if (overlooked.empty()) return;
    beginAgain(context, beginning, overlooked);
  }
}

void moveLedBodies(Context& context) {
  Bodies& bodies = context.scene.bodies;
  for (const Index i : context.scene.rosters.led)
    bodies.pose[i] = context.step.poseAt(bodies, i, context.step.t1);
}

}  // namespace

void bringTo(Context& context, Island& island, double time) {
  advanceBatch(context, {island.bodies, island.contacts}, island.exact, island.time, time);
  island.time = std::max(island.time, time);
}

Need need(const Census& c) {
  const Index movers = c.moved_by_forces - c.ballistic;
  if (movers == 0 && c.led == 0)
    return {false, c.ballistic > 0 ? "all bodies are ballistic" : "nothing moves"};
  return {true, count(movers, "body", "bodies") + " that may meet others or feel more than gravity" +
                    (c.led > 0 ? ", " + count(c.led, "body is", "bodies are") + " led" : "")};
}

void link(Context& context) {
  StepStore& step = context.step;
  const Index n = context.scene.bodies.size();
  DisjointSets sets(n);
  std::vector<char> mover(n, 0);
  for (const Index i : context.scene.rosters.movers) mover[i] = 1;
  const std::vector<Contact>& contacts = context.scene.contacts.active;
  for (const Contact& contact : contacts)
    if (contact.state.isSolved() && mover[contact.i] && mover[contact.j]) sets.unite(contact.i, contact.j);

  for (const Index i : context.scene.rosters.movers) {
    const Index root = sets.root(i);
    if (root == i) {
      step.island[i] = static_cast<Index>(step.islands.size());
      step.islands.emplace_back().time = step.t0;
    }
    step.island[i] = step.island[root];
    step.islands[step.island[i]].bodies.push_back(i);
  }
  for (Index k = 0; k < contacts.size(); ++k) {
    const Contact& contact = contacts[k];
    if (!contact.state.isSolved()) continue;
    const Index body = mover[contact.i] ? contact.i : contact.j;
    if (!mover[body]) continue;
    Island& island = step.islands[step.island[body]];
    island.contacts.push_back(k);
    island.touching = island.touching || contact.state.isTouching();
  }
  const FidelitySettings settings = settingsOf(context.scene.settings.fidelity);
  for (Island& island : step.islands)
    island.exact =
        !overlaps::ruleOver(context, island) &&
        (settings.exact || (settings.promotes && !island.contacts.empty() && isPromoted(context, island)));
}

void advance(Context& context) {
  if (mayOverlook(context)) {
    advanceOverlookingNone(context);
  } else {
    takeImpacts(context);
    finish(context);
  }
  moveLedBodies(context);
}

}  // namespace islands
}  // namespace rbs
