// SPDX-License-Identifier: BSD-3-Clause
#include "simulator/recorder.h"

#include <utility>

namespace rbs {

void Recorder::begin(Keep keep, double period, World& world, std::uint64_t number) {
  flush(world);
  keep_ = std::move(keep);
  period_ = period;
  attach(world, number);
}

void Recorder::attach(World& world, std::uint64_t number) {
  number_ = number;
  listen(world);
  if (keep_) checkpoint(world);
}

void Recorder::listen(World& world) {
  if (!keep_) return world.setJournal(nullptr);
  world.setJournal([this](const Command& command) { pending_.push_back(command); });
}

void Recorder::leave(World& world) {
  flush(world);
  world.setJournal(nullptr);
}

void Recorder::flush(const World& world) {
  if (pending_.empty()) return;
  keep_({kept_++, number_, world.steps(), world.time(), world.stateHash(), std::exchange(pending_, {})});
}

void Recorder::stepped(const World& world) {
  if (!keep_) return;
  flush(world);
  if (world.time() > next_ - 0.5 * world.scene().step) checkpoint(world);
}

void Recorder::checkpoint(const World& world) {
  next_ = world.time() + period_;
  keep_({kept_++, number_, world.steps(), world.time(), world.stateHash(),
         std::make_shared<const SceneFile>(SceneFile{world.capture(), world.captureExactState()})});
}

}  // namespace rbs
