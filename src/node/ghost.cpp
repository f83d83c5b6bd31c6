// SPDX-License-Identifier: BSD-3-Clause
#include "ghost.h"

#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>

namespace rbs {
namespace {

constexpr float kAlpha = 0.35f;
constexpr std::uint32_t kDivisions = 2;  // of its steps
constexpr double kRepeatPeriod = 5.0;    // s, as of the bodies

// Behind the live simulation, which must not wait for it.
void lowerPriorityOfThisThread() {
  constexpr int kNice = 10;
  setpriority(PRIO_PROCESS, static_cast<id_t>(syscall(SYS_gettid)), kNice);
}

}  // namespace

Ghost::Ghost(ros::NodeHandle& node, Simulator& simulator)
    : simulator_(simulator), markers_(node, "ghost", TfMode::None, "", kRepeatPeriod) {}

Ghost::~Ghost() {
  show(false);
}

void Ghost::show(bool on) {
  std::lock_guard<std::mutex> lock(mutex_);
  stop_ = true;
  if (thread_.joinable()) thread_.join();
  time_ = simulator_.snapshot()->time;
  shown_ = on;
  if (!on) {
    Snapshot nothing;
    nothing.bodies = std::make_shared<std::vector<BodyDescription>>();
    markers_.publish(nothing);
    return;
  }
  stop_ = false;
  thread_ = std::thread([this] { run(); });
}

std::optional<double> Ghost::lag() const {
  if (!shown_) return std::nullopt;
  return std::max(0.0, simulator_.snapshot()->time - time_);
}

void Ghost::run() {
  lowerPriorityOfThisThread();
  constexpr auto kPeriod = std::chrono::milliseconds(33);
  std::optional<World> world;
  std::uint64_t edits = 0;
  auto published = std::chrono::steady_clock::now() - kPeriod;
  while (!stop_) {
    const std::shared_ptr<const Snapshot> live = simulator_.snapshot();
    if (!world || live->edits != edits) {
      auto [copy, then] = simulator_.copy();
      edits = then->edits;
      world.emplace(std::move(copy));
      Setting reference(Fidelity::Reference);
      reference.divisions = kDivisions;
      world->setGoal(std::nullopt);
      world->setFidelity(reference);
      time_ = world->time();
    }
    if (world->time() < live->time - 0.5 * live->step)
      world->step(), time_ = world->time();
    else
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    const auto now = std::chrono::steady_clock::now();
    if (now - published < kPeriod) continue;
    publish(world->snapshot());
    published = now;
  }
}

// Of what moves, in its colours.
void Ghost::publish(const Snapshot& snapshot) {
  if (snapshot.bodies != described_) {
    auto drawn = std::make_shared<std::vector<BodyDescription>>();
    for (BodyDescription body : *snapshot.bodies) {
      body.color[3] = kAlpha;
      if (body.kind == BodyKind::Dynamic) drawn->push_back(body);
    }
    described_ = snapshot.bodies;
    drawn_ = std::move(drawn);
  }
  Snapshot ghost;
  ghost.bodies = drawn_;
  ghost.view = snapshot.view;
  for (std::size_t k = 0; k < snapshot.states.size(); ++k)
    if ((*snapshot.bodies)[k].kind == BodyKind::Dynamic) ghost.states.push_back(snapshot.states[k]);
  markers_.publish(ghost);
}

}  // namespace rbs
