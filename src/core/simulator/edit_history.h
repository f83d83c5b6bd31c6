// SPDX-License-Identifier: BSD-3-Clause
// The edits that can be undone, and those that can be redone.
//
// An edit is undone by going back to the world before it, time included: the inverse of an edit would meet
// bodies that have moved on. A copy of a world takes about 2 kB and 0.2 us a body, less than the snapshot that
// follows every edit.
#pragma once

#include "rigid_body_sim/world.h"

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>

namespace rbs {

/// The scene and state that a world is made of, and made of again on a reset.
struct Origin {
  SceneDef scene;
  std::optional<SavedState> saved;
};

class EditHistory {
 public:
  /// A world on one side of an edit.
  struct Entry {
    std::string what;  ///< the edit, in words
    World world;
    std::shared_ptr<const Origin> origin;  ///< of that world
    std::uint64_t revision;                ///< of that world
  };

  /// Keeps the world before an edit, and forgets what could be redone. The oldest edits beyond kMostEdits, or
  /// beyond kMostBodies in all worlds, are forgotten.
  void add(Entry before);

  /// The next edit to undo or to redo; null: none.
  const Entry* undoable() const { return done_.empty() ? nullptr : &done_.back(); }
  const Entry* redoable() const { return undone_.empty() ? nullptr : &undone_.back(); }
  /// How many edits could be undone but for these limits.
  std::uint64_t forgotten() const { return forgotten_; }
  /// Takes the world before the next edit to undo, and keeps the present one for redo; or the other way
  /// round. There must be such an edit. `Entry::what` of the present one does not matter.
  Entry undo(Entry now) { return exchange(done_, undone_, std::move(now)); }
  Entry redo(Entry now) { return exchange(undone_, done_, std::move(now)); }

  static constexpr std::size_t kMostEdits = 1000, kMostBodies = 100'000;

 private:
  static Entry exchange(std::deque<Entry>& from, std::deque<Entry>& to, Entry now);

  std::deque<Entry> done_, undone_;  // the newest last
  std::uint64_t forgotten_ = 0;
};

}  // namespace rbs
