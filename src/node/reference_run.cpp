// SPDX-License-Identifier: BSD-3-Clause
#include "reference_run.h"

#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <future>
#include <thread>

namespace rbs {
namespace {

constexpr float kAlpha = 0.35f;
constexpr double kRepeatPeriod = 5.0;  // s, as for the markers of the live bodies
/// How long a step of the reference run may delay the end of the node.
constexpr auto kPatience = std::chrono::seconds(2);

Setting referenceSettings() {
  Setting setting(Fidelity::Reference);
  setting.divisions = 2;
  return setting;
}

// The live simulation goes first: it must not wait for the reference run.
void lowerPriorityOfThisThread() {
  constexpr int kNice = 10;
  setpriority(PRIO_PROCESS, static_cast<id_t>(syscall(SYS_gettid)), kNice);
}

}  // namespace

/// What the thread of a reference run owns together with the ReferenceRun.
struct ReferenceRun::Run {
  std::mutex mutex;  ///< held by the thread whenever it uses the ReferenceRun
  std::atomic<bool> shown{
      true};  ///< set under the mutex; once it is false, the thread no longer uses the ReferenceRun
  std::atomic<double> time{0.0};  ///< physics time that the run has reached, s
  std::promise<void> ended;
};

ReferenceRun::ReferenceRun(ros::NodeHandle& node, Simulator& simulator)
    : simulator_(simulator), markers_(node, "ghost", "ghost", TfMode::None, "", kRepeatPeriod) {}

ReferenceRun::~ReferenceRun() {
  const std::shared_ptr<Run> run = run_;
  show(false);
  if (run) run->ended.get_future().wait_for(kPatience);
}

void ReferenceRun::show(bool on) {
  std::lock_guard<std::mutex> lock(mutex_);
  if (run_) {
    std::lock_guard<std::mutex> lock_run(run_->mutex);
    run_->shown = false;
  }
  comparison_.clear();
  hide();
  std::shared_ptr<Run> run;
  if (on) {
    run = std::make_shared<Run>();
    run->time = simulator_.snapshot()->time;
    std::thread([this, run] { follow(*run); }).detach();  // so that nobody waits for its step
  }
  std::atomic_store(&run_, run);
}

std::optional<double> ReferenceRun::lag(double now) const {
  const std::shared_ptr<Run> run = std::atomic_load(&run_);
  if (!run || !run->shown) return std::nullopt;
  return std::max(0.0, now - run->time);
}

void ReferenceRun::compareWith(const Snapshot& live) {
  if (lag(live.time)) comparison_.addLive(live);
}

void ReferenceRun::follow(Run& run) {
  lowerPriorityOfThisThread();
  try {
    keepUp(run);
  } catch (const std::exception& error) {
    std::lock_guard<std::mutex> lock(run.mutex);
    if (run.shown) {
      ROS_ERROR_STREAM("the reference run has ended: " << error.what());
      hide();
      run.shown = false;
    }
  }
  run.ended.set_value();
}

// Steps the reference run without holding the mutex.
void ReferenceRun::keepUp(Run& run) {
  constexpr auto kPeriod = std::chrono::milliseconds(33), kRest = std::chrono::milliseconds(5);
  std::optional<World> world;
  std::uint64_t edits = 0;
  auto published = std::chrono::steady_clock::now() - kPeriod;
  while (true) {
    bool behind = false;
    {
      std::lock_guard<std::mutex> lock(run.mutex);
      if (!run.shown) return;
      const std::shared_ptr<const Snapshot> live = simulator_.snapshot();
      if (!world || live->edits != edits) {
        auto [copy, then] = simulator_.copy();
        edits = then->edits;
        world.emplace(std::move(copy));
        world->setGoal(std::nullopt);
        world->setFidelity(referenceSettings());
        run.time = world->time();
      }
      if (comparison_.wants(world->steps(), edits)) comparison_.compare(world->snapshot(), edits);
      const auto now = std::chrono::steady_clock::now();
      if (now - published >= kPeriod) publish(world->snapshot()), published = now;
      behind = world->time() < live->time - 0.5 * live->step;
    }
    if (behind)
      world->step(), run.time = world->time();
    else
      std::this_thread::sleep_for(kRest);
  }
}

void ReferenceRun::hide() {
  Snapshot nothing;
  nothing.bodies = std::make_shared<std::vector<BodyDescription>>();
  markers_.publish(nothing);
}

// Draws the dynamic bodies of the reference run, translucent, in their own colours.
void ReferenceRun::publish(const Snapshot& snapshot) {
  if (snapshot.bodies != described_) {
    auto drawn = std::make_shared<std::vector<BodyDescription>>();
    for (BodyDescription body : *snapshot.bodies) {
      body.color[3] = kAlpha;
      if (body.kind == BodyKind::Dynamic) drawn->push_back(body);
    }
    described_ = snapshot.bodies;
    drawn_ = std::move(drawn);
  }
  Snapshot overlay;
  overlay.bodies = drawn_;
  overlay.view = snapshot.view;
  for (std::size_t k = 0; k < snapshot.states.size(); ++k)
    if ((*snapshot.bodies)[k].kind == BodyKind::Dynamic) overlay.states.push_back(snapshot.states[k]);
  markers_.publish(overlay);
}

}  // namespace rbs
