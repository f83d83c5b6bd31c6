// SPDX-License-Identifier: BSD-3-Clause
// Simulator: the one thread that owns a World and paces it by the steady clock.
//
// Everyone else posts a command, which runs between two steps, and reads immutable snapshots.
#pragma once

#include "rigid_body_sim/world.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>

namespace rbs {

/// How the simulation keeps up with the clock on the wall, now.
struct Pace {
  bool paused = false;
  double requested_speed = 1.0;  ///< times real time; 0 is as fast as possible
  /// Times real time, over about the last second; a step that is late counts against it before it has ended.
  /// 0 while paused; the requested one until there is something to measure.
  double achieved_speed = 0.0;
  /// Physics time that the requested speed asked for and that was given up since the last resume, load, reset
  /// or change of speed, s: a simulation that cannot keep up runs slower, it does not make up for it. 0 while
  /// paused.
  double lost_time = 0.0;
  std::uint64_t steps_left = 0;  ///< of the step request under way; 0: none is
};

/// What a request for steps came to.
struct StepsTaken {
  std::uint64_t steps = 0;
  std::string ended_by;  ///< what ended it early: "pause", "resume", "load", "reset", "shutdown"; empty: all
                         ///< were taken
};

class Simulator {
 public:
  struct Options {
    bool paused = false;
    double speed = 1.0;  ///< times real time, >= 0; 0 is as fast as possible
  };

  /// Throws InvalidInput for a faulty scene.
  Simulator(SceneDef scene, const Options& options);
  ~Simulator();  ///< nobody may wait for it any more
  Simulator(const Simulator&) = delete;
  Simulator& operator=(const Simulator&) = delete;

  /// Runs `command` on the simulator's thread between two steps, waits for it and publishes a new
  /// snapshot. What it throws is thrown here.
  void edit(const std::function<void(World&)>& command);
  /// Runs `command` likewise, but returns at once; a snapshot follows when the next is due. It must not
  /// throw.
  void send(std::function<void(World&)> command);

  /// Replaces the world, and ends a step request. reset() will come back to this scene. The simulation goes
  /// on while the new world is made.
  void load(SceneDef scene, const std::optional<SavedState>& saved = std::nullopt);
  void reset();  ///< back to the scene as it was loaded; ends a step request

  void pause();        ///< ends a step request, too
  void resume();       ///< likewise
  bool togglePause();  ///< returns whether it is paused now; a step request is ended and counts as running
  /// Takes n steps (1 to 1e6) as fast as possible and returns when they are done, or when something ended
  /// them early. Between any two of them commands run and snapshots are published as ever. `go_on` is asked
  /// before each step, on the simulator's thread, and ends the request with "shutdown" by false. Throws
  /// InvalidInput when running, when n is out of range, and at once when another request is under way.
  StepsTaken step(std::uint64_t n, const std::function<bool()>& go_on = nullptr);
  void setSpeed(double speed);  ///< throws InvalidInput unless finite and >= 0

  /// Whether errors are estimated where no goal asks for it (see Governor).
  void estimateErrors(bool on);
  bool estimatesErrors() const;

  /// The newest. While it runs they follow each other 80 times a second, or less often where steps or
  /// snapshots are slow: 10 times a second as long as a step takes less than 0.1 s.
  std::shared_ptr<const Snapshot> snapshot() const;
  Pace pace() const;
  /// The world as it is between two steps, with the snapshot published then.
  std::pair<World, std::shared_ptr<const Snapshot>> copy();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rbs
