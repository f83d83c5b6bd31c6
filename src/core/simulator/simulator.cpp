// SPDX-License-Identifier: BSD-3-Clause
#include "rigid_body_sim/simulator.h"

#include "base/text.h"
#include "rigid_body_sim/governor.h"
#include "rigid_body_sim/quote.h"
#include "simulator/edit_history.h"
#include "simulator/pacer.h"
#include "simulator/recorder.h"
#include "simulator/warning_log.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <condition_variable>
#include <exception>
#include <future>
#include <mutex>
#include <set>
#include <thread>
#include <utility>
#include <vector>

namespace rbs {

namespace {

using Clock = Pacer::Clock;

struct Posted {
  std::function<void()> run;
  std::shared_ptr<std::promise<void>> done;  // null: nobody waits
};

// A request for steps that is under way.
struct StepRequest {
  std::uint64_t left, taken = 0;
  std::function<bool()> go_on;
  std::promise<StepsTaken> done;

  void end(const std::string& by) { done.set_value({taken, by}); }
};

InvalidInput nothingToUndo(std::uint64_t forgotten) {
  if (forgotten == 0) return InvalidInput({{"undo", "nothing to undo", "an edit first"}});
  return InvalidInput(
      {{"undo", "nothing to undo",
        "an edit among the last 1,000, or fewer where their worlds have more than 100,000 bodies "
        "together; edits forgotten: " +
            std::to_string(forgotten)}});
}

}  // namespace

struct Simulator::Impl {
  // Used by the thread alone.
  World world;
  const unsigned threads;  // of the world; a world of the history has one
  Governor governor;
  std::uint64_t edits_before = 0, versions_before = 0;  // of earlier worlds, so that the sums only grow
  double elapsed_before = 0.0, began_at = 0.0;  // of earlier worlds; time at which this world began, s
  std::uint64_t worlds = 0;                     // number of earlier worlds
  std::optional<StepRequest> request;
  bool stale = false;  // the world has changed since the last snapshot
  EditHistory history;
  std::uint64_t revision = 0, revisions = 0;  // of the world, and in all
  std::set<std::uint64_t> saved{0};           // revisions that a file holds
  Recorder recorder;
  WarningLog warnings;

  // Shared with other threads, under the mutex.
  mutable std::mutex mutex;
  std::condition_variable wake;
  std::vector<Posted> commands;
  bool stop = false;
  Pace pace;  // without the numbers of the pacer
  Pacer pacer;

  std::mutex replacing;                  // one caller at a time makes another world
  std::shared_ptr<const Origin> origin;  // written under it, by the thread
  std::atomic<bool> estimating{false};
  std::shared_ptr<const Snapshot> published;  // read and written by atomic_load and atomic_store

  std::thread thread;

  Impl(SceneDef scene, const Options& options)
      : world(scene),
        threads(options.threads),
        origin(std::make_shared<Origin>(Origin{std::move(scene), std::nullopt})) {
    world.setThreads(threads);
    pace.paused = options.paused;
    pace.requested_speed = options.speed;
    restartClock();
    publish();
  }

  void publish() {
    recorder.flush(world);  // what the snapshot shows is an entry by then
    const Clock::time_point start = Clock::now();
    Snapshot snapshot = world.snapshot();
    snapshot.edits += edits_before;
    snapshot.description_version += versions_before;
    snapshot.world = worlds;
    snapshot.recorded = recorder.kept();
    snapshot.elapsed = elapsed_before + (world.time() - began_at);
    snapshot.paused = pace.paused;
    snapshot.estimate = governor.estimate();
    snapshot.dial_reason = governor.reason(world);
    snapshot.warnings = warnings.all();
    snapshot.step_cpu_seconds = governor.stepCpuSeconds();
    if (history.undoable()) snapshot.undo = history.undoable()->what;
    if (history.redoable()) snapshot.redo = history.redoable()->what;
    snapshot.revision = revision;
    snapshot.unsaved = saved.count(revision) == 0;
    std::atomic_store(&published, std::make_shared<const Snapshot>(std::move(snapshot)));
    stale = false;
    const std::lock_guard<std::mutex> lock(mutex);
    pacer.pictured(start, Clock::now());
  }

