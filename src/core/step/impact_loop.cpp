// SPDX-License-Identifier: BSD-3-Clause
#include "step/impact_loop.h"

#include "broadphase/bounds.h"
#include "broadphase/bounds_tree.h"
#include "solver/contact_preparation.h"
#include "step/early_impacts.h"
#include "step/impacts.h"
#include "step/island_step.h"
#include "step/islands.h"
#include "step/missed_contacts.h"
#include "step/solver_choice.h"

#include <algorithm>
#include <cassert>
#include <map>
#include <queue>
#include <set>
#include <tuple>

namespace rbs {

namespace {

// Whether an island may have left its predicted trajectory by `time`. Contacts, torques and drag cause that, and so does a
// support that is gone. Asked at the exact settings alone: soft contacts leave larger overlaps than this prevents.
bool isWatched(const StepStore& step, const Island& island, double time) {
  if (!step.solver.exact || !island.exact || island.bodies.empty() || island.time >= time) return false;
  const auto mayDeviate = [&](Index i) { return step.supported[i] || !step.load[i].torque_W.isZero(0.0); };
  return !island.flies() || !step.load_without_drag.empty() ||
         std::any_of(island.bodies.begin(), island.bodies.end(), mayDeviate);
}

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
        contacts_(context.scene.contacts),
        found_(contacts_.active.size()),
        has_edge_(found_, 0),
        order_(byPlace(context.scene.pair_search.order, step_.bounds)),
        tree_(order_, step_.bounds),
        sets_(islands::candidateSets(context)) {
    // Cutting an island with contacts costs a solve of all its pairs. What an attempt at the step may spend on cuts is a few
    // times what it spends anyway, so that a large pile hit from all sides stays affordable. What comes after
    // is the contact solver's, which stops it and lets it rebound at the end of the step. Each set of bodies
    // that may meet has its own budget: what it does cannot depend on others.
    cut_budget_.assign(step_.island.size(), 256);
    for (const Contact& contact : contacts_.active)
      cut_budget_[sets_.root(movedOf(contact.i, contact.j))] += 4;
    // Bouncing in a tight place: far more than any scene of 60 Hz needs, and finite.
    // Without loss a pair may meet as often as it likes (the billiard of pi: 314159 times).
    lossy_budget_ = 2000 + 200ull * context.scene.bodies.size();
    elastic_budget_ = 2'000'000;
    // Where there is no closed form, an impact costs up to a hundred times as much. A query takes about 5 us
    // and the rest of its impact as long as kQueriesPerImpact, so that those of a hundred bodies end within a
    // second. Heaps of 45 need up to 98,000 in a step of 1 s. An elastic body between walls that close needs
    // this end: its speed times their distance stays the same, so that it meets them without number.
    query_budget_ = 100'000 + 400ull * context.scene.bodies.size();
    struck_.assign(step_.island.size(), 0);
    for (const PendingImpact& impact : step_.impacts) {
      queue_.push(impact);
      struck_[movedOf(impact.i, impact.j)] = 1;
    }
    for (const Island& island : step_.islands)
      for (const Edge& edge : island.edges)
        if (edge.kind == ConstraintKind::Contact) has_edge_[edge.of] = 1;
  }

  void run() {
    takeAll();
    if (!step_.solver.exact) return lookAfterStruck();
    while (context_.scene.effects[Effect::Restitution] && advanceWatchedToEnd()) takeAll();
  }

 private:
  static constexpr std::uint64_t kQueriesPerImpact = 20;
  static constexpr std::size_t kSmall = 8;  // pairs of an island that is cut without a second thought

