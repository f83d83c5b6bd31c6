// SPDX-License-Identifier: BSD-3-Clause
#include "timeline.h"

#include "convert.h"

#include <algorithm>
#include <utility>

namespace rbs {
namespace {

// On the wall clock, others ask tf for where bodies are now, also while they rest: how old the last answer
// may be.
const ros::Duration kOldest(0.1);

}  // namespace

Timeline::Timeline(bool wall) : wall_(wall), stamp_(wireStamp(0.0)) {}

Timeline::Moment Timeline::advance(const Simulator& simulator, bool again) {
  std::lock_guard<std::mutex> lock(mutex_);
  Moment moment;
  moment.snapshot = simulator.snapshot();
  const Snapshot& snapshot = *moment.snapshot;
  const ros::Time now = wall_ ? ros::Time::now() : wireStamp(snapshot.elapsed);
  moment.changed = again || repeats_ || snapshot.elapsed != elapsed_ || snapshot.edits != edits_ ||
                   (wall_ && now - stamp_ >= kOldest);
  if (moment.changed) stamp_ = std::max(now, stamp_ + ros::Duration(0, 1));
  repeats_ = false;
  elapsed_ = snapshot.elapsed;
  edits_ = snapshot.edits;
  moment.stamp = stamp_;
  moment.replacements = std::exchange(replacements_, {});
  return moment;
}

ros::Time Timeline::stamp() const {
  std::lock_guard<std::mutex> lock(mutex_);
  return stamp_;
}

void Timeline::repeat() {
  std::lock_guard<std::mutex> lock(mutex_);
  repeats_ = true;
}

void Timeline::note(Replacement replacement) {
  std::lock_guard<std::mutex> lock(mutex_);
  replacements_.push_back(std::move(replacement));
}

}  // namespace rbs