  void restartClock() {
    const std::lock_guard<std::mutex> lock(mutex);
    pacer.restart(Clock::now(), pace.requested_speed, world.scene().step);
  }

  // A change while the world runs brings no step forward.
  void setPace(bool paused, double speed) {
    const std::lock_guard<std::mutex> lock(mutex);
    const bool runs_on = !pace.paused && !paused;
    if (runs_on && pace.requested_speed == speed) return;
    pace.paused = paused;
    pace.requested_speed = speed;
    const Pacer::Time now = Clock::now();
    pacer.restart(now, speed, world.scene().step, runs_on ? pacer.left(now) : 0.0);
  }

  void endRequest(const char* by) {
    if (!request) return;
    publish();
    {
      const std::lock_guard<std::mutex> lock(mutex);
      pace.steps_left = 0;
    }
    std::exchange(request, std::nullopt)->end(by);
  }

  // A world of the history, or the present one for it: a copy, which has none of the memory and the threads of its
  // steps.
  EditHistory::Entry present(std::string what) {
    return {std::move(what), World(world), std::atomic_load(&origin), revision};
  }

  void apply(const std::function<std::string(World&)>& edit, std::string& what) {
    World before(world);
    const std::uint64_t edits = world.edits();
    const std::size_t recorded = recorder.pending();
    try {
      what = edit(world);
    } catch (...) {
      takeBack(std::move(before), recorded);
      throw;
    }
    if (world.edits() == edits) return;
    history.add({what, std::move(before), std::atomic_load(&origin), revision});
    revision = ++revisions;
  }

  // Goes back to the world before an edit that failed, and forgets the commands that it has given.
  void takeBack(World before, std::size_t recorded) {
    world = std::move(before);
    world.setThreads(threads);
    recorder.listen(world);
    recorder.drop(recorded);
  }

  // The solver settings are no edit: they stay, but where the edit was a load. User forces end: nobody
  // holds a body any longer.
  std::string goBack(bool undoes) {
    const EditHistory::Entry* const next = undoes ? history.undoable() : history.redoable();
    if (!next && undoes) throw nothingToUndo(history.forgotten());
    if (!next) throw InvalidInput({{"redo", "nothing to redo", "an undo first, and no edit since"}});
    const Setting setting = world.scene().fidelity;
    const std::optional<Goal> goal = world.scene().goal;
    const std::shared_ptr<const Origin> from = std::atomic_load(&origin);
    prepareReplacement(undoes ? "undo" : "redo");
    EditHistory::Entry then = undoes ? history.undo(present("")) : history.redo(present(""));
    if (then.origin == from) {
      if (then.world.scene().fidelity != setting) then.world.setFidelity(setting);
      then.world.setGoal(goal);
    }
    then.world.releaseAll();
    revision = then.revision;
    std::atomic_store(&origin, then.origin);
    setWorld(std::move(then.world));
    return then.what;
  }

  void prepareReplacement(const char* by) {
    recorder.leave(world);
    endRequest(by);
    publish();
    edits_before = published->edits + 1;
    versions_before = published->description_version + 1;
    elapsed_before = published->elapsed;
    ++worlds;
  }

  void setWorld(World fresh) {
    began_at = fresh.time();
    world = std::move(fresh);
    world.setThreads(threads);
    governor = Governor();
    governor.setEstimating(estimating);
    warnings.clear();
    recorder.attach(world, worlds);
    restartClock();
    publish();  // a command that has waited for this world to come sees that it has
  }

  void beginWith(std::shared_ptr<const Origin> from, const char* by, const std::string& what) {
    World fresh(from->scene, from->saved);
    post([&] {
      prepareReplacement(by);
      history.add(present(what));
      saved.insert(revision = ++revisions);
      std::atomic_store(&origin, std::move(from));
      setWorld(std::move(fresh));
    });
  }

  void push(Posted command) {
    {
      const std::lock_guard<std::mutex> lock(mutex);
      commands.push_back(std::move(command));
    }
    wake.notify_one();
  }

