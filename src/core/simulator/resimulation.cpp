// SPDX-License-Identifier: BSD-3-Clause
#include "rigid_body_sim/recording.h"

#include <algorithm>

namespace rbs {
namespace {

// "apply_impulse, grab": each name once, in the order of their first.
std::string namesOf(const Recorded& entry) {
  const auto* const given = std::get_if<Recorded::Commands>(&entry.what);
  if (!given) return "checkpoint";
  std::vector<std::string> names;
  for (const Command& command : *given)
    if (std::find(names.begin(), names.end(), command.name()) == names.end()) names.push_back(command.name());
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

}  // namespace

void Resimulation::expect(std::uint64_t world, std::uint64_t step, std::uint64_t hash,
                          std::uint64_t recorded) {
  std::vector<Seen>& all = expected_[{world, step}];
  const auto same = std::find_if(all.begin(), all.end(), [&](const Seen& seen) { return seen.hash == hash; });
  if (same == all.end()) all.push_back({hash, recorded});
}

Mismatch Resimulation::mismatch(const std::string& at, std::uint64_t expected, std::uint64_t found) const {
  return {number_, world_->steps(), world_->time(), at, expected, found, "", clocked_};
}

// Notes the hash of this moment, where one of this step is expected.
void Resimulation::note() {
  if (expected_.count({number_, world_->steps()})) seen_.push_back(world_->stateHash());
}

std::optional<Mismatch> Resimulation::leaveStep() {
  const auto expected = expected_.find({number_, world_->steps()});
  if (expected == expected_.end()) return std::nullopt;
  const std::vector<Seen> all = std::move(expected->second);
  const std::vector<std::uint64_t> seen = std::exchange(seen_, {});
  expected_.erase(expected);
  for (const auto& [hash, recorded] : all) {
    if (std::find(seen.begin(), seen.end(), hash) != seen.end()) {
      ++hashes_;
    } else if (recorded > recorded_) {
      ++uncovered_;
    } else if (Moment(number_, world_->steps()) != first_) {  // where it may be from before the checkpoint
      return mismatch("status", hash, seen.back());
    }
  }
  return std::nullopt;
}

std::optional<Mismatch> Resimulation::advance(std::uint64_t step) {
  std::optional<Mismatch> first;
  while (world_->steps() < step) {
    if (std::optional<Mismatch> found = leaveStep(); found && !first) first = std::move(found);
    clocked_ = clocked_ || world_->scene().fidelity.max_solve_ms.has_value();
    world_->step();
    ++steps_;
    seconds_ += world_->scene().step;
    note();
  }
  return first;
}

// A status may have been seen after the last entry of its world.
std::optional<Mismatch> Resimulation::leaveWorld() {
  std::uint64_t last = world_->steps();
  for (const auto& [moment, hashes] : expected_)
    if (moment.first == number_) last = std::max(last, moment.second);
  std::optional<Mismatch> found = advance(last), at_last = leaveStep();
  return found ? found : at_last;
}

std::optional<Mismatch> Resimulation::begin(const Recorded& entry) {
  const auto* checkpoint = std::get_if<Recorded::Checkpoint>(&entry.what);
  const std::string path = "world " + std::to_string(entry.world);
  if (!checkpoint) throw InvalidInput({{path, "commands before any checkpoint", "a checkpoint first"}});
  if (!*checkpoint)
    throw InvalidInput({{path, "a first checkpoint without a world", "a world that fits 64 MiB of text"}});
  const std::optional<Mismatch> before = world_ ? leaveWorld() : std::nullopt;
  if (!world_) {
    first_ = {entry.world, entry.step};
    expected_.erase(expected_.begin(), expected_.lower_bound(first_));
  }
  world_.emplace((*checkpoint)->scene, (*checkpoint)->state);
  number_ = entry.world, clocked_ = false;
  note();
  return before;
}

std::optional<Mismatch> Resimulation::executeAll(const Recorded& entry) {
  const auto* const given = std::get_if<Recorded::Commands>(&entry.what);
  if (!given) return std::nullopt;
  for (const Command& command : *given) {
    try {
      execute(*world_, command);
    } catch (const InvalidInput& refusal) {
      Mismatch refused = mismatch(command.name(), entry.hash, world_->stateHash());
      refused.refusal = refusal.what();
      return refused;
    }
    ++commands_;
  }
  note();
  return std::nullopt;
}

std::optional<Mismatch> Resimulation::take(const Recorded& entry) {
  std::optional<Mismatch> first;
  const auto consider = [&](std::optional<Mismatch> found) {
    if (found && !first) first = std::move(found);
  };
  recorded_ = entry.sequence;
  if (!world_ || entry.world != number_) consider(begin(entry));
  if (entry.step < world_->steps())
    throw InvalidInput({{"step", std::to_string(entry.step), "at least " + std::to_string(world_->steps())}});
  consider(advance(entry.step));
  consider(executeAll(entry));
  recorded_ = entry.sequence + 1;
  const std::uint64_t hash = world_->stateHash();
  if (hash == entry.hash) {
    ++hashes_;
  } else {
    consider(mismatch(namesOf(entry), entry.hash, hash));
  }
  return first;
}

std::optional<Mismatch> Resimulation::finish() {
  std::optional<Mismatch> found = world_ ? leaveWorld() : std::nullopt;
  for (const auto& [moment, seen] : expected_) uncovered_ += seen.size();  // of worlds without a checkpoint
  return found;
}

}  // namespace rbs
