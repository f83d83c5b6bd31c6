// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/edit_history.h"

#include <utility>

namespace rbs {

void EditHistory::add(Entry before) {
  undone_.clear();
  done_.push_back(std::move(before));
  std::size_t bodies = 0, kept = 0;
  for (auto entry = done_.rbegin(); entry != done_.rend() && kept < kMostEdits; ++entry, ++kept) {
    bodies += entry->world.bodies()->size();
    if (kept > 0 && bodies > kMostBodies) break;
  }
  forgotten_ += done_.size() - kept;
  done_.erase(done_.begin(), done_.end() - static_cast<std::ptrdiff_t>(kept));
}

EditHistory::Entry EditHistory::exchange(std::deque<Entry>& from, std::deque<Entry>& to, Entry now) {
  Entry then = std::move(from.back());
  from.pop_back();
  now.what = then.what;
  to.push_back(std::move(now));
  return then;
}

}  // namespace rbs
