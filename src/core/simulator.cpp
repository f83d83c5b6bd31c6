// SPDX-License-Identifier: BSD-3-Clause
#include "rigid_body_sim/simulator.h"

#include "rigid_body_sim/governor.h"
#include "text.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <deque>
#include <future>
#include <mutex>
#include <thread>

namespace rbs {

namespace {

using Clock = std::chrono::steady_clock;

double seconds(Clock::duration d) {
  return std::chrono::duration<double>(d).count();
}
Clock::duration duration(double s) {
  return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(s));
}

// Wall time after which lost steps are dropped instead of made up for, s: a simulation that cannot keep up
// runs slower, it does not freeze.
constexpr double kLargestLag = 0.1;
// How long the achieved speed is averaged over, s.
constexpr double kSpeedWindow = 1.0;

// Physics time over wall time, measured over about the last second.
class SpeedMeter {
 public:
  void reset() { samples_.clear(); }
  void add(Clock::time_point now, double physics_time) {
    samples_.push_back({now, physics_time});
    while (samples_.size() > 2 && seconds(now - samples_.front().wall) > kSpeedWindow) samples_.pop_front();
  }
  double speed() const {
    if (samples_.size() < 2) return 0.0;
    const double wall = seconds(samples_.back().wall - samples_.front().wall);
    return wall > 0.0 ? (samples_.back().physics - samples_.front().physics) / wall : 0.0;
  }

 private:
  struct Sample {
    Clock::time_point wall;
    double physics;
  };
  std::deque<Sample> samples_;
};

}  // namespace

struct Simulator::Impl {
  // What the thread alone touches.
  World world;
  Governor governor;
  std::uint64_t edits_before = 0, versions_before = 0;  // of the worlds before it, so that the sums only grow
  std::uint64_t worlds = 0;                             // how many came before it
  SceneDef loaded;
  std::optional<SavedState> loaded_state;
  bool paused;
  double speed;
  std::atomic<bool> estimating{false};
  Clock::time_point next_step = Clock::now();  // when the next step is due
  SpeedMeter meter;

  // What others share with it, under the mutex.
  std::mutex mutex;
  std::condition_variable wake;
  std::deque<std::packaged_task<void()>> commands;
  bool stop = false;
  std::shared_ptr<const Snapshot> published;  // read and written by atomic_load and atomic_store

  std::thread thread;

  Impl(SceneDef scene, const Options& options)
      : world(scene), loaded(std::move(scene)), paused(options.paused), speed(options.speed) {
    publish();
  }

  void publish() {
    Snapshot snapshot = world.snapshot();
    snapshot.edits += edits_before;
    snapshot.description_version += versions_before;
    snapshot.world = worlds;
    snapshot.paused = paused;
    snapshot.estimate = governor.estimate();
    snapshot.dial_reason = governor.reason();
    snapshot.requested_speed = speed;
    snapshot.achieved_speed = paused ? 0.0 : meter.speed();
    std::atomic_store(&published, std::make_shared<const Snapshot>(std::move(snapshot)));
  }

  void restartClock() {
    next_step = Clock::now();
    meter.reset();
  }

  void replaceWorld(World fresh) {
    edits_before = published->edits + 1;
    versions_before = published->description_version + 1;
    world = std::move(fresh);
    ++worlds;
    governor = Governor();
    governor.setEstimating(estimating);
    restartClock();
    publish();
  }

  // Runs `command` on the thread, between two steps, and waits for it.
  void post(std::function<void()> command) {
    std::packaged_task<void()> task(std::move(command));
    std::future<void> done = task.get_future();
    {
      const std::lock_guard<std::mutex> lock(mutex);
      commands.push_back(std::move(task));
    }
    wake.notify_one();
    done.get();
  }

  bool stepIsDue() const { return !paused && (speed == 0.0 || Clock::now() >= next_step); }

  void takeStep() {
    governor.step(world);
    const auto now = Clock::now();
    meter.add(now, world.time());
    if (speed > 0.0) next_step += duration(world.scene().step / speed);
    if (seconds(now - next_step) > kLargestLag) next_step = now;
    // Steps that are made up for are not shown one by one.
    if (speed == 0.0 || now < next_step) publish();
  }

  void run() {
    while (true) {
      std::deque<std::packaged_task<void()>> todo;
      {
        std::unique_lock<std::mutex> lock(mutex);
        const auto ready = [this] { return stop || !commands.empty(); };
        if (paused) {
          wake.wait(lock, ready);
        } else if (!stepIsDue()) {
          wake.wait_until(lock, next_step, ready);
        }
        if (stop && commands.empty()) return;
        todo.swap(commands);
      }
      for (std::packaged_task<void()>& command : todo) command();
      if (stepIsDue()) takeStep();
    }
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
  impl_->thread = std::thread([this] { impl_->run(); });
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
  impl_->post([&] {
    command(impl_->world);
    impl_->publish();
  });
}

void Simulator::load(SceneDef scene, const std::optional<SavedState>& saved) {
  impl_->post([&] {
    impl_->replaceWorld(World(scene, saved));
    impl_->loaded = std::move(scene);
    impl_->loaded_state = saved;
  });
}

void Simulator::reset() {
  impl_->post([&] { impl_->replaceWorld(World(impl_->loaded, impl_->loaded_state)); });
}

void Simulator::pause() {
  impl_->post([&] {
    impl_->paused = true;
    impl_->publish();
  });
}

void Simulator::resume() {
  impl_->post([&] {
    impl_->paused = false;
    impl_->restartClock();
    impl_->publish();
  });
}

bool Simulator::togglePause() {
  bool paused = false;
  impl_->post([&] {
    paused = impl_->paused = !impl_->paused;
    impl_->restartClock();
    impl_->publish();
  });
  return paused;
}

void Simulator::step(std::uint64_t n) {
  if (n < 1 || n > 1000000) throw InvalidInput({{"n", std::to_string(n), "1 to 1,000,000 steps"}});
  impl_->post([&] {
    if (!impl_->paused) throw InvalidInput({{"step", "running", "a paused simulation: pause it first"}});
    for (std::uint64_t k = 0; k < n; ++k) {
      impl_->governor.step(impl_->world);
      if (k % 16 == 15) impl_->publish();
    }
    impl_->publish();
  });
}

void Simulator::setSpeed(double speed) {
  checkSpeed(speed);
  impl_->post([&] {
    impl_->speed = speed;
    impl_->restartClock();
    impl_->publish();
  });
}

void Simulator::estimateErrors(bool on) {
  impl_->post([&] { impl_->governor.setEstimating(on), impl_->estimating = on; });
}

bool Simulator::estimatesErrors() const {
  return impl_->estimating;
}

std::pair<World, std::shared_ptr<const Snapshot>> Simulator::copy() {
  std::optional<World> world;
  std::shared_ptr<const Snapshot> then;
  impl_->post([&] { world.emplace(impl_->world), then = impl_->published; });
  return {std::move(*world), then};
}

std::shared_ptr<const Snapshot> Simulator::snapshot() const {
  return std::atomic_load(&impl_->published);
}

}  // namespace rbs
