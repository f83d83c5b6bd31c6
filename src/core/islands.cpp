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
  if (batch.pairs.empty()) {
    flight::advance(context, batch, t0, t1);
  } else if (!exact || !exact_step::advance(context, batch, t0, t1)) {
    soft_step::advance(context, batch, t0, t1);
  }
}

// Whether an island is advanced by sub-steps of its own.
bool isHasty(const Context& context, const Island& island) {
  const std::uint32_t sub_steps = settingsOf(context.scene.settings.fidelity).sub_steps;
  return soft_step::subStep(context, island.pairs) < context.step.h() / sub_steps;
}

// What is left of the step. Islands that no impact has cut are advanced together, by method.
void finish(Context& context) {
  StepStore& step = context.step;
  IslandBatch flyers, touching;
  for (Island& island : step.islands) {
    const bool alone = !island.pairs.empty() && (island.exact || isHasty(context, island));
    if (island.time > step.t0 || alone) {
      bringTo(context, island, step.t1);
    } else {
      IslandBatch& batch = island.pairs.empty() ? flyers : touching;
      append(batch.bodies, island.bodies);
      append(batch.pairs, island.pairs);
      island.time = step.t1;
    }
    step.report.flying += island.pairs.empty() ? static_cast<std::uint32_t>(island.bodies.size()) : 0;
    step.report.islands += island.pairs.empty() ? 0 : 1;
  }
  std::sort(touching.pairs.begin(), touching.pairs.end());
  advanceBatch(context, flyers, false, step.t0, step.t1);
  advanceBatch(context, touching, false, step.t0, step.t1);
}

// Leaves a pair to the contact solver from the start of the step.
void openPair(StepStore& step, const Bodies& bodies, Index i, Index j) {
  std::vector<ContactPair>& pairs = step.contacts.pairs;
  ContactPair pair;
  pair.i = i, pair.j = j, pair.id_i = bodies.id[i], pair.id_j = bodies.id[j];
  const auto place =
      std::lower_bound(pairs.begin(), pairs.end(), pair,
                       [](const ContactPair& a, const ContactPair& b) { return a.key() < b.key(); });
  const std::ptrdiff_t k = place - pairs.begin();
  if (place == pairs.end() || place->key() != pair.key()) {
    pairs.insert(place, pair);
    step.standing.insert(step.standing.begin() + k, Standing::Open);
  }
  step.standing[static_cast<std::size_t>(k)] = Standing::Open;
}

// Puts the step back to where it was before any body moved, but for these pairs, which contacts are to solve
// with.
void beginAgain(Context& context, const StepStore& begun, const std::vector<std::pair<Index, Index>>& pairs) {
  Bodies& bodies = context.scene.bodies;
  StepStore& step = context.step;
  for (const Index i : context.scene.rosters.movers)
    bodies.pose[i] = step.before[i], bodies.twist[i] = step.twist_before[i];
  step = begun;
  for (const auto& [i, j] : pairs) openPair(step, bodies, i, j);
  step.islands.clear();
  link(context);
}

// Whether contacts may push something: some are there, or impacts may leave bodies in contact.
bool mayOverlook(const Context& context) {
  const StepStore& step = context.step;
  if (!settingsOf(context.scene.settings.fidelity).exact || context.scene.rosters.movers.size() < 2)
    return false;
  const auto stays = [&](const ContactPair& pair) {
    return context.scene.restitutionOf(pair.i, pair.j) == 0.0;
  };
  const auto inContact = [](const Island& island) { return !island.pairs.empty(); };
  return std::any_of(step.islands.begin(), step.islands.end(), inContact) ||
         (!step.impacts.empty() &&
          std::any_of(step.contacts.pairs.begin(), step.contacts.pairs.end(), stays));
}

// Contacts push bodies off the courses on which they were predicted to pass others. Where that makes a pair
// overlap, the step is taken again with this pair among the contacts.
void advanceOverlookingNone(Context& context) {
  constexpr int kMostTimes = 8;  // each push may reach one body further
  StepStore begun = context.step;
  for (int times = 1;; ++times) {
    takeImpacts(context);
    finish(context);
    if (times == kMostTimes || context.step.isLate()) return;
    const std::vector<std::pair<Index, Index>> overlooked = findOverlooked(context);
    if (overlooked.empty()) return;
    beginAgain(context, begun, overlooked);
    begun = context.step;
  }
}

void moveLedBodies(Context& context) {
  Bodies& bodies = context.scene.bodies;
  for (const Index i : context.scene.rosters.led)
    bodies.pose[i] = context.step.poseAt(bodies, i, context.step.t1);
}

}  // namespace

void bringTo(Context& context, Island& island, double time) {
  advanceBatch(context, {island.bodies, island.pairs}, island.exact, island.time, time);
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
  const std::vector<ContactPair>& pairs = step.contacts.pairs;
  for (std::size_t k = 0; k < pairs.size(); ++k)
    if (mayTouch(step.standing[k]) && mover[pairs[k].i] && mover[pairs[k].j])
      sets.unite(pairs[k].i, pairs[k].j);

  for (const Index i : context.scene.rosters.movers) {
    const Index root = sets.root(i);
    if (root == i) {
      step.island[i] = static_cast<Index>(step.islands.size());
      step.islands.emplace_back().time = step.t0;
    }
    step.island[i] = step.island[root];
    step.islands[step.island[i]].bodies.push_back(i);
  }
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    if (!mayTouch(step.standing[k])) continue;
    const Index body = mover[pairs[k].i] ? pairs[k].i : pairs[k].j;
    if (!mover[body]) continue;
    Island& island = step.islands[step.island[body]];
    island.pairs.push_back(static_cast<Index>(k));
    island.contact = island.contact || step.standing[k] == Standing::Contact;
  }
  const FidelitySettings settings = settingsOf(context.scene.settings.fidelity);
  for (Island& island : step.islands)
    island.exact =
        !overlaps::ruleOver(context, island) &&
        (settings.exact || (settings.promotes && !island.pairs.empty() && isPromoted(context, island)));
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