  void takeAll() {
    while (!queue_.empty()) {
      const PendingImpact impact = queue_.top();
      queue_.pop();
      if (step_.stamp[impact.i] != impact.stamp_i || step_.stamp[impact.j] != impact.stamp_j) continue;
      const bool lossy = impacts::losesEnergy(context_.scene, impact.i, impact.j);
      std::uint64_t& budget = lossy ? lossy_budget_ : elastic_budget_;
      if (budget == 0 || query_budget_ == 0) {
        overBudget(impact);
      } else {
        --budget;
        take(impact);
      }
    }
    // What other impacts have sent off its trajectory is not awaited any more.
    for (Index k = 0; k < contacts_.active.size(); ++k)
      if (contacts_.active[k].state.awaitsImpact())
        separateOrConnect(contacts_.active[k].i, contacts_.active[k].j);
  }

  struct Later {
    bool operator()(const PendingImpact& a, const PendingImpact& b) const {
      return std::tie(a.time, a.i, a.j) > std::tie(b.time, b.i, b.j);
    }
  };

  // The last impact of a pair, how many came in quick succession before it, and how many in the step.
  struct ImpactCounts {
    double last = 0.0;
    int count = 0, all = 0;
  };

  // Of two bodies of which forces move one at least: the first that they move.
  Index movedOf(Index i, Index j) const { return step_.island[i] != kNone ? i : j; }
  // The island that counts an impact.
  Island& islandOf(const PendingImpact& impact) { return *islandOf(movedOf(impact.i, impact.j)); }
  Island* islandOf(Index i) { return step_.island[i] == kNone ? nullptr : &step_.islands[step_.island[i]]; }

  // Of the set of both bodies. An impact may have sent one into another set: they are one then.
  std::uint64_t& cutBudgetOf(const PendingImpact& impact) {
    Index a = sets_.root(movedOf(impact.i, impact.j)), b = sets_.root(movedOf(impact.j, impact.i));
    if (a > b) std::swap(a, b);
    if (a != b) sets_.unite(a, b), cut_budget_[a] += cut_budget_[b];
    return cut_budget_[a];
  }

  // Whether soft contacts stop a pair as well as an impact does: it does not rebound, and no sub-step takes one
  // far into the other. An open point may close no faster than its gap in a sub-step.
  bool isStoppedByContacts(const PendingImpact& impact) const {
    constexpr double kStoppedTravel = 0.25;  // in a sub-step, of the smaller length
    if (step_.solver.exact || context_.scene.restitutionOf(impact.i, impact.j) > 0.0) return false;
    const Bodies& bodies = context_.scene.bodies;
    const auto speedOf = [&](Index i) {
      const double turn = bodies.twist[i].w_WB.norm();
      const double fall = step_.h() * step_.load[i].a_W.norm();
      return bodies.twist[i].v_WB.norm() + fall +
             (turn > 0.0 ? turn * bodies.traits[i].bounding_radius : 0.0);
    };
    const double travel = (speedOf(impact.i) + speedOf(impact.j)) * step_.h() / step_.solver.sub_steps;
    return travel <= kStoppedTravel * smallerLength(bodies, impact.i, impact.j);
  }

  // A sleeper that comes into play is a wall here. The step is to begin again with it awake.
  void noteSleeper(Index i, Index j) {
    const std::vector<Traits>& traits = context_.scene.bodies.traits;
    for (const Index one : {i, j})
      if (traits[one].asleep) step_.disturbed.push_back(one);
  }

  enum class Brought {
    Both,       ///< both are where the impact is
    Early,      ///< something else comes first: the impact is awaited again
    Expensive,  ///< the budget does not allow it
  };

