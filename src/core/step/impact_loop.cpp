// SPDX-License-Identifier: BSD-3-Clause
#include "step/impact_loop.h"

#include "broadphase/bounds.h"
#include "broadphase/bounds_tree.h"
#include "effects/effects.h"
#include "effects_built.h"
#include "narrowphase/collide.h"
#include "solver/contact_preparation.h"
#include "step/early_impacts.h"
#include "step/impact_budget.h"
#include "step/impacts.h"
#include "step/island_contacts.h"
#include "step/island_step.h"
#include "step/islands.h"
#include "step/solver_choice.h"

#include <algorithm>
#include <map>
#include <queue>
#include <set>
#include <tuple>

namespace rbs {

namespace {

// In the order that a sweep leaves, neighbours stand far apart: queries would meet most groups of the tree.
std::vector<Index> byPlace(std::vector<Index> order, const std::vector<Bounds>& bounds) {
  sortByPlace(order, bounds);
  return order;
}

// Goes through the impacts of a step in the order of their times.
class ImpactLoop {
 public:
  explicit ImpactLoop(Context& context)
      : context_(context),
        step_(context.step),
        order_(byPlace(context.scene.pair_search.order, step_.bounds)),
        tree_(order_, step_.bounds),
        sets_(islands::candidateSets(context)),
        budget_(context, sets_),
        contacts_(context, budget_),
        collapse_(step_.solver.collapse_interval * step_.h()),
        struck_(step_.island.size(), 0) {
    for (const PendingImpact& impact : step_.impacts) {
      queue_.push(impact);
      struck_[step_.movedOf(impact.i, impact.j)] = 1;
    }
  }

  void run() {
    takeAll();
    if (!step_.solver.exact) return lookAfterStruck();
    while (context_.scene.effects[Effect::Restitution] && advanceWatchedToEnd()) takeAll();
  }

 private:
  void takeAll() {
    do {
      takeQueued();
      // What other impacts have sent off its trajectory is not awaited any more.
      const std::vector<Contact>& active = context_.scene.contacts.active;
      for (Index k = 0; k < active.size(); ++k)
        if (active[k].state.awaitsImpact()) contacts_.separateOrConnect(active[k].i, active[k].j);
      followSetBack();
    } while (!queue_.empty());
  }

  void takeQueued() {
    while (!queue_.empty()) {
      const PendingImpact impact = queue_.top();
      queue_.pop();
      if (step_.stamp[impact.i] != impact.stamp_i || step_.stamp[impact.j] != impact.stamp_j) continue;
      budget_.takeImpact(impacts::losesEnergy(context_.scene, impact.i, impact.j)) ? take(impact)
                                                                                   : overBudget(impact);
      followSetBack();
    }
  }

  // Bodies whose clock has been set back are on new trajectories.
  void followSetBack() {
    for (auto back = contacts_.takeSetBack(); !back.empty(); back = contacts_.takeSetBack())
      for (const Index i : back) beginAnew(i, step_.timeOf(i));
  }

  struct Later {
    bool operator()(const PendingImpact& a, const PendingImpact& b) const {
      return std::tie(a.time, a.i, a.j) > std::tie(b.time, b.i, b.j);
    }
  };

  // The island that counts an impact.
  Island& islandOf(const PendingImpact& impact) { return *islandOf(step_.movedOf(impact.i, impact.j)); }
  Island* islandOf(Index i) { return step_.island[i] == kNone ? nullptr : &step_.islands[step_.island[i]]; }

  // Velocity of the centre of mass of an island, m/s, when it is asked first in this step.
  const Vec3& velocityOf(Index place) {
    const auto [known, is_new] = velocity_.try_emplace(place, Vec3::Zero());
    if (!is_new) return known->second;
    return known->second = context_.scene.bodies.meanVelocity(step_.islands[place].bodies);
  }

