// SPDX-License-Identifier: BSD-3-Clause
// Simulator: the one thread that owns a World and paces it by the steady clock.
//
// Everyone else posts a command, which runs between two steps, and reads immutable snapshots.
#pragma once

#include "rigid_body_sim/world.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <utility>

namespace rbs {

class Simulator {
 public:
  struct Options {
    bool paused = false;
    double speed = 1.0;  ///< times real time, >= 0; 0 is as fast as possible
  };

  /// Throws InvalidInput for a faulty scene.
  Simulator(SceneDef scene, const Options& options);
  ~Simulator();
  Simulator(const Simulator&) = delete;
  Simulator& operator=(const Simulator&) = delete;

  /// Runs `command` on the simulator's thread between two steps, waits for it and publishes a new
  /// snapshot. What it throws is thrown here.
  void edit(const std::function<void(World&)>& command);

  /// Replaces the world. reset() will come back to this scene.
  void load(SceneDef scene, const std::optional<SavedState>& saved = std::nullopt);
  void reset();  ///< back to the scene as it was loaded

  void pause();
  void resume();
  bool togglePause();  ///< returns whether it is paused now
  /// Takes exactly n steps (1 to 1e6) and returns when they are done. Throws InvalidInput when running
  /// or when n is out of range.
  void step(std::uint64_t n);
  void setSpeed(double speed);  ///< throws InvalidInput unless finite and >= 0

  /// Whether errors are estimated where no goal asks for it (see Governor).
  void estimateErrors(bool on);
  bool estimatesErrors() const;

  std::shared_ptr<const Snapshot> snapshot() const;
  /// The world as it is between two steps, with the snapshot published then.
  std::pair<World, std::shared_ptr<const Snapshot>> copy();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rbs
