// SPDX-License-Identifier: BSD-3-Clause
#include "timeline.h"

#include "convert.h"

#include <algorithm>

namespace rbs {

Timeline::Timeline(const Snapshot& first, bool wall)
    : wall_(wall), time_(first.time), edits_(first.edits), stamp_(wireStamp(0.0)) {}

Timeline::Moment Timeline::advance(const Simulator& simulator, bool again) {
  std::lock_guard<std::mutex> lock(mutex_);
  Moment moment;
  moment.snapshot = simulator.snapshot();
  moment.changed = again || moment.snapshot->time != time_ || moment.snapshot->edits != edits_;
  follow(*moment.snapshot);
  const ros::Time now = wall_ ? ros::Time::now() : wireStamp(elapsed_);
  stamp_ = std::max(now, moment.changed ? stamp_ + ros::Duration(0, 1) : stamp_);
  moment.stamp = stamp_;
  moment.replacements.swap(replacements_);
  return moment;
}

ros::Time Timeline::stamp() const {
  std::lock_guard<std::mutex> lock(mutex_);
  return stamp_;
}

void Timeline::replaceWorld(const Simulator& simulator, const Replacement& replacement,
                            const std::function<void()>& load) {
  std::lock_guard<std::mutex> lock(mutex_);
  follow(*simulator.snapshot());
  load();
  time_ = simulator.snapshot()->time;
  replacements_.push_back(replacement);
}

void Timeline::follow(const Snapshot& snapshot) {
  elapsed_ += std::max(0.0, snapshot.time - time_);
  time_ = snapshot.time;
  edits_ = snapshot.edits;
}

}  // namespace rbs