  // Runs `command` on the thread, between two steps, and waits for it and a snapshot.
  void post(std::function<void()> command) {
    auto promise = std::make_shared<std::promise<void>>();
    std::future<void> done = promise->get_future();
    push({std::move(command), std::move(promise)});
    done.get();
  }

  // One snapshot shows the results of all commands, before any caller continues.
  void runCommands(std::vector<Posted>& todo) {
    std::vector<std::exception_ptr> thrown(todo.size());
    bool awaited = false;
    for (std::size_t k = 0; k < todo.size(); ++k) {
      stale = true;
      awaited = awaited || todo[k].done;
      try {
        todo[k].run();
      } catch (...) {
        thrown[k] = std::current_exception();
      }
    }
    recorder.flush(world);
    if (awaited) publish();
    for (std::size_t k = 0; k < todo.size(); ++k) {
      if (!todo[k].done) continue;
      thrown[k] ? todo[k].done->set_exception(thrown[k]) : todo[k].done->set_value();
    }
  }

  void takeStep() {
    const Clock::time_point start = Clock::now();
    warnings.add(governor.step(world).warnings);
    recorder.stepped(world);
    stale = true;
    const std::lock_guard<std::mutex> lock(mutex);
    pacer.stepped(start, Clock::now(), world.scene().step);
    if (!request) return;
    ++request->taken;
    pace.steps_left = --request->left;
  }

  void advance() {
    if (request && request->go_on && !request->go_on()) endRequest("shutdown");
    if (request || (!pace.paused && Clock::now() >= pacer.nextStep())) takeStep();
    if (request && request->left == 0) endRequest("");
    if (stale && Clock::now() >= pacer.nextPicture()) publish();
  }

  Clock::time_point nextWork() const {
    if (request) return Clock::now();
    Clock::time_point next = pace.paused ? Clock::time_point::max() : pacer.nextStep();
    if (stale) next = std::min(next, pacer.nextPicture());
    return next;
  }

  // Waits until there is something to do. Returns the commands that came, or nothing when it is over.
  std::optional<std::vector<Posted>> await() {
    std::unique_lock<std::mutex> lock(mutex);
    const auto called = [this] { return stop || !commands.empty(); };
    const Clock::time_point next = nextWork();
    if (next == Clock::time_point::max()) {
      wake.wait(lock, called);
    } else if (Clock::now() < next) {
      wake.wait_until(lock, next, called);
    }
    if (stop && commands.empty()) return std::nullopt;
    return std::exchange(commands, {});
  }

