// SPDX-License-Identifier: BSD-3-Clause
// NameTable: which body has a name.
//
// A hash table with linear probing: a name stands in the first free slot from the one of its hash on. When a slot
// becomes free, the names behind it that would have stood there move up, so that no search ends too early (D. E.
// Knuth, "The Art of Computer Programming", vol. 3, 2nd ed. 1998, 6.4, algorithms L and R). It holds no names,
// only their hashes, and has no nodes of its own: a copy of a world copies one array.
#pragma once

#include "rigid_body_sim/scene.h"

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace rbs {

class NameTable {
 public:
  /// The body of this name; no body when there is none. `nameOf(id)` is the name of a body in the table.
  template <class NameOf>
  BodyId find(const std::string& name, const NameOf& nameOf) const {
    if (slots_.empty()) return {};
    const std::size_t hash = std::hash<std::string>()(name);
    for (std::size_t k = homeOf(hash); slots_[k].id; k = next(k))
      if (slots_[k].hash == hash && nameOf(slots_[k].id) == name) return slots_[k].id;
    return {};
  }
  /// Adds a body, whose name is not in the table.
  void insert(const std::string& name, BodyId id);
  /// Removes a body, whose name is in the table.
  void erase(const std::string& name, BodyId id);

 private:
  struct Slot {
    std::size_t hash = 0;
    BodyId id;  // no body: the slot is free
  };

  std::size_t homeOf(std::size_t hash) const { return hash & (slots_.size() - 1); }
  std::size_t next(std::size_t k) const { return (k + 1) & (slots_.size() - 1); }
  void place(const Slot& slot);

  std::vector<Slot> slots_;  // none, or a power of two, of which at most half are taken
  std::size_t taken_ = 0;
};

}  // namespace rbs
