// SPDX-License-Identifier: BSD-3-Clause
#include "impact_loop.h"

#include "broadphase/bounds.h"
#include "broadphase/neighbourhood.h"
#include "broadphase/sweep_and_prune.h"
#include "fidelity.h"
#include "impacts.h"
#include "islands.h"
#include "overlaps.h"
#include "residuals.h"

#include <algorithm>
#include <map>
#include <queue>
#include <tuple>

namespace rbs {

namespace {

// Goes through the impacts of a step in the order of their times.
class ImpactLoop {
 public:
  explicit ImpactLoop(Context& context)
      : context_(context),
        step_(context.step),
        found_(step_.contacts.pairs.size()),
        neighbourhood_(context.scene.sweep.order, step_.bounds) {
    const std::uint64_t pairs = step_.contacts.pairs.size();
    // Cutting an island with contacts costs a solve of all its pairs. What a step may spend on cuts is a few
    // times what it spends anyway, so that a large pile hit from all sides stays affordable. What comes after
    // is the contact solver's, which stops it and lets it rebound at the end of the step.
    cut_budget_ = 4 * pairs + 256;
    // Bouncing in a tight place: far more than any scene of 60 Hz needs, and finite.
    // Without loss a pair may meet as often as it likes (the billiard of pi: 314159 times); this many take
    // seconds.
    lossy_budget_ = 20000 + 200ull * context.scene.bodies.size();
    elastic_budget_ = 2'000'000;
    for (const PendingImpact& impact : step_.impacts) queue_.push(impact);
  }

  void run() {
    while (!queue_.empty()) {
      const PendingImpact impact = queue_.top();
      queue_.pop();
      if (step_.stamp[impact.i] != impact.stamp_i || step_.stamp[impact.j] != impact.stamp_j) continue;
      const bool lossy = context_.scene.restitutionOf(impact.i, impact.j) < 1.0;
      std::uint64_t& budget = lossy ? lossy_budget_ : elastic_budget_;
      if (budget == 0) {
        overBudget(impact);
      } else {
        --budget;
        take(impact);
      }
    }
    // What other impacts have sent off its course is not awaited any more.
    for (Index k = 0; k < step_.contacts.pairs.size(); ++k)
      if (step_.standing[k] == Standing::Awaited)
        dismiss(step_.contacts.pairs[k].i, step_.contacts.pairs[k].j, false);
  }

 private:
  struct Later {
    bool operator()(const PendingImpact& a, const PendingImpact& b) const {
      return std::tie(a.time, a.i, a.j) > std::tie(b.time, b.i, b.j);
    }
  };

  // The last impacts of a pair, and how many came in quick succession.
  struct Meetings {
    double last = 0.0;
    int count = 0;
  };

  Island* islandOf(Index i) { return step_.island[i] == kNone ? nullptr : &step_.islands[step_.island[i]]; }

  // Brings both islands to the impact if the budget allows it.
  bool bringBoth(const PendingImpact& impact) {
    constexpr std::size_t kSmall = 8;  // pairs of an island that is cut without a second thought
    std::uint64_t cost = 0;
    for (const Island* island : {islandOf(impact.i), islandOf(impact.j)})
      if (island && island->time < impact.time && island->pairs.size() > kSmall) cost += island->pairs.size();
    if (cost > cut_budget_) return false;
    cut_budget_ -= cost;
    for (Island* island : {islandOf(impact.i), islandOf(impact.j)})
      if (island) islands::bringTo(context_, *island, impact.time);
    return true;
  }

  void take(const PendingImpact& impact) {
    if (!bringBoth(impact) || isCollapsing(impact)) {
      ++step_.report.deferred_impacts;
      tie(impact.i, impact.j);
      return;
    }
    const impacts::Outcome outcome = impacts::resolve(context_, impact.i, impact.j, impact.time);
    if (outcome == impacts::Outcome::Miss) {
      const auto later = impacts::predict(context_, impact.i, impact.j, impact.time).impact;
      if (later && later->time > impact.time) {
        queue_.push(*later);
      } else {
        tie(impact.i, impact.j);
      }
      return;
    }
    ++step_.report.impacts;
    if (outcome == impacts::Outcome::Stay) tie(impact.i, impact.j);
    for (const Index i : {impact.i, impact.j}) {
      if (step_.island[i] == kNone) continue;  // no impact changes the course of a body that is no mover
      ++step_.stamp[i];
      lookAround(i);
    }
  }

  // Inelastic collapse: a pair that loses energy in each impact and meets again and again with hardly any
  // time in between, as happens between bodies that touch others, would go on forever. An elastic pair never
  // collapses, however often it meets (the billiard that counts the digits of pi meets 314159 times).
  bool isCollapsing(const PendingImpact& impact) {
    constexpr int kMeetings = 6;
    if (context_.scene.restitutionOf(impact.i, impact.j) >= 1.0) return false;
    Meetings& met = meetings_[{impact.i, impact.j}];
    if (impact.time - met.last > settingsOf(context_.scene.settings.fidelity).no_time * step_.h())
      met.count = 0;
    met.last = impact.time;
    return ++met.count > kMeetings;
  }