  // Brings both islands to the impact if the budget allows it, unless their contacts bring others together before.
  Brought advanceBoth(const PendingImpact& impact) {
    std::uint64_t cost = 0;
    for (const Island* island : {islandOf(impact.i), islandOf(impact.j)})
      if (island && island->time < impact.time && island->edges.size() > kSmall) cost += island->edges.size();
    if (cost > 0 && isStoppedByContacts(impact)) return Brought::Expensive;
    std::uint64_t& budget = cutBudgetOf(impact);
    if (cost > budget) return Brought::Expensive;
    budget -= cost;
    std::vector<Index> brought;  // islands
    bool watched = false;
    for (const Index i : {impact.i, impact.j}) {
      const Index place = step_.island[i];
      if (place == kNone || (!brought.empty() && brought.front() == place)) continue;
      brought.push_back(place);
      watched = watched || isWatched(step_, step_.islands[place], impact.time);
    }
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

  // Whether contacts have brought a pair together too often in the step: then one of theirs is to keep the two apart.
  bool isPushedTogether(Index i, Index j) const {
    constexpr int kMostEarly = 4;  // a steady approach takes one
    const auto known = early_.find({i, j});
    return known != early_.end() && known->second >= kMostEarly;
  }

  void queueEarly(const PendingImpact& early) {
    ++early_[{early.i, early.j}];
    queue_.push(early);
  }

  // Brings what is watched to the end of the step, a set of bodies that may meet at a time, as far as the budget allows.
  // Whether contacts bring some together before that rebound; others are for the search after the step
  // (missed_contacts.h), which makes contacts of them.
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
    for (const auto& [root, islands] : sets) {
      std::uint64_t cost = 0;
      for (const Index place : islands)
        if (step_.islands[place].edges.size() > kSmall) cost += step_.islands[place].edges.size();
      if (cost > cut_budget_[root]) continue;
      cut_budget_[root] -= cost;
      const auto early = advanceUnlessEarly(context_, islands, step_.t1, rebounding);
      if (early) queueEarly(*early), found = true;
    }
    return found;
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
      const Index contact = contacts_.find(a, b, found_);
      if (contact != kNone) {
        const PairState& state = contacts_.active[contact].state;
        // A contact that came to await an impact has an edge, and is left out of the solve.
        if (state.isDepenetrating() || (state.isSolved() && contact < has_edge_.size() && has_edge_[contact]))
          return;
      }
      if (!isPushedTogether(a, b)) found.push_back(j);
    };
    for (const Index j : tree_.of(i)) add(j);
    for (const Index j : context_.scene.lists.planes) add(j);
    return found;
  }

  void take(const PendingImpact& impact) {
    noteSleeper(impact.i, impact.j);
    const Brought brought = advanceBoth(impact);
    if (brought == Brought::Early) return;
    if (brought == Brought::Expensive || isCollapsing(impact) || isPushedTogether(impact.i, impact.j)) {
      ++islandOf(impact).deferred_impacts;
      if (brought == Brought::Expensive) leaveToRebounds(impact);
      leaveToContacts(impact.i, impact.j);
      return;
    }
    const impacts::Outcome outcome = impacts::resolve(context_, contactOf(impact), impact.time);
    if (outcome == impacts::Outcome::Miss) {
      const auto later = predict(impact.i, impact.j, impact.time).impact;
      if (later && later->time > impact.time) {
        queue_.push(*later);
      } else {
        connect(impact.i, impact.j, false);
      }
      return;
    }
    ++islandOf(impact).impacts;
    step_.impacted.emplace_back(impact.i, impact.j);
    if (outcome == impacts::Outcome::Stay) leaveToContacts(impact.i, impact.j);
    const std::uint64_t before = query_budget_;
    for (const Index i : {impact.i, impact.j}) {
      if (step_.island[i] == kNone) continue;  // no impact changes the trajectory of a body in no island
      ++step_.stamp[i];
      step_.last_impact[i] = {impact.time, context_.scene.bodies.pose[i]};
      queryNeighbours(i);
    }
    if (query_budget_ < before) charge(kQueriesPerImpact);
  }

  // Of the two methods only the soft one lets contacts rebound.
  void leaveToRebounds(const PendingImpact& impact) {
    if (step_.solver.exact || context_.scene.restitutionOf(impact.i, impact.j) == 0.0) return;
    for (Island* island : {islandOf(impact.i), islandOf(impact.j)})
      if (island) island->exact = false;
  }