  void loop() {
    while (std::optional<std::vector<Posted>> todo = await()) {
      runCommands(*todo);
      advance();
    }
    endRequest("shutdown");
  }
};

namespace {

void checkSpeed(double speed) {
  if (!(std::isfinite(speed) && speed >= 0.0 && speed <= 1e6))
    throw InvalidInput({{"speed", text(speed), "0 (as fast as possible) to 1e6 times real time"}});
}

}  // namespace

Simulator::Simulator(SceneDef scene, const Options& options) {
  checkSpeed(options.speed);
  impl_ = std::make_unique<Impl>(std::move(scene), options);
  impl_->thread = std::thread([this] { impl_->loop(); });
}

Simulator::~Simulator() {
  {
    const std::lock_guard<std::mutex> lock(impl_->mutex);
    impl_->stop = true;
  }
  impl_->wake.notify_one();
  impl_->thread.join();
}

void Simulator::edit(const std::function<void(World&)>& command) {
  impl_->post([&] { command(impl_->world); });
}

std::string Simulator::apply(const std::function<std::string(World&)>& edit) {
  std::string what;
  impl_->post([&] { impl_->apply(edit, what); });
  return what;
}

std::string Simulator::undo() {
  const std::lock_guard<std::mutex> lock(impl_->replacing);
  std::string what;
  impl_->post([&] { what = impl_->goBack(true); });
  return what;
}

std::string Simulator::redo() {
  const std::lock_guard<std::mutex> lock(impl_->replacing);
  std::string what;
  impl_->post([&] { what = impl_->goBack(false); });
  return what;
}

void Simulator::forgetEdits() {
  impl_->post([&] {
    impl_->history = EditHistory();
    impl_->publish();
  });
}

void Simulator::markSaved(std::uint64_t revision) {
  impl_->post([&] { impl_->saved.insert(revision); });
}

std::shared_ptr<const SceneDef> Simulator::loaded() const {
  const std::shared_ptr<const Origin> origin = std::atomic_load(&impl_->origin);
  return {origin, &origin->scene};
}

void Simulator::send(std::function<void(World&)> command) {
  impl_->push({[this, command = std::move(command)] { command(impl_->world); }, nullptr});
}

void Simulator::load(SceneDef scene, const std::optional<SavedState>& saved) {
  const std::lock_guard<std::mutex> lock(impl_->replacing);
  const std::string what = "loaded " + quoted(scene.name);
  impl_->beginWith(std::make_shared<Origin>(Origin{std::move(scene), saved}), "load", what);
}

void Simulator::reset() {
  const std::lock_guard<std::mutex> lock(impl_->replacing);
  // Another origin than before, so that an undo brings the settings back as after a load.
  impl_->beginWith(std::make_shared<Origin>(*std::atomic_load(&impl_->origin)), "reset",
                   "reset " + quoted(loaded()->name));
}

void Simulator::pause() {
  impl_->post([&] {
    impl_->endRequest("pause");
    impl_->setPace(true, impl_->pace.requested_speed);
  });
}

void Simulator::resume() {
  impl_->post([&] {
    impl_->endRequest("resume");
    impl_->setPace(false, impl_->pace.requested_speed);
  });
}

bool Simulator::togglePause() {
  bool paused = false;
  impl_->post([&] {
    paused = impl_->request || !impl_->pace.paused;
    impl_->endRequest("pause");
    impl_->setPace(paused, impl_->pace.requested_speed);
  });
  return paused;
}

StepsTaken Simulator::step(std::uint64_t n, const std::function<bool()>& go_on) {
  if (n < 1 || n > 1000000) throw InvalidInput({{"n", std::to_string(n), "1 to 1,000,000 steps"}});
  std::future<StepsTaken> done;
  impl_->post([&] {
    if (!impl_->pace.paused) throw InvalidInput({{"step", "running", "a paused simulation: pause it first"}});
    if (impl_->request)
      throw InvalidInput({{"step", std::to_string(impl_->request->left) + " steps of another request to go",
                           "one request at a time: wait, or end it by pause"}});
    impl_->request = StepRequest{n, 0, go_on, {}};
    done = impl_->request->done.get_future();
    const std::lock_guard<std::mutex> lock(impl_->mutex);
    impl_->pace.steps_left = n;
  });
  return done.get();
}

void Simulator::setSpeed(double speed) {
  checkSpeed(speed);
  impl_->post([&] { impl_->setPace(impl_->pace.paused, speed); });
}

void Simulator::estimateErrors(bool on) {
  impl_->post([&] { impl_->governor.setEstimating(on), impl_->estimating = on; });
}

bool Simulator::estimatesErrors() const {
  return impl_->estimating;
}

void Simulator::record(std::function<void(Recorded)> keep, double checkpoint_period) {
  if (!(checkpoint_period > 0.0))
    throw InvalidInput({{"checkpoint_period", text(checkpoint_period), "more than 0 s"}});
  impl_->post(
      [&] { impl_->recorder.begin(std::move(keep), checkpoint_period, impl_->world, impl_->worlds); });
}

std::pair<World, std::shared_ptr<const Snapshot>> Simulator::copy() {
  std::optional<World> world;
  std::shared_ptr<const Snapshot> then;
  impl_->post([&] {
    impl_->publish();
    world.emplace(impl_->world), then = impl_->published;
  });
  return {std::move(*world), then};
}

std::shared_ptr<const Snapshot> Simulator::snapshot() const {
  return std::atomic_load(&impl_->published);
}

Pace Simulator::pace() const {
  const std::lock_guard<std::mutex> lock(impl_->mutex);
  Pace pace = impl_->pace;
  if (pace.paused) return pace;
  const Clock::time_point now = Clock::now();
  pace.achieved_speed = impl_->pacer.achievedSpeed(now);
  pace.late = impl_->pacer.late(now);
  pace.lost_time = impl_->pacer.lostTime();
  return pace;
}

}  // namespace rbs