  // Leaves a pair that touches, or may touch, to the contact solver for the rest of the step and makes one
  // island of the two.
  void tie(Index i, Index j, Standing standing = Standing::Contact) {
    const Index pair = pairOf(i, j);
    step_.standing[pair] = standing;
    Index a = step_.island[i], b = step_.island[j];
    if (a == kNone) std::swap(a, b);
    if (b != kNone && a != b) {
      if (a > b) std::swap(a, b);
      Island& kept = step_.islands[a];
      Island& gone = step_.islands[b];
      const double time = std::max(kept.time, gone.time);
      islands::bringTo(context_, kept, time);
      islands::bringTo(context_, gone, time);
      for (const Index body : gone.bodies) step_.island[body] = a;
      // A body that flew joins the method of what it met; of two methods the one that any number of rows can
      // afford.
      const bool exact = settingsOf(context_.scene.settings.fidelity).exact
                             ? kept.exact && gone.exact
                             : (kept.exact || kept.pairs.empty()) && (gone.exact || gone.pairs.empty()) &&
                                   (kept.exact || gone.exact);
      kept.exact = exact;
      residuals::add(kept.residuals, gone.residuals);
      kept.bodies.insert(kept.bodies.end(), gone.bodies.begin(), gone.bodies.end());
      kept.pairs.insert(kept.pairs.end(), gone.pairs.begin(), gone.pairs.end());
      kept.contact = kept.contact || gone.contact;
      gone.bodies.clear();
      gone.pairs.clear();
    }
    if (standing == Standing::Contact) step_.islands[a].contact = true;
    std::vector<Index>& pairs = step_.islands[a].pairs;
    if (std::find(pairs.begin(), pairs.end(), pair) == pairs.end()) pairs.push_back(pair);
  }

  // A pair without a pending impact: the contact solver's business if they touch or their courses are not
  // known.
  void dismiss(Index i, Index j, bool touches) {
    if (!touches && impacts::isFree(context_, i) && impacts::isFree(context_, j)) {
      step_.standing[pairOf(i, j)] = Standing::Apart;
    } else {
      tie(i, j, Standing::Open);
    }
  }

  // The place of a pair in the list: searched for among the pairs of the broad phase, which are sorted, then
  // among those added since; added if it is in neither.
  Index pairOf(Index i, Index j) {
    std::vector<ContactPair>& pairs = step_.contacts.pairs;
    const Index known = findPair(i, j);
    if (known != kNone) return known;
    ContactPair pair;
    pair.i = i, pair.j = j;
    pair.id_i = context_.scene.bodies.id[i], pair.id_j = context_.scene.bodies.id[j];
    pairs.push_back(pair);
    step_.standing.push_back(Standing::Open);
    return static_cast<Index>(pairs.size() - 1);
  }

  Index findPair(Index i, Index j) const {
    const std::vector<ContactPair>& pairs = step_.contacts.pairs;
    const auto end = pairs.begin() + static_cast<std::ptrdiff_t>(found_);
    const auto key = std::pair(i, j);
    const auto it = std::lower_bound(pairs.begin(), end, key,
                                     [](const ContactPair& pair, const std::pair<Index, Index>& k) {
                                       return std::pair(pair.i, pair.j) < k;
                                     });
    if (it != end && std::pair(it->i, it->j) == key) return static_cast<Index>(it - pairs.begin());
    for (std::size_t k = found_; k < pairs.size(); ++k)
      if (pairs[k].i == i && pairs[k].j == j) return static_cast<Index>(k);
    return kNone;
  }

  // Finds what body i will meet on its new course.
  void lookAround(Index i) {
    const Bodies& bodies = context_.scene.bodies;
    const double from = step_.timeOf(i);
    neighbourhood_.move(i, sweptBounds(bodies, step_.load[i], i, step_.t1 - from));
    for (const Index j : neighbourhood_.of(i)) consider(i, j, from);
    for (const Index j : context_.scene.rosters.planes) consider(i, j, from);
  }

  void consider(Index i, Index j, double from) {
    if (!sweep_and_prune::mayCollide(context_.scene.bodies.traits[i], context_.scene.bodies.traits[j]))
      return;
    if (step_.isCrowded(i) && step_.isCrowded(j)) return;  // as in impacts::find()
    const Index pair = findPair(std::min(i, j), std::max(i, j));
    const Standing standing = pair == kNone ? Standing::Open : step_.standing[pair];
    if (standing == Standing::Parting) return;
    if (standing == Standing::Contact && context_.scene.restitutionOf(i, j) == 0.0) return;
    const impacts::Outlook outlook = impacts::predict(context_, i, j, std::max(from, step_.timeOf(j)));
    if (outlook.impact) {
      queue_.push(*outlook.impact);
      if (pair != kNone) step_.standing[pair] = Standing::Awaited;
    } else if (standing == Standing::Awaited || (standing == Standing::Apart && outlook.touches)) {
      dismiss(std::min(i, j), std::max(i, j), outlook.touches);  // what it waited for will not come
    }
  }

  // Past the budget of impacts the contact solver stops what would pass through.
  void overBudget(const PendingImpact& impact) {
    for (Island* island : {islandOf(impact.i), islandOf(impact.j)})
      if (island) islands::bringTo(context_, *island, impact.time);
    tie(impact.i, impact.j);
    if (!warned_) {
      step_.report.warnings.push_back(
          {"impact_budget", "too many impacts in one step, the first left over between bodies '" +
                                context_.scene.bodies.name[impact.i] + "' and '" +
                                context_.scene.bodies.name[impact.j] +
                                "'; the rest lose their rebound. Use a shorter step"});
      warned_ = true;
    }
  }

  Context& context_;
  StepStore& step_;
  std::size_t found_;  // pairs of the broad phase; later ones are not sorted
  Neighbourhood neighbourhood_;
  std::uint64_t cut_budget_, lossy_budget_, elastic_budget_;
  std::priority_queue<PendingImpact, std::vector<PendingImpact>, Later> queue_;
  std::map<std::pair<Index, Index>, Meetings> meetings_;
  bool warned_ = false;
};

}  // namespace

void takeImpacts(Context& context) {
  if (!context.step.impacts.empty()) ImpactLoop(context).run();
}

}  // namespace rbs
