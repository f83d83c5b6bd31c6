// SPDX-License-Identifier: BSD-3-Clause
// Workers: threads that share out a loop.
//
// A loop is cut into parts, and each part writes only what is its own. So what comes out does not depend on how
// many threads there are, nor on which of them took a part.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace rbs {

class Workers {
 public:
  /// Does a part: the elements from `begin` to before `end`. `part` counts from 0.
  using Body = std::function<void(std::size_t part, std::size_t begin, std::size_t end)>;

  /// After fork() the child has the calling thread alone. The next loop starts others.
  Workers() = default;
  ~Workers();
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;

  /// How many threads share a loop, the calling one included; at least 1, and 1 at first. They are started by
  /// the first loop that they can share. They look for the next loop for some microseconds, and then sleep.
  void setCount(unsigned threads);
  /// The last value given to setCount(); fewer where the system could not start so many.
  unsigned count() const { return count_; }

  /// Which of the threads the calling one is: 0 is the one that calls share(). A hint: threads of two Workers have the
  /// same numbers.
  static unsigned self();
  /// For a loop that waits for another thread.
  static void relax();

  /// Number of parts of `length` elements (> 0) that n elements make; the last one may be shorter.
  static std::size_t parts(std::size_t n, std::size_t length) { return (n + length - 1) / length; }
  /// Calls `body` for each part of n elements and returns when all are done. An exception of a part is thrown
  /// here, that of the first part that had one. Parts may not call share() themselves. Costs about a
  /// microsecond while the other threads are awake, and some more where they must be woken.
  void share(std::size_t n, std::size_t length, const Body& body);

 private:
  void start();
  void stop();
  void leaveToParent();
  void work(unsigned self);
  bool takePart();
  void doPart(std::size_t part);
  void sleepAfter(std::uint64_t number);

  unsigned count_ = 1;
  std::vector<std::thread> threads_;
  unsigned forks_ = 0;  // the number of forks when they were started

  // The loop. It is written before its number, and not again until all of its parts are done: a thread that has taken
  // a part of a loop reads what belongs to it.
  std::atomic<const Body*> body_{nullptr};
  std::atomic<std::size_t> n_{0}, length_{1};
  std::atomic<std::uint32_t> parts_{0};
  std::atomic<std::uint64_t> left_{
      0};  // the number of the loop in the upper half, parts not taken in the lower
  std::atomic<std::uint32_t> done_{0};  // parts

  std::mutex mutex_;
  std::condition_variable wake_;
  std::atomic<unsigned> sleeping_{0};
  std::atomic<bool> stopping_{false};
  std::size_t failed_ = 0;  // the first part that has thrown, under the mutex
  std::exception_ptr thrown_;
};

}  // namespace rbs
