// SPDX-License-Identifier: BSD-3-Clause
#include "trace.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rbs {

Trace::Bucket Trace::merged(const Bucket& a, const Bucket& b) {
  return {b.low.value < a.low.value ? b.low : a.low, b.high.value >= a.high.value ? b.high : a.high};
}

void Trace::append(const Bucket& bucket, std::vector<Sample>& samples) {
  samples.push_back(bucket.first());
  if (bucket.size() == 2) samples.push_back(bucket.last());
}

// A level that overflows hands its two oldest buckets, as one, to the next. The last level forgets.
void Trace::add(const Sample& sample) {
  if (!std::isfinite(sample.time) || !std::isfinite(sample.value)) return;
  if (!empty() && sample.time < end()) return;
  if (!empty() && sample.time == end()) levels_.front().pop_back();
  levels_.front().push_back({sample, sample});
  for (std::size_t k = 0; k < kLevels && levels_[k].size() > kCapacity + 1; ++k) {
    Level& level = levels_[k];
    if (k + 1 < kLevels) levels_[k + 1].push_back(merged(level[0], level[1]));
    level.erase(level.begin(), level.begin() + 2);
  }
}

double Trace::begin() const {
  for (auto level = levels_.rbegin(); level != levels_.rend(); ++level)
    if (!level->empty()) return level->front().first().time;
  return 0.0;
}

double Trace::end() const {
  return empty() ? 0.0 : levels_.front().back().last().time;
}

std::size_t Trace::size() const {
  std::size_t n = 0;
  for (const Level& level : levels_)
    for (const Bucket& bucket : level) n += bucket.size();
  return n;
}

std::vector<Sample> Trace::samples() const {
  const double infinity = std::numeric_limits<double>::infinity();
  return samples(-infinity, infinity, std::numeric_limits<std::size_t>::max());
}

std::vector<Sample> Trace::samples(double from, double to, std::size_t most) const {
  std::vector<Bucket> found;
  const auto is_earlier = [](const Bucket& bucket, double time) { return bucket.last().time < time; };
  for (auto level = levels_.rbegin(); level != levels_.rend(); ++level) {
    auto bucket = std::lower_bound(level->begin(), level->end(), from, is_earlier);
    if (bucket != level->begin()) found.assign(1, *(bucket - 1));  // all before it are further away
    for (; bucket != level->end(); ++bucket) {
      found.push_back(*bucket);
      if (bucket->first().time > to) break;
    }
    if (!found.empty() && found.back().first().time > to) break;
  }
  const std::size_t together =
      std::max<std::size_t>(1, (found.size() + most - 1) / std::max<std::size_t>(1, most));
  std::vector<Sample> samples;
  for (std::size_t i = 0; i < found.size(); i += together) {
    Bucket bucket = found[i];
    for (std::size_t j = i + 1; j < std::min(found.size(), i + together); ++j)
      bucket = merged(bucket, found[j]);
    append(bucket, samples);
  }
  return samples;
}

std::optional<double> Trace::valueAt(double time) const {
  for (const Level& level : levels_) {
    const auto after =
        std::upper_bound(level.begin(), level.end(), time,
                         [](double time, const Bucket& bucket) { return time < bucket.first().time; });
    if (after == level.begin()) continue;
    const Bucket& bucket = *(after - 1);
    return bucket.last().time <= time ? bucket.last().value : bucket.first().value;
  }
  return std::nullopt;
}

}  // namespace rbs
