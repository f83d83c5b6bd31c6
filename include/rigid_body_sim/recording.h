// SPDX-License-Identifier: BSD-3-Clause
// Recordings: what a Simulator did to its world, in order, and running it again to the same state hashes.
#pragma once

#include "rigid_body_sim/commands.h"
#include "rigid_body_sim/scenes.h"

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace rbs {

/// One entry of a recording: the commands that have changed the world between two steps, or a checkpoint, which
/// holds all of it. A recording begins with a checkpoint, and so does every other world in it.
struct Recorded {
  /// Commands that were given together, such as those of one service call, in their order.
  using Commands = std::vector<Command>;
  /// The whole world, exactly: capture() and captureExactState(). Null: the world was too large to be written.
  using Checkpoint = std::shared_ptr<const SceneFile>;

  std::uint64_t sequence = 0;               ///< 0 for the first entry of a Simulator, one more for each
  std::uint64_t world = 0;                  ///< Snapshot::world: the number of the world
  std::uint64_t step = 0;                   ///< World::steps() then
  double time = 0.0;                        ///< World::time() then, s
  std::uint64_t hash = 0;                   ///< World::stateHash() after the commands, or of the checkpoint
  std::variant<Commands, Checkpoint> what;  ///< the entry itself
};

/// A state hash of a re-simulation that differs from the recorded one.
struct Mismatch {
  std::uint64_t world = 0,     ///< number of the world, as Recorded::world
      step = 0;                ///< steps of that world
  double time = 0.0;           ///< physics time of that world, s
  std::string at;              ///< what has the hash: "checkpoint", "status" or the names of the commands
  std::uint64_t expected = 0,  ///< recorded hash
      found = 0;               ///< hash of the re-simulation
  std::string refusal;         ///< why the world has refused a recorded command; empty: a hash differs
  bool clocked = false;        ///< the world took steps with Setting::max_solve_ms, which depend on the clock
};

/// Runs a recording again: it makes the world of each first checkpoint, steps it, executes each command at its
/// step, and compares every hash on the way. Worlds repeat bit for bit by the same program on the same kind of
/// processor, unless Setting::max_solve_ms cuts solves short.
class Resimulation {
 public:
  /// Expects a hash that was seen from outside: the world of this number has had it at this step, before or after
  /// any command of that step, with so many entries recorded (Snapshot::recorded). To be called before take() comes
  /// to that step. What was seen before the first checkpoint is dropped.
  void expect(std::uint64_t world, std::uint64_t step, std::uint64_t hash, std::uint64_t recorded);

  /// Goes on to the next entry, which is of the same world at the same or a later step, or of another world.
  /// Returns the first mismatch on the way; later entries are then compared with a world that already differs.
  /// Throws InvalidInput where the entries do not make a recording: a command before any checkpoint, a step that
  /// goes back, another world whose first checkpoint could not be written, a faulty scene.
  std::optional<Mismatch> take(const Recorded& entry);
  /// Goes on to the last step that is expected. To be called once, after the last take().
  std::optional<Mismatch> finish();

  const World& world() const { return *world_; }         ///< the world now; only after the first take()
  std::uint64_t worldNumber() const { return number_; }  ///< its number, as Recorded::world
  std::uint64_t steps() const { return steps_; }         ///< steps taken in all worlds
  double seconds() const { return seconds_; }            ///< physics time of these steps, s
  std::uint64_t commands() const { return commands_; }   ///< commands executed
  std::uint64_t hashes() const { return hashes_; }       ///< hashes that were equal
  /// Hashes that finish() did not compare: they were seen after entries that no take() has brought, as where the
  /// recording was cut off.
  std::uint64_t uncovered() const { return uncovered_; }

 private:
  using Moment = std::pair<std::uint64_t, std::uint64_t>;  // world, step
  struct Seen {
    std::uint64_t hash, recorded;
  };

  std::optional<Mismatch> begin(const Recorded& entry);
  std::optional<Mismatch> advance(std::uint64_t step);
  std::optional<Mismatch> leaveStep();
  std::optional<Mismatch> leaveWorld();
  std::optional<Mismatch> executeAll(const Recorded& entry);
  Mismatch mismatch(const std::string& at, std::uint64_t expected, std::uint64_t found) const;
  void note();

  std::optional<World> world_;
  std::uint64_t number_ = 0;
  bool clocked_ = false;                          // as Mismatch::clocked
  Moment first_;                                  // of the recording
  std::map<Moment, std::vector<Seen>> expected_;  // seen from outside
  std::vector<std::uint64_t> seen_;               // hashes of this step so far, where some are expected
  std::uint64_t recorded_ = 0;                    // entries up to now, as Snapshot::recorded
  std::uint64_t steps_ = 0, commands_ = 0, hashes_ = 0, uncovered_ = 0;
  double seconds_ = 0.0;
};

}  // namespace rbs