  enum class Brought {
    Both,       ///< both are where the impact is
    Early,      ///< something else comes first: the impact is awaited again
    Expensive,  ///< the budget does not allow it
  };

  // Brings both islands to the impact if the budget allows it, unless their contacts bring others together before.
  Brought advanceBoth(PendingImpact& impact) {
    std::uint64_t cost = 0;
    std::vector<Index> brought;  // islands
    bool watched = false;
    Vec3 group_W = Vec3::Zero();  // of the last one that is cut
    for (const Index i : {impact.i, impact.j}) {
      const Index place = step_.island[i];
      if (place == kNone || (!brought.empty() && brought.front() == place)) continue;
      brought.push_back(place);
      const Island& island = step_.islands[place];
      if (island.time < impact.time && island.constraints() > kSmallIsland)
        cost += island.constraints(), group_W = velocityOf(place);
      watched = watched || isWatched(step_, island, impact.time);
    }
    const bool is_stopped = cost > 0 && impacts::isStoppedByContacts(context_, impact, group_W);
    if (is_stopped && !step_.solver.exact) return Brought::Expensive;
    const Index a = step_.movedOf(impact.i, impact.j), b = step_.movedOf(impact.j, impact.i);
    if (!(is_stopped ? budget_.takeLanding(a, b, cost) : budget_.takeCut(a, b, cost)))
      return bringToGroup(impact, brought) ? Brought::Both : Brought::Expensive;
    if (!watched) {
      for (const Index place : brought) advanceTo(context_, step_.islands[place], impact.time);
      return Brought::Both;
    }
    const auto early = advanceUnlessEarly(context_, brought, impact.time,
                                          [&](Index i) { return notKeptFrom(i, impact.time); });
    if (!early) return Brought::Both;
    queueEarly(*early);
    if (early->i != impact.i || early->j != impact.j) queue_.push(impact);
    return Brought::Early;
  }

  // At the exact settings a large group that the budget does not allow to bring to an impact has it at its own time, as if the two
  // bodies had moved on alike since then: by contacts they would not rebound. What is supported moves on as if at a constant velocity
  // until they meet, so that the impact is as strong as it would be.
  bool bringToGroup(PendingImpact& impact, const std::vector<Index>& islands) {
    if (!step_.solver.exact || !impact.rebounds) return false;
    if (islands.size() == 1) return true;
    const auto isGroup = [&](Index place) { return step_.islands[place].constraints() > kSmallIsland; };
    const bool first = isGroup(islands[0]), second = isGroup(islands[1]);
    const bool strikes_first = step_.island[impact.i] == islands[first ? 1 : 0];
    const Index strikes = strikes_first ? impact.i : impact.j, struck = strikes_first ? impact.j : impact.i;
    Island& own = step_.islands[step_.island[strikes]];
    const bool rests = step_.supported[struck] || step_.touched[struck];
    if (first == second || !rests || !own.flies() || isWatched(step_, own, impact.time)) return false;
    if (!contacts_.mayGoBack(strikes, struck)) return false;
    advanceTo(context_, own, impact.time);
    contacts_.setBack(strikes, struck);
    impact.time = step_.timeOf(struck);
    return true;
  }

  // Whether contacts have brought a pair together too often in the step: then one of theirs is to keep the two apart.
  bool isPushedTogether(Index i, Index j) const {
    const auto known = early_.find({i, j});
    return known != early_.end() && known->second >= kMostEarly;
  }

  void queueEarly(const PendingImpact& early) {
    ++early_[{early.i, early.j}];
    queue_.push(early);
  }

