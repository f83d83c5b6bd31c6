// SPDX-License-Identifier: BSD-3-Clause
#include "run_comparison.h"

#include <algorithm>

namespace rbs {

void RunComparison::addLive(const Snapshot& live) {
  std::lock_guard<std::mutex> lock(mutex_);
  if (live.edits != edits_) {
    edits_ = live.edits;
    next_ = 0;
    live_.clear();
    newest_.reset();
  }
  if (live.steps < next_) return;
  next_ = live.steps + 1;
  Moment& moment = live_.emplace_back();
  moment.steps = live.steps;
  for (const BodyState& state : live.states) moment.places.push_back(state.pose.p_WB);
  thinOut();
}

// At most 12 MB, and two moments however many bodies there are.
void RunComparison::thinOut() {
  constexpr std::size_t kMostMoments = 256, kMostPlaces = 500000;
  const std::size_t bodies = std::max<std::size_t>(1, live_.back().places.size());
  const std::size_t most = std::clamp<std::size_t>(kMostPlaces / bodies, 2, kMostMoments);
  if (live_.size() <= most) return;
  std::size_t kept = 0;
  for (std::size_t k = live_.size() % 2 == 0 ? 1 : 0; k < live_.size(); k += 2, ++kept)
    if (k != kept) std::swap(live_[kept], live_[k]);
  live_.resize(kept);
}

bool RunComparison::wants(std::uint64_t steps, std::uint64_t edits) const {
  std::lock_guard<std::mutex> lock(mutex_);
  return edits == edits_ && std::any_of(live_.begin(), live_.end(),
                                        [steps](const Moment& moment) { return moment.steps == steps; });
}

void RunComparison::compare(const Snapshot& reference, std::uint64_t edits) {
  std::lock_guard<std::mutex> lock(mutex_);
  if (edits != edits_) return;
  while (!live_.empty() && live_.front().steps < reference.steps) live_.pop_front();
  if (live_.empty() || live_.front().steps != reference.steps) return;
  const std::vector<Vec3>& places = live_.front().places;
  auto distances = std::make_shared<Distances>();
  distances->time = reference.time;
  for (std::size_t k = 0; k < std::min(places.size(), reference.states.size()); ++k)
    distances->of_bodies.push_back((places[k] - reference.states[k].pose.p_WB).norm());
  newest_ = std::move(distances);
  live_.pop_front();
}

std::shared_ptr<const RunComparison::Distances> RunComparison::newest() const {
  std::lock_guard<std::mutex> lock(mutex_);
  return newest_;
}

void RunComparison::clear() {
  std::lock_guard<std::mutex> lock(mutex_);
  next_ = 0;
  live_.clear();
  newest_.reset();
}

}  // namespace rbs
