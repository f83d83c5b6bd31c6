// SPDX-License-Identifier: BSD-3-Clause
// Simulator: the one thread that owns a World and paces it by the steady clock.
//
// Other threads post commands, which run between two steps, and read immutable snapshots.
#pragma once

#include "rigid_body_sim/recording.h"
#include "rigid_body_sim/world.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>

namespace rbs {

/// How the simulation keeps up with the wall clock at this moment. The real-time factor is physics time over
/// wall time.
struct Pace {
  bool paused = false;           ///< true also while a step request is under way
  double requested_speed = 1.0;  ///< requested real-time factor, 0 to 1e6; 0 is as fast as possible
  /// Achieved real-time factor over about the last second. A step that is late counts against it before it
  /// has ended. 0 while paused. It is the requested one until there is something to measure.
  double achieved_speed = 0.0;
  /// Physics time lost since the last resume, load, reset or change of speed, s: what the requested speed
  /// required and the simulation did not reach. A simulation that cannot keep up runs slower and does not
  /// make up for it. 0 while paused.
  double lost_time = 0.0;
  /// How much longer ago than the interval between two steps the last step ended, s of wall time: what the
  /// step under way is late already. 0 while paused.
  double late = 0.0;
  std::uint64_t steps_left = 0;  ///< steps left of the step request under way; 0: none is
};

/// Result of a request for steps.
struct StepsTaken {
  std::uint64_t steps = 0;  ///< steps taken
  std::string ended_by;     ///< what ended it early: "pause", "resume", "load", "reset", "undo", "redo",
                            ///< "shutdown"; empty: all were taken
};

/// The thread that owns a World, steps it by a Governor and paces it by the steady clock. Others post
/// commands, which run between two steps, and read immutable snapshots. Every function may be called from any
/// thread. Within a command or `go_on` only send(), snapshot(), pace() and estimatesErrors() may be called:
/// the other functions would wait for themselves. Commands wake what the World functions that they call wake.
class Simulator {
 public:
  /// How the simulator begins.
  struct Options {
    bool paused = false;   ///< whether it begins paused
    double speed = 1.0;    ///< requested real-time factor, 0 to 1e6; 0 is as fast as possible
    unsigned threads = 1;  ///< that a step may use, see World::setThreads()
  };

  /// Starts the thread. Throws InvalidInput for a faulty scene, speed or number of threads.
  Simulator(SceneDef scene, const Options& options);
  /// Runs the commands that are still posted, ends a step request with "shutdown", and joins the thread. No
  /// other thread may call a function of it any more.
  ~Simulator();
  Simulator(const Simulator&) = delete;
  Simulator& operator=(const Simulator&) = delete;

  /// Runs `command` on the simulator's thread between two steps, waits for it and publishes a new snapshot.
  /// An exception of the command is thrown here. The wait lasts until the step under way ends.
  void edit(const std::function<void(World&)>& command);
  /// Runs an edit as edit() does, so that undo() takes it back. `edit` returns in words what it has done,
  /// and so does this function. It may change the world several times: where it throws, the world is as it
  /// was before. What does not count in World::edits() is not undone. The cost is a copy of the world besides.
  std::string apply(const std::function<std::string(World&)>& edit);
  /// Goes back to the world before the last edit of apply(), load() or reset(), its time included; ends a
  /// step request. Pause and speed stay, and so do solver settings and goal unless the edit was a load or
  /// reset. User forces end. Returns the edit in words. Throws InvalidInput where there is none. The last
  /// 1,000 edits are kept; fewer where their worlds have more than 100,000 bodies together. The cost is that
  /// of a snapshot.
  std::string undo();
  /// Takes an undo back: goes to the world as it was when undo() was called. Any apply(), load() or
  /// reset() ends what can be redone. Otherwise as undo().
  std::string redo();
  /// Forgets all that undo() and redo() could go to.
  void forgetEdits();
  /// Notes that a file holds the world of this Snapshot::revision.
  void markSaved(std::uint64_t revision);
  /// Runs `command` on the simulator's thread between two steps, but returns at once. A snapshot follows when
  /// the next is due. An exception of the command is dropped.
  void send(std::function<void(World&)> command);

  /// Replaces the world by one of this scene, from `saved` where that is given, and ends a step request.
  /// reset() will come back to this scene, undo() to the old world. The simulation goes on while the new world
  /// is made. Pause and speed stay. Throws InvalidInput for a faulty scene or state; the old world then stays.
  void load(SceneDef scene, const std::optional<SavedState>& saved = std::nullopt);
  /// Goes back to the scene and state as they were loaded; ends a step request. The cost is that of load().
  void reset();
  /// The scene as it was loaded; never null.
  std::shared_ptr<const SceneDef> loaded() const;

  void pause();   ///< stops between two steps; ends a step request, too
  void resume();  ///< lets time go on; ends a step request, too
  /// Pauses or resumes, and returns whether it is paused now. A step request is ended and counts as running.
  bool togglePause();
  /// Takes n steps (1 to 1e6) as fast as possible and returns when they are done, or when something ended
  /// them early. Between any two of them commands run and snapshots are published as ever. `go_on` is asked
  /// before each step, on the simulator's thread, and ends the request with "shutdown" by returning false; an
  /// empty one never does. Throws InvalidInput when running, when n is out of range, and at once when another
  /// request is under way.
  StepsTaken step(std::uint64_t n, const std::function<bool()>& go_on = nullptr);
  /// Sets the requested real-time factor; 0 is as fast as possible. Throws InvalidInput unless it is 0 to
  /// 1e6.
  void setSpeed(double speed);

  /// Sets whether errors are estimated where no goal requires it, also after a load or reset (see Governor).
  /// It costs a second run beside the world.
  void estimateErrors(bool on);
  bool estimatesErrors() const;  ///< the last value given to estimateErrors(); false at first

  /// Records: hands each change of the world to `keep`, in order, on the simulator's thread, which must not wait in
  /// it. The first entry is a checkpoint of this moment. Another comes with every load, reset, undo and redo, and
  /// every `checkpoint_period` s of physics time, above 0. What a failed apply() has taken back is left out. The
  /// solver settings that a goal chooses are commands, too. An empty `keep` ends the recording. Cost: a state hash
  /// for the commands of a step, and for a checkpoint that and a copy of the world. Nothing while nobody records.
  void record(std::function<void(Recorded)> keep, double checkpoint_period = 10.0);

  /// The newest snapshot, never null. The call copies a pointer. While the simulation runs a new one follows
  /// 80 times a second. It is as rare as 10 times a second where snapshots are expensive or steps are slow,
  /// and follows every step where a step takes more than 0.1 s.
  std::shared_ptr<const Snapshot> snapshot() const;
  /// The pace at this moment. It does not wait for the simulator's thread.
  Pace pace() const;
  /// A copy of the world between two steps, with the snapshot published then. Waits for the step under way.
  /// Cost: that of the copy constructor of World.
  std::pair<World, std::shared_ptr<const Snapshot>> copy();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rbs
