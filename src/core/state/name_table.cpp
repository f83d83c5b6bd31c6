// SPDX-License-Identifier: BSD-3-Clause
#include "state/name_table.h"

#include <algorithm>
#include <utility>

namespace rbs {

void NameTable::place(const Slot& slot) {
  std::size_t k = homeOf(slot.hash);
  while (slots_[k].id) k = next(k);
  slots_[k] = slot;
}

void NameTable::insert(const std::string& name, BodyId id) {
  constexpr std::size_t kFewest = 16;
  if (2 * ++taken_ > slots_.size()) {
    const std::vector<Slot> old =
        std::exchange(slots_, std::vector<Slot>(std::max(kFewest, 2 * slots_.size())));
    for (const Slot& slot : old)
      if (slot.id) place(slot);
  }
  place({std::hash<std::string>()(name), id});
}

// Slot k is free now. A later one moves there unless its home lies behind k: between the two, going round.
void NameTable::erase(const std::string& name, BodyId id) {
  std::size_t k = homeOf(std::hash<std::string>()(name));
  while (slots_[k].id != id) k = next(k);
  --taken_;
  slots_[k] = {};
  for (std::size_t later = next(k); slots_[later].id; later = next(later)) {
    const std::size_t mask = slots_.size() - 1;
    const std::size_t from_home = (later - homeOf(slots_[later].hash)) & mask, from_free = (later - k) & mask;
    if (from_home < from_free) continue;
    std::swap(slots_[k], slots_[later]);
    k = later;
  }
}

}  // namespace rbs
