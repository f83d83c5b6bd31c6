// SPDX-License-Identifier: BSD-3-Clause
// Services that start, stop and pace the simulation.
#include "services.h"

#include "words.h"

#include <rigid_body_sim/SetSpeed.h>
#include <rigid_body_sim/Step.h>
#include <std_srvs/Trigger.h>

#include <algorithm>
#include <stdexcept>

namespace rbs {
namespace {

// A call of step occupies one thread until its steps are done. The other thread refuses a second call
// meanwhile.
constexpr int kStepThreads = 2;

}  // namespace

using rigid_body_sim::SetSpeed;
using rigid_body_sim::Step;
using std_srvs::Trigger;

Services::Services(Session& session, ReferenceRun& reference_run)
    : session_(session),
      simulator_(session.simulator()),
      node_("~"),
      accuracy_(node_, simulator_, session.timeline()),
      reference_run_(reference_run),
      step_spinner_(kStepThreads, &step_queue_) {
  offerBodyEdits();
  offerPushes();
  offerSurroundings();
  offerReading();
  offerQueries();
  offerRun();
  offerScenes();
  offerAccuracy();
  step_spinner_.start();
}

namespace {

// The steps end with the node, however many there are to go.
std::string takeSteps(Simulator& simulator, const Step::Request& request, Step::Response& response) {
  const std::uint32_t n = std::max(request.n, 1u);
  const StepsTaken taken = simulator.step(n, [] { return ros::ok(); });
  response.taken = taken.steps;
  response.time = simulator.snapshot()->time;
  if (!taken.ended_by.empty())
    throw std::runtime_error(words("ended by ", taken.ended_by, " after ", taken.steps, " of ", n,
                                   " steps, at ", response.time, " s"));
  return words("took ", n, n == 1 ? " step" : " steps", ", now at ", response.time, " s");
}

}  // namespace

void Services::offerRun() {
  const auto stateInWords = [this] {
    const std::shared_ptr<const Snapshot> snapshot = simulator_.snapshot();
    return words(snapshot->paused ? "paused" : "running", " at ", snapshot->time, " s");
  };
  offer<Trigger>("pause", [=](const Trigger::Request&, Trigger::Response&) {
    simulator_.pause();
    return stateInWords();
  });
  offer<Trigger>("resume", [=](const Trigger::Request&, Trigger::Response&) {
    simulator_.resume();
    return stateInWords();
  });
  offer<Trigger>("toggle_pause", [=](const Trigger::Request&, Trigger::Response&) {
    simulator_.togglePause();
    return stateInWords();
  });
  offer<SetSpeed>("set_speed", [this](const SetSpeed::Request& request, SetSpeed::Response&) {
    simulator_.setSpeed(request.factor);
    return request.factor == 0.0 ? "as fast as possible"
                                 : words("requested real-time factor: ", request.factor);
  });
  offer<Step>(
      "step",
      [this](const Step::Request& request, Step::Response& response) {
        return takeSteps(simulator_, request, response);
      },
      &step_queue_);
  offer<Trigger>("reset", [this](const Trigger::Request&, Trigger::Response&) {
    session_.reset();
    return words("reset '", simulator_.snapshot()->scene, "'");
  });
  offer<Trigger>("undo", [this](const Trigger::Request&, Trigger::Response&) {
    return words("undone: ", session_.undo());
  });
  offer<Trigger>("redo", [this](const Trigger::Request&, Trigger::Response&) {
    return words("redone: ", session_.redo());
  });
}

}  // namespace rbs
