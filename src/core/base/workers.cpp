// SPDX-License-Identifier: BSD-3-Clause
#include "base/workers.h"

#include <algorithm>
#include <new>
#include <system_error>
#include <utility>

#include <pthread.h>

namespace rbs {

namespace {

constexpr int kSpins = 2000;  // some microseconds

std::uint32_t partsIn(std::uint64_t left) {
  return static_cast<std::uint32_t>(left);
}

std::uint64_t numberOf(std::uint64_t left) {
  return left >> 32;
}

thread_local unsigned self_of_thread = 0;

std::atomic<unsigned> forks{0};  // from the first process to this one

[[maybe_unused]] const int counted = pthread_atfork(nullptr, nullptr, [] { ++forks; });

}  // namespace

unsigned Workers::self() {
  return self_of_thread;
}

void Workers::relax() {
#if defined(__x86_64__)
  __builtin_ia32_pause();
#endif
}

Workers::~Workers() {
  stop();
}

void Workers::setCount(unsigned threads) {
  threads = std::max(threads, 1u);
  if (threads == count_) return;
  stop();
  count_ = threads;
}

// Fewer do as well, where the system has no more.
void Workers::start() {
  leaveToParent();
  try {
    while (threads_.size() + 1 < count_)
      threads_.emplace_back([this, self = static_cast<unsigned>(threads_.size()) + 1] { work(self); });
  } catch (const std::system_error&) {
    count_ = static_cast<unsigned>(threads_.size()) + 1;
  }
}

void Workers::stop() {
  leaveToParent();
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  for (std::thread& thread : threads_) thread.join();
  threads_.clear();
  stopping_ = false;
}

// After a fork the threads are those of the parent. What they were doing with the mutex and the condition stays undone here,
// so that neither of these nor the handles of the threads may be used or destroyed: they are left as they are.
void Workers::leaveToParent() {
  const unsigned now = forks;
  if (forks_ == now) return;
  forks_ = now;
  if (threads_.empty()) return;
  new std::vector<std::thread>(std::move(threads_));
  threads_.clear();
  new (&mutex_) std::mutex;
  new (&wake_) std::condition_variable;
  sleeping_ = 0;
}

void Workers::work(unsigned self) {
  self_of_thread = self;
  while (!stopping_) {
    const std::uint64_t seen = left_;
    while (takePart()) {
    }
    for (int k = 0; k < kSpins && numberOf(left_) == numberOf(seen); ++k) relax();
    if (numberOf(left_) == numberOf(seen)) sleepAfter(numberOf(seen));
  }
}

// share() looks for sleeping threads after it has written the number of its loop, and a thread looks for the number
// after it has counted itself as sleeping: one of the two sees the other.
void Workers::sleepAfter(std::uint64_t number) {
  std::unique_lock<std::mutex> lock(mutex_);
  ++sleeping_;
  wake_.wait(lock, [&] { return stopping_ || numberOf(left_) != number; });
  --sleeping_;
}

// Does the next part of the loop; false where all have been taken.
bool Workers::takePart() {
  std::uint64_t left = left_;
  while (partsIn(left) > 0) {
    if (!left_.compare_exchange_weak(left, left - 1)) continue;
    doPart(parts_ - partsIn(left));
    return true;
  }
  return false;
}

void Workers::doPart(std::size_t part) {
  try {
    const std::size_t begin = part * length_;
    (*body_.load())(part, begin, std::min(begin + length_, n_.load()));
  } catch (...) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!thrown_ || part < failed_) thrown_ = std::current_exception(), failed_ = part;
  }
  ++done_;
}

void Workers::share(std::size_t n, std::size_t length, const Body& body) {
  const std::size_t parts = Workers::parts(n, length);
  if (count_ == 1 || parts < 2) {
    for (std::size_t part = 0; part < parts; ++part)
      body(part, part * length, std::min((part + 1) * length, n));
    return;
  }
  start();
  body_ = &body, n_ = n, length_ = length, done_ = 0;
  parts_ = static_cast<std::uint32_t>(parts);
  left_ = ((numberOf(left_) + 1) << 32) + parts;
  if (sleeping_ > 0) {
    { const std::lock_guard<std::mutex> lock(mutex_); }  // who is about to sleep has by now
    wake_.notify_all();
  }
  while (takePart()) {
  }
  for (int k = 0; done_ < parts; ++k) k < kSpins ? relax() : std::this_thread::yield();
  if (thrown_) std::rethrow_exception(std::exchange(thrown_, nullptr));
}

}  // namespace rbs