  // Brings what is watched to the end of the step, a set of bodies that may meet at a time, as far as the budget allows. Whether
  // contacts bring some together before that rebound; others are for the search after the step (missed_contacts.h), which makes
  // contacts of them. In a group that no budget allows to watch, contacts keep apart what they may bring together.
  bool advanceWatchedToEnd() {
    std::map<Index, std::vector<Index>> sets;  // islands, by root
    for (Index place = 0; place < step_.islands.size(); ++place)
      if (isWatched(step_, step_.islands[place], step_.t1))
        sets[sets_.root(step_.islands[place].bodies.front())].push_back(place);
    const auto rebounding = [this](Index i) {
      std::vector<Index> others = notKeptFrom(i, step_.t1);
      const auto stays = [&](Index j) { return context_.scene.restitutionOf(i, j) == 0.0; };
      others.erase(std::remove_if(others.begin(), others.end(), stays), others.end());
      return others;
    };
    bool found = false;
    std::vector<char> unwatched(step_.island.size(), 0);  // by root of a set
    for (const auto& [root, islands] : sets) {
      std::uint64_t cost = 0;
      for (const Index place : islands)
        if (step_.islands[place].constraints() > kSmallIsland) cost += step_.islands[place].constraints();
      if (!budget_.takeCut(root, root, cost)) {
        unwatched[root] = !ImpactBudget::couldCutExact(cost);
        continue;
      }
      const auto early = advanceUnlessEarly(context_, islands, step_.t1, rebounding);
      if (early) queueEarly(*early), found = true;
    }
    return contacts_.connectSeparated([&](Index i) { return unwatched[sets_.root(i)] != 0; }) || found;
  }

  // What body i may meet that no contact keeps apart from it, and that is not ahead of `time`. Contacts may have pushed
  // the body out of the bounds of its own motion.
  std::vector<Index> notKeptFrom(Index i, double time) {
    if (!tree_.holds(i)) return {};
    const Bounds now = sweptBounds(context_.scene.bodies, {}, i, 0.0);
    if (!step_.bounds[i].holds(now, 0.0)) tree_.move(i, step_.bounds[i].with(now));
    std::vector<Index> found;
    const auto add = [&](Index j) {
      const auto [a, b] = std::minmax(i, j);
      if (!mayCollide(context_.scene.bodies.traits[a], context_.scene.bodies.traits[b])) return;
      if (step_.isCrowded(a) && step_.isCrowded(b)) return;
      if (step_.timeOf(j) > time) return;
      const Index contact = contacts_.find(a, b);
      if (contact != kNone) {
        const PairState& state = context_.scene.contacts.active[contact].state;
        if (state.isDepenetrating() || (state.isForSolver() && contacts_.isConstraint(contact))) return;
      }
      if (!isPushedTogether(a, b)) found.push_back(j);
    };
    for (const Index j : tree_.of(i)) add(j);
    for (const Index j : context_.scene.lists.planes) add(j);
    return found;
  }

  void take(PendingImpact impact) {
    contacts_.disturb(impact.i, impact.j);
    const Brought brought = advanceBoth(impact);
    if (brought == Brought::Early) return;
    if (brought == Brought::Expensive || isCollapsing(impact) || isPushedTogether(impact.i, impact.j)) {
      ++islandOf(impact).deferred_impacts;
      if (brought == Brought::Expensive) leaveToRebounds(impact);
      leaveToContacts(impact.i, impact.j);
      if (brought == Brought::Expensive && step_.solver.exact) watchBehind(impact);
      return;
    }
    const impacts::Outcome outcome =
        impacts::resolve(context_, contacts_.contactOf(impact.i, impact.j), impact.time);
    if (outcome == impacts::Outcome::Miss) {
      const auto later = predict(impact.i, impact.j, impact.time).impact;
      if (later && later->time > impact.time) {
        queue_.push(*later);
      } else if (!waitsForRebound(impact)) {
        contacts_.connect(impact.i, impact.j, false);
      }
      return;
    }
    ++islandOf(impact).impacts;
    step_.impacted.emplace_back(impact.i, impact.j);
    if (outcome == impacts::Outcome::Stay) leaveToContacts(impact.i, impact.j);
    budget_.chargeImpact([&] {
      for (const Index i : {impact.i, impact.j}) {
        if (step_.island[i] == kNone) continue;  // no impact changes the trajectory of a body in no island
        beginAnew(i, step_.timeOf(i));
      }
    });
  }