  // Inelastic collapse: a pair that loses energy in each impact and meets again and again with hardly any
  // time in between, as happens between bodies that touch others, would go on forever; so, nearly, would one
  // that rattles to rest in a thousand small impacts. A pair without loss never collapses, however often it
  // meets (the billiard that counts the digits of pi meets 314159 times).
  bool isCollapsing(const PendingImpact& impact) {
    constexpr int kQuickImpacts = 6, kMostImpacts = 1000;
    if (!impacts::losesEnergy(context_.scene, impact.i, impact.j)) return false;
    ImpactCounts& met = impact_counts_[{impact.i, impact.j}];
    if (impact.time - met.last > step_.solver.collapse_interval * step_.h()) met.count = 0;
    met.last = impact.time;
    return ++met.count > kQuickImpacts || ++met.all > kMostImpacts;
  }

  // Leaves a pair that touches, or may touch, to the contact solver for the rest of the step and makes one
  // island of the two.
  void connect(Index i, Index j, bool touches = true) {
    assert(step_.island[movedOf(i, j)] != kNone);
    noteSleeper(i, j);
    const Index contact = placeOf(i, j);
    PairState& state = contacts_.active[contact].state;
    touches ? state.touch() : state.open();
    Index a = step_.island[i], b = step_.island[j];
    if (a == kNone) std::swap(a, b);
    if (b != kNone && a != b) {
      const double time = std::max(step_.islands[a].time, step_.islands[b].time);
      for (const Index k : {std::min(a, b), std::max(a, b)}) advanceTo(context_, step_.islands[k], time);
      a = islands::merge(context_, a, b);
    }
    Island& island = step_.islands[a];
    island.touching = island.touching || touches;
    has_edge_.resize(contacts_.active.size(), 0);
    if (!has_edge_[contact]) {
      has_edge_[contact] = 1;
      if (island.time > step_.t0 && overlapDeeply(context_, i, j, island.time))
        step_.overlapping.emplace_back(i, j);
      island.edges.push_back(islands::edgeOf(contacts_, contact));
    }
  }

  // A pair that does not touch and has no pending impact: the contact solver's business if their trajectories are not known.
  void separateOrConnect(Index i, Index j) {
    if (impacts::isFree(context_, i) && impacts::isFree(context_, j)) {
      contacts_.active[placeOf(i, j)].state.separate();
    } else {
      connect(i, j, false);
    }
  }

  // Of the sets that had impacts; others go through the step as they do where no other set has one.
  void lookAfterStruck() {
    for (const Island& island : step_.islands)  // impacts may have made one of bodies of several sets
      for (const Index i : island.bodies) sets_.unite(island.bodies.front(), i);
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
  }

  // Contacts may push every body of a set in which something touches off its predicted motion. So what that motion
  // would not have met is left to the contact solver as well. At the exact settings the search afterwards is enough
  // (missed_contacts.h): there a point more costs more than a step taken again.
  template <class IsStruck>
  void watchSeparated(const IsStruck& isStruck) {
    std::vector<char> touches(step_.island.size(), 0);  // by root of a set
    for (const Island& island : step_.islands)
      if (island.touching && isStruck(island)) touches[sets_.root(island.bodies.front())] = 1;
    for (Index k = 0; k < contacts_.active.size(); ++k) {
      const Contact& contact = contacts_.active[k];
      const Index i = contact.i, j = contact.j;
      if (contact.state.isSeparated() && touches[sets_.root(movedOf(i, j))]) connect(i, j, false);
    }
  }

  // A pair that touches. What a new contact may push the two against is looked at with it: a light body that rattles between two
  // others leaves the one in the moment in which the other stays on it.
  void leaveToContacts(Index i, Index j) {
    connect(i, j);
    for (const Index k : {i, j}) watchAround(k);
    promoteCrushed(*islandOf(movedOf(i, j)));
  }

