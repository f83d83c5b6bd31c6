// SPDX-License-Identifier: BSD-3-Clause
#include "solver/pass_regions.h"

#include <algorithm>
#include <thread>

namespace rbs {

namespace {

constexpr std::size_t kFewPairs = 256;  // of a region, below which a pass is over sooner on one thread
// What a pair of two regions costs, in points: the velocities of a body go from one cache to another.
constexpr double kCrossing = 4.0;
constexpr double kWorthIt = 0.8;  // share of the time of one thread that sharing may take
constexpr int kSpins = 300;       // some microseconds

}  // namespace

// Along each axis the bodies are cut into equal numbers. The time of a pass is estimated as if all met after each level:
// the sum over the levels of the points of the largest region.
void PassRegions::split(const SolverContacts& contacts, const std::vector<Index>& level, unsigned threads) {
  const std::size_t bodies = contacts.bodies.size();
  const std::size_t count = std::min<std::size_t>(threads, contacts.blocks.size() / kFewPairs);
  of_body_.clear();
  bodies_.resize(1);
  if (count < 2) return;

  Index levels = 0;
  double all = 0.0;
  for (std::size_t k = 0; k < level.size(); ++k)
    if (level[k] != kNone) levels = std::max(levels, level[k] + 1), all += contacts.blocks[k].size;
  std::vector<std::size_t> now(bodies, 0);
  std::vector<double> places, sorted, load;
  double least = kWorthIt * all;
  for (int axis = 0; axis < 3; ++axis) {
    places.clear();
    for (const SolverBody& s : contacts.bodies) places.push_back(contacts.position(s)[axis]);
    sorted.clear();
    for (std::size_t s = 0; s < bodies; ++s)
      if (contacts.bodies[s].inv_mass > 0.0) sorted.push_back(places[s]);
    std::vector<double> cuts;
    for (std::size_t r = 1; r < count; ++r) {
      const auto cut = sorted.begin() + static_cast<std::ptrdiff_t>(r * sorted.size() / count);
      std::nth_element(sorted.begin(), cut, sorted.end());
      cuts.push_back(*cut);
    }
    for (std::size_t s = 0; s < bodies; ++s)
      now[s] = static_cast<std::size_t>(std::upper_bound(cuts.begin(), cuts.end(), places[s]) - cuts.begin());
    load.assign(levels * count, 0.0);
    double time = 0.0;
    for (std::size_t k = 0; k < level.size(); ++k) {
      if (level[k] == kNone) continue;
      const SolverBlock& block = contacts.blocks[k];
      const bool i_moves = contacts.bodies[block.i].inv_mass > 0.0;
      const bool both = i_moves && contacts.bodies[block.j].inv_mass > 0.0;
      load[level[k] * count + now[i_moves ? block.i : block.j]] += block.size;
      if (both && now[block.i] != now[block.j]) time += kCrossing;
    }
    for (Index l = 0; l < levels; ++l)
      time += *std::max_element(load.begin() + static_cast<std::ptrdiff_t>(l * count),
                                load.begin() + static_cast<std::ptrdiff_t>((l + 1) * count));
    if (time < least) least = time, of_body_ = now;
  }
  if (of_body_.empty()) return;
  bodies_.resize(count);
  for (std::vector<Index>& list : bodies_) list.clear();
  for (std::size_t s = 0; s < bodies; ++s) bodies_[of_body_[s]].push_back(static_cast<Index>(s));
}

std::size_t PassRegions::of(const SolverContacts& contacts, const SolverBlock& block) const {
  if (of_body_.empty()) return 0;
  return of_body_[contacts.bodies[block.i].inv_mass > 0.0 ? block.i : block.j];
}

void PassRegions::setBundles(const std::vector<std::size_t>& first) {
  first_ = first;
  regions_.resize(count());
  for (Region& region : regions_) {
    region.waits.clear();
    region.stretches.clear();
    region.known.assign(count(), 0);
  }
  awaited_.assign(first.back(), 0);
  if (room_ < count()) progress_ = std::make_unique<Progress[]>(count()), room_ = count();
}

std::size_t PassRegions::regionOf(std::size_t bundle) const {
  return static_cast<std::size_t>(std::upper_bound(first_.begin(), first_.end(), bundle) - first_.begin()) -
         1;
}

void PassRegions::need(std::size_t bundle, std::size_t before) {
  Region& region = regions_[regionOf(bundle)];
  const std::size_t other = regionOf(before);
  const auto done = static_cast<std::uint32_t>(before - first_[other] + 1);
  if (&regions_[other] == &region || region.known[other] >= done) return;
  region.known[other] = done;
  region.waits.push_back({bundle, other, done});
  awaited_[before] = 1;
}

void PassRegions::finish() {
  for (std::size_t r = 0; r < count(); ++r) {
    Region& region = regions_[r];
    std::size_t wait = 0;
    for (std::size_t b = first_[r]; b < first_[r + 1];) {
      Stretch stretch{b, b, wait, wait};
      while (stretch.last_wait < region.waits.size() && region.waits[stretch.last_wait].bundle == b)
        ++stretch.last_wait;
      wait = stretch.last_wait;
      const std::size_t next = wait < region.waits.size() ? region.waits[wait].bundle : first_[r + 1];
      while (b < next && !awaited_[b++]) {
      }
      stretch.end = b;
      region.stretches.push_back(stretch);
    }
  }
}

bool PassRegions::isComplete(std::size_t region) const {
  return progress_[region].done.load(std::memory_order_acquire) == first_[region + 1] - first_[region];
}

bool PassRegions::isReady(const Region& region, const Stretch& stretch) const {
  for (std::size_t k = stretch.first_wait; k < stretch.last_wait; ++k)
    if (progress_[region.waits[k].region].done.load(std::memory_order_acquire) < region.waits[k].done)
      return false;
  return true;
}

// Does the bundles of a region until one has to wait for long. Whether it did any. Only the thread that has taken a region
// writes its progress.
bool PassRegions::solveReady(std::size_t r, const Body& body) {
  const Region& region = regions_[r];
  Progress& progress = progress_[r];
  const std::size_t first = progress.next;
  for (; progress.next < region.stretches.size(); ++progress.next) {
    const Stretch& stretch = region.stretches[progress.next];
    for (int k = 0; !isReady(region, stretch); ++k) {
      if (k == kSpins) return progress.next > first;
      Workers::relax();
    }
    body(stretch.begin, stretch.end);
    progress.done.store(static_cast<std::uint32_t>(stretch.end - first_[r]), std::memory_order_release);
  }
  return true;
}

void PassRegions::takeRegions(const Body& body) {
  std::size_t complete = 0;  // regions in a row
  int idle = 0;
  for (std::size_t k = Workers::self(); complete < count() && !failed_; ++k) {
    const std::size_t r = k % count();
    complete = isComplete(r) ? complete + 1 : 0;
    if (complete > 0) continue;
    std::atomic<bool>& taken = progress_[r].taken;
    if (taken.load(std::memory_order_relaxed) || taken.exchange(true, std::memory_order_acquire)) {
      ++idle < kSpins ? Workers::relax() : std::this_thread::yield();
      continue;
    }
    try {
      const bool went_on = solveReady(r, body);
      taken.store(false, std::memory_order_release);
      if (!went_on) std::this_thread::yield();
    } catch (...) {
      failed_ = true;
      throw;
    }
  }
}

void PassRegions::inOrder(Workers& workers, const Body& body) {
  for (std::size_t r = 0; r < count(); ++r)
    progress_[r].done = 0, progress_[r].next = 0, progress_[r].taken = false;
  failed_ = false;
  workers.share(count(), 1, [&](auto, auto, auto) { takeRegions(body); });
}

void PassRegions::each(Workers& workers, const std::function<void(std::size_t region)>& body) {
  for (std::size_t r = 0; r < count(); ++r) progress_[r].taken = false;
  workers.share(count(), 1, [&](auto, auto, auto) {
    for (std::size_t k = 0; k < count(); ++k)
      if (const std::size_t r = (Workers::self() + k) % count(); !progress_[r].taken.exchange(true))
        return body(r);
  });
  for (std::size_t r = 0; r < count(); ++r) progress_[r].taken = false;
}

}  // namespace rbs