  // Whether two that contacts have brought together early are not on their way to each other yet, and will rebound: contacts act later
  // in the step, and push the two together in what is left of it. They would take the rebound, and the next step gives it. So the two
  // are left alone.
  bool waitsForRebound(const PendingImpact& impact) {
    const auto early = early_.find({impact.i, impact.j});
    if (!step_.solver.exact || early == early_.end()) return false;
    if (context_.scene.restitutionOf(impact.i, impact.j) == 0.0) return false;
    early->second = kMostEarly;
    PairState& state = contacts_.contactOf(impact.i, impact.j).state;
    if (state.awaitsImpact()) state.separate();
    return true;
  }

  // Of the two methods only the soft one lets contacts rebound.
  void leaveToRebounds(const PendingImpact& impact) {
    if (step_.solver.exact || context_.scene.restitutionOf(impact.i, impact.j) == 0.0) return;
    for (Island* island : {islandOf(impact.i), islandOf(impact.j)})
      if (island) island->exact = false;
  }

  bool isCollapsing(const PendingImpact& impact) {
    return impacts::losesEnergy(context_.scene, impact.i, impact.j) &&
           collapse_.count(impact.i, impact.j, impact.time);
  }

  // Of the sets that had impacts; others go through the step as they do where no other set has one.
  void lookAfterStruck() {
    for (const Island& island : step_.islands)  // impacts may have made one of bodies of several sets
      for (const Index i : island.bodies) budget_.unite(island.bodies.front(), i);
    std::vector<char> struck(step_.island.size(), 0);  // by root of a set
    for (Index i = 0; i < struck.size(); ++i)
      if (struck_[i]) struck[sets_.root(i)] = 1;
    const auto isStruck = [&](const Island& island) {
      return !island.bodies.empty() && struck[sets_.root(island.bodies.front())];
    };
    watchSeparated(isStruck);
    // Bodies that rebound come to touch one after the other, and some only nearly do when the last impact is over.
    for (Island& island : step_.islands)
      if (isStruck(island)) promoteCrushed(island);
    followSetBack();
    takeAll();
  }

  // Contacts may push every body of a set in which something touches off its predicted motion. So what that motion
  // would not have met is left to the contact solver as well. At the exact settings the search afterwards is enough
  // (missed_contacts.h): there a point more costs more than a step taken again.
  template <class IsStruck>
  void watchSeparated(const IsStruck& isStruck) {
    std::vector<char> touches(step_.island.size(), 0);  // by root of a set
    for (const Island& island : step_.islands)
      if (island.touching && isStruck(island)) touches[sets_.root(island.bodies.front())] = 1;
    contacts_.connectSeparated([&](Index i) { return touches[sets_.root(i)] != 0; });
  }

  // A pair that touches. What a new contact may push the two against is looked at with it: a light body that rattles between two
  // others leaves the one in the moment in which the other stays on it.
  void leaveToContacts(Index i, Index j) {
    contacts_.connect(i, j);
    for (const Index k : {i, j}) watchAround(k);
    Island& island = *islandOf(step_.movedOf(i, j));
    promoteCrushed(island);
    const std::size_t struck = contacts_.contactOf(i, j).earlier.size();  // points
    if (context_.scene.restitutionOf(i, j) == 0.0 && 0 < struck && struck < 3) promoteLone(island);
  }

  // A body alone that has come down on a corner or an edge. The soft step would leave it in the ground, and the exact step that
  // follows lift it for nothing. It comes down with other edges in the same step, which takes more work than one that has
  // lain there.
  void promoteLone(Island& island) {
    if (island.bodies.size() > 1 || island.exact || island.cut_short || island.moving_pairs > 0) return;
    chooseSolver(context_, island);
    if (island.exact) island.work_left = kWorkPerBody;
  }

