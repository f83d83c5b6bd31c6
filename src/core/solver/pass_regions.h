// SPDX-License-Identifier: BSD-3-Clause
// Passes over levels (contact_lanes.h), shared by threads.
//
// A level takes a microsecond or less, which is too short for threads to wait for each other at its end. So bodies are split
// by place into regions, at most one for each thread, and a pair belongs to the region of one of its bodies. A thread solves
// the bundles of a region in the order of their levels. Where a bundle reads a body that another region writes, it waits
// until that region has come so far. So every pair reads the velocities that it reads on one thread: a pass gives the same
// bits for any number of threads. A wait is always for a lower level, so there is no deadlock. This is the point-to-point
// synchronisation of a sparse triangular solve (J. Park, M. Smelyanskiy, N. Sundaram and P. Dubey, "Sparsifying
// Synchronization for High-Performance Shared-Memory Sparse Triangular Solver", ISC 2014).
//
// A region is not tied to a thread. One that has waited for long is put down, and a thread without a region takes it up.
#pragma once

#include "base/workers.h"
#include "solver/solver_contacts.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace rbs {

class PassRegions {
 public:
  /// Does what is to be done with the bundles from `begin` to before `end`.
  using Body = std::function<void(std::size_t begin, std::size_t end)>;

  /// Splits the bodies into as many regions as there are threads, or fewer where there are few pairs, along the axis along
  /// which they wait least for each other. One region where sharing costs more than it saves: there are few pairs, or most
  /// would wait. `level` is by block, and kNone for one without points.
  void split(const SolverContacts& contacts, const std::vector<Index>& level, unsigned threads);
  std::size_t count() const { return bodies_.size(); }
  /// The region of a block.
  std::size_t of(const SolverContacts& contacts, const SolverBlock& block) const;
  /// Slots of the bodies of a region.
  const std::vector<Index>& bodies(std::size_t region) const { return bodies_[region]; }

  /// Then, where there is more than one: the bundles of region r are those from first[r] to before first[r + 1].
  void setBundles(const std::vector<std::size_t>& first);
  /// A bundle reads what one before it writes. In the order of the bundles.
  void need(std::size_t bundle, std::size_t before);
  /// All needs are known.
  void finish();

  /// Calls `body` for all bundles of the regions, each after those that it needs. After an exception of `body` no more
  /// bundles are done, and it is thrown here.
  void inOrder(Workers& workers, const Body& body);
  /// Calls `body` once for each region, in any order, as a rule on the thread that has its bodies in its cache.
  void each(Workers& workers, const std::function<void(std::size_t region)>& body);
  /// The bundles of a region.
  std::size_t begin(std::size_t region) const { return first_[region]; }
  std::size_t end(std::size_t region) const { return first_[region + 1]; }

 private:
  // Some bundles have been done, of another region.
  struct Wait {
    std::size_t bundle;  // that waits
    std::size_t region;
    std::uint32_t done;  // bundles of that region
  };
  // Bundles in a row between which nobody waits.
  struct Stretch {
    std::size_t begin, end;
    std::size_t first_wait, last_wait;  // before it, in the waits of its region
  };
  // A line of the cache each: threads write theirs often.
  struct alignas(64) Progress {
    std::atomic<std::uint32_t> done{0};  // bundles
    std::atomic<bool> taken{false};      // a thread is at it
    std::size_t next = 0;                // stretch, of who has taken it
  };
  struct Region {
    std::vector<Wait> waits;
    std::vector<Stretch> stretches;
    std::vector<std::uint32_t> known;  // by region: bundles of it that some bundle of this one has waited for
  };

  std::size_t regionOf(std::size_t bundle) const;
  bool isComplete(std::size_t region) const;
  bool isReady(const Region& region, const Stretch& stretch) const;
  bool solveReady(std::size_t region, const Body& body);
  void takeRegions(const Body& body);

  std::vector<std::size_t> of_body_;        // by slot; empty: all are in one
  std::vector<std::vector<Index>> bodies_;  // by region
  std::vector<std::size_t> first_;          // by region
  std::vector<Region> regions_;
  std::vector<char> awaited_;  // by bundle: another region waits for it
  std::unique_ptr<Progress[]> progress_;
  std::atomic<bool> failed_{false};  // a call of the body has thrown
  std::size_t room_ = 0;             // of `progress_`
};

}  // namespace rbs