  // Of a body that forces move: nothing pushes others.
  void watchAround(Index i) {
    if (step_.solver.exact || step_.island[i] == kNone || !tree_.holds(i)) return;
    std::vector<Index> others = tree_.of(i);
    const std::vector<Index>& planes = context_.scene.lists.planes;
    others.insert(others.end(), planes.begin(), planes.end());
    for (const Index j : others) {
      const auto [a, b] = std::minmax(i, j);
      const Index contact = contacts_.find(a, b, found_);
      const bool is_left = contact == kNone
                               ? impact_counts_.count({a, b}) > 0  // too far apart when the step began
                               : contacts_.active[contact].state.isSeparated();
      if (is_left) connect(a, b, false);
    }
  }

  void promoteCrushed(Island& island) {
    if (!island.cut_short && !island.flies() && isCrushing(context_, island)) island.exact = true;
  }

  // The place of a contact; it is added where it is not there.
  Index placeOf(Index i, Index j) {
    const Index known = contacts_.find(i, j, found_);
    return known != kNone ? known : contacts_.add(context_.scene.bodies, i, j);
  }

  // Where the impulses of an impact are kept. It may be one of a pair that was too far apart for a contact
  // when the step began.
  Contact& contactOf(const PendingImpact& impact) {
    const Index known = contacts_.find(impact.i, impact.j, found_);
    return known != kNone ? contacts_.active[known]
                          : contacts_.dormantOf(context_.scene.bodies, impact.i, impact.j);
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
    charge(prediction.queries);
    return prediction;
  }
  void charge(std::uint64_t queries) { query_budget_ -= std::min(query_budget_, queries); }

  void consider(Index i, Index j, double from) {
    if (!mayCollide(context_.scene.bodies.traits[i], context_.scene.bodies.traits[j])) return;
    if (step_.isCrowded(i) && step_.isCrowded(j)) return;  // as in impacts::predict()
    const Index place = contacts_.find(std::min(i, j), std::max(i, j), found_);
    PairState* const state = place == kNone ? nullptr : &contacts_.active[place].state;
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
      prediction.touches ? connect(a, b, false) : separateOrConnect(a, b);
    }
  }

  // Past the budget of impacts the contact solver stops what would pass through.
  void overBudget(const PendingImpact& impact) {
    for (Island* island : {islandOf(impact.i), islandOf(impact.j)})
      if (island) advanceTo(context_, *island, impact.time);
    leaveToContacts(impact.i, impact.j);
    if (warned_.insert(sets_.root(movedOf(impact.i, impact.j))).second) {
      islandOf(impact).warnings.push_back(
          {"impact_budget", "too many impacts in one step, the first left over between bodies '" +
                                context_.scene.bodies.name[impact.i] + "' and '" +
                                context_.scene.bodies.name[impact.j] +
                                "'; the rest lose their rebound. Use a shorter step"});
    }
  }

  Context& context_;
  StepStore& step_;
  Contacts& contacts_;
  std::size_t found_;           // pairs of the broad phase; later ones are not sorted
  std::vector<char> has_edge_;  // by contact: it is a constraint of the island of its bodies
  std::vector<Index> order_;
  BoundsTree tree_;
  DisjointSets sets_;                      // of bodies that may meet
  std::vector<std::uint64_t> cut_budget_;  // by body: of its set, where it is the root
  std::vector<char> struck_;               // by body: an impact of its own was predicted when the step began
  std::uint64_t lossy_budget_, elastic_budget_, query_budget_;
  std::priority_queue<PendingImpact, std::vector<PendingImpact>, Later> queue_;
  std::map<std::pair<Index, Index>, ImpactCounts> impact_counts_;
  std::map<std::pair<Index, Index>, int> early_;  // how often a pair came before its time
  std::set<Index> warned_;                        // roots of sets whose impacts went over a budget
};

}  // namespace

void takeImpacts(Context& context) {
  const StepStore& step = context.step;
  const auto rebounds = [&](const Island& island) { return isWatched(step, island, step.t1); };
  if (!step.impacts.empty() || (context.scene.effects[Effect::Restitution] &&
                                std::any_of(step.islands.begin(), step.islands.end(), rebounds)))
    ImpactLoop(context).run();
}

}  // namespace rbs