  // Of a body that forces move: nothing pushes others.
  void watchAround(Index i) {
    if (step_.solver.exact || step_.island[i] == kNone || !tree_.holds(i)) return;
    std::vector<Index> others = tree_.of(i);
    const std::vector<Index>& planes = context_.scene.lists.planes;
    others.insert(others.end(), planes.begin(), planes.end());
    for (const Index j : others) {
      const auto [a, b] = std::minmax(i, j);
      const Index contact = contacts_.find(a, b);
      const bool is_left = contact == kNone ? collapse_.knows(a, b)  // too far apart when the step began
                                            : context_.scene.contacts.active[contact].state.isSeparated();
      if (is_left) contacts_.connect(a, b, false);
    }
  }

  // What contacts stop was predicted to go on, and others behind it were predicted not to reach it. They do as soon as it has been
  // stopped, and stop in their turn. Where they rebound, an impact of the next step does it.
  void watchBehind(const PendingImpact& impact) {
    const std::vector<Twist>& twist = context_.scene.bodies.twist;
    watchBehind(impact.i, twist[impact.j].v_WB, impact.time);
    watchBehind(impact.j, twist[impact.i].v_WB, impact.time);
  }

  // Of a body that may come to move with a velocity at `time`.
  void watchBehind(Index first, const Vec3& v_W, double time) {
    std::set<Index> known{first};
    std::vector<Index> stopped{first};
    for (std::size_t k = 0; k < stopped.size(); ++k) {
      if (step_.island[stopped[k]] == kNone || !tree_.holds(stopped[k])) continue;
      for (const Index j : tree_.of(stopped[k])) {
        if (!mayReach(j, stopped[k], v_W, time)) continue;
        contacts_.connect(std::min(j, stopped[k]), std::max(j, stopped[k]), false);
        if (known.insert(j).second) stopped.push_back(j);
      }
    }
  }

  // Whether body j, which no contact keeps apart from body i and which does not rebound from it, would come to it if that moved on
  // with a velocity from `time` on. With n from i to j the two are apart by d + n u t at least, where d is their gap and u the
  // velocity of j against i.
  bool mayReach(Index j, Index i, const Vec3& v_W, double time) const {
    const Bodies& bodies = context_.scene.bodies;
    const Traits &a = bodies.traits[i], &b = bodies.traits[j];
    if (!mayCollide(bodies.traits[std::min(i, j)], bodies.traits[std::max(i, j)])) return false;
    if (b.asleep || step_.timeOf(j) > time || context_.scene.restitutionOf(i, j) > 0.0) return false;
    const Index contact = contacts_.find(std::min(i, j), std::max(i, j));
    if (contact != kNone && !context_.scene.contacts.active[contact].state.isSeparated()) return false;
    const Pose X_i = impacts::trajectoryOf(context_, i).at(time);
    const Motion of_j = impacts::trajectoryOf(context_, j);
    const auto [X_j, twist_j] = of_j.stateAt(time);
    const double left = step_.t1 - time, turning = impacts::turningSpeed(bodies, j);
    const Vec3 u_W = twist_j.v_WB - v_W;
    if (!areWithin(a.shape, X_i, b.shape, X_j, approach(left, u_W, 0.0, turning, of_j.a_W))) return false;
    const Gap between = gap(a.shape, X_i, b.shape, X_j);
    return between.distance + between.n_W.dot(u_W) * left <=
           approach(left, Vec3::Zero(), 0.0, turning, of_j.a_W);
  }

  void promoteCrushed(Island& island) {
    if (!island.cut_short && !island.flies() && isCrushing(context_, island)) island.exact = true;
  }

  // A body is on a new trajectory from `time` on.
  void beginAnew(Index i, double time) {
    ++step_.stamp[i];
    step_.last_impact[i] = {time, context_.scene.bodies.pose[i]};
    if constexpr (built::drag) drag::renew(context_, i, step_.t1 - time);
    queryNeighbours(i);
  }

