// SPDX-License-Identifier: BSD-3-Clause
// Trace: the samples of one curve over time, in bounded memory.
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <vector>

namespace rbs {

struct Sample {
  double time = 0.0;  ///< s
  double value = 0.0;
};

/// The older a sample is, the more of its neighbours share a bucket with it. A bucket keeps its lowest and its
/// highest sample, so no peak is ever lost, and the newest 3 * kCapacity samples are all there.
class Trace {
 public:
  static constexpr std::size_t kCapacity = 1024;  ///< buckets of a level
  static constexpr std::size_t kLevels = 12;      ///< a bucket of level k holds 2^k samples

  /// Appends a sample. One at the time of the last takes its place. One that is earlier than the last, or not
  /// finite, is dropped.
  void add(const Sample& sample);

  bool empty() const { return levels_.front().empty(); }
  double begin() const;  ///< time of the oldest sample, s; 0 when there is none
  double end() const;    ///< time of the newest sample, s; 0 when there is none
  /// Number of samples that are kept.
  std::size_t size() const;

  /// The samples from `from` to `to`, and one more on each side, in the order of time. Where there are more
  /// than `most` buckets, neighbours are merged.
  std::vector<Sample> samples(double from, double to, std::size_t most) const;
  /// All samples that are kept, in the order of time.
  std::vector<Sample> samples() const;
  /// The last value that was there at this time; none before the oldest sample.
  std::optional<double> valueAt(double time) const;

 private:
  struct Bucket {
    Sample low, high;

    const Sample& first() const { return low.time <= high.time ? low : high; }
    const Sample& last() const { return low.time <= high.time ? high : low; }
    std::size_t size() const { return low.time == high.time ? 1 : 2; }
  };
  using Level = std::deque<Bucket>;

  static Bucket merged(const Bucket& a, const Bucket& b);
  static void append(const Bucket& bucket, std::vector<Sample>& samples);

  std::vector<Level> levels_ = std::vector<Level>(kLevels);  ///< the newest first
};

}  // namespace rbs