  // Finds what body i will meet on its new trajectory.
  void queryNeighbours(Index i) {
    const Bodies& bodies = context_.scene.bodies;
    const double from = step_.timeOf(i);
    step_.bounds[i] = sweptBounds(bodies, step_.load[i], i, step_.t1 - from);
    tree_.move(i, step_.bounds[i]);
    for (const Index j : tree_.of(i)) consider(i, j, from);
    for (const Index j : context_.scene.lists.planes) consider(i, j, from);
  }

  impacts::Prediction predict(Index i, Index j, double from) {
    SeparatingAxis axis;  // none: an impact has changed a motion, and the pair may have no contact
    const impacts::Prediction prediction = impacts::predict(context_, i, j, from, axis);
    budget_.chargeQueries(prediction.queries);
    return prediction;
  }

  void consider(Index i, Index j, double from) {
    if (!mayCollide(context_.scene.bodies.traits[i], context_.scene.bodies.traits[j])) return;
    if (step_.isCrowded(i) && step_.isCrowded(j)) return;  // as in impacts::predict()
    const Index place = contacts_.find(i, j);
    PairState* const state = place == kNone ? nullptr : &context_.scene.contacts.active[place].state;
    if (state && state->isDepenetrating()) return;
    if (state && state->isTouching() && context_.scene.restitutionOf(i, j) == 0.0) return;
    // Only where the step began again for i and not for j. What the two do is known once both begin again.
    if (from < step_.t1 && step_.timeOf(j) >= step_.t1) return step_.reached.emplace_back(i, j), void();
    // Where an island has gone back (early_impacts.h), others may be ahead of it.
    const impacts::Prediction prediction = predict(i, j, std::max(from, step_.timeOf(j)));
    if (prediction.impact) {
      queue_.push(*prediction.impact);
      if (state) state->awaitImpact();
    } else if (state && (state->awaitsImpact() || (state->isSeparated() && prediction.touches))) {
      const auto [a, b] = std::minmax(i, j);  // what it waited for will not come
      prediction.touches ? contacts_.connect(a, b, false) : contacts_.separateOrConnect(a, b);
    }
  }

  // Past the budget of impacts the contact solver stops what would pass through.
  void overBudget(const PendingImpact& impact) {
    for (Island* island : {islandOf(impact.i), islandOf(impact.j)})
      if (island) advanceTo(context_, *island, impact.time);
    leaveToContacts(impact.i, impact.j);
    if (warned_.insert(sets_.root(step_.movedOf(impact.i, impact.j))).second) {
      islandOf(impact).warnings.push_back(
          {"impact_budget", "too many impacts in one step, the first left over between bodies '" +
                                context_.scene.bodies.name[impact.i] + "' and '" +
                                context_.scene.bodies.name[impact.j] +
                                "'; the rest lose their rebound. Use a shorter step"});
    }
  }

  // Times that a pair is brought together early: a steady approach takes one.
  static constexpr int kMostEarly = 4;

  Context& context_;
  StepStore& step_;
  std::vector<Index> order_;
  BoundsTree tree_;
  DisjointSets sets_;  // of bodies that may meet
  ImpactBudget budget_;
  IslandContacts contacts_;
  InelasticCollapse collapse_;
  std::vector<char> struck_;  // by body: an impact of its own was predicted when the step began
  std::priority_queue<PendingImpact, std::vector<PendingImpact>, Later> queue_;
  std::map<std::pair<Index, Index>, int> early_;  // how often a pair came before its time
  std::map<Index, Vec3> velocity_;                // of islands, see velocityOf()
  std::set<Index> warned_;                        // roots of sets whose impacts went over a budget
};

}  // namespace

void takeImpacts(Context& context) {
  if (!context.step.impacts.empty() || mayMeetUnforeseen(context)) ImpactLoop(context).run();
}

}  // namespace rbs
