// SPDX-License-Identifier: BSD-3-Clause
// Services for solver settings and accuracy: choose them, measure their cost, control them by a goal.
#include "services.h"

#include "words.h"

#include <rigid_body_sim/AccuracyGoal.h>
#include <rigid_body_sim/MeasureAccuracy.h>
#include <rigid_body_sim/SetFidelity.h>
#include <rigid_body_sim/TuneFidelity.h>
#include <std_srvs/SetBool.h>
#include <std_srvs/Trigger.h>

namespace rbs {
namespace {

using rigid_body_sim::AccuracyGoal;
using rigid_body_sim::MeasureAccuracy;
using rigid_body_sim::SetFidelity;
using rigid_body_sim::TuneFidelity;
using std_srvs::SetBool;
using std_srvs::Trigger;

/// Applies solver settings and ends the goal. Returns the reply in words.
std::string applySettings(World& world, const Setting& setting) {
  const bool same = world.scene().fidelity == setting;
  world.setFidelity(setting);
  world.setGoal(std::nullopt);
  return words("solver settings", same ? " unchanged: " : ": ", settingName(setting));
}

std::string setFidelity(World& world, const SetFidelity::Request& request, SetFidelity::Response& response) {
  const std::vector<StageInfo> before = world.pipeline();
  const std::string message = applySettings(world, fidelityNamed(request.fidelity));
  response.changes = stageChanges(before, world.pipeline());
  return message;
}

std::string tuneFidelity(World& world, const TuneFidelity::Request& request,
                         TuneFidelity::Response& response) {
  Setting setting = request.preset.empty() ? world.scene().fidelity.preset : fidelityNamed(request.preset);
  if (request.divisions != 0) setting.divisions = request.divisions;
  if (request.sub_steps != 0) setting.sub_steps = request.sub_steps;
  if (request.tolerance != 0.0) setting.tolerance = request.tolerance;
  if (request.max_solve_ms != 0.0) setting.max_solve_ms = request.max_solve_ms;
  const std::string message = applySettings(world, setting);
  response.fidelity = settingName(setting);
  return message;
}

Goal goalOf(const AccuracyGoal::Request& request) {
  Goal goal;
  if (request.max_error != 0.0) goal.max_error = request.max_error;
  if (request.max_step_ms != 0.0) goal.max_step_ms = request.max_step_ms;
  const std::vector<Problem> problems = validate(goal);
  if (!problems.empty()) throw InvalidInput(problems);
  return goal;
}

std::string goalInWords(const Goal& goal) {
  return goal.max_error ? words("an error of at most ", *goal.max_error, " m per second simulated")
                        : words("at most ", *goal.max_step_ms, " ms per step");
}

std::string seek(World& world, const AccuracyGoal::Request& request, AccuracyGoal::Response& response) {
  const Goal goal = goalOf(request);
  world.setGoal(goal);
  response.fidelity = settingName(world.scene().fidelity);
  return words("goal: ", goalInWords(goal), "; the solver settings adapt to it, beginning with ",
               response.fidelity, goal.max_step_ms ? "; results now depend on the speed of the machine" : "");
}

/// Applies the solver settings that a study recommends.
std::string apply(World& world, const AccuracyStudy& study, const Goal& goal,
                  AccuracyGoal::Response& response) {
  const SettingCost* cost =
      goal.max_error ? cheapestWithin(study, *goal.max_error) : mostAccurateWithin(study, *goal.max_step_ms);
  if (!cost) throw std::runtime_error("none of the measured solver settings has " + goalInWords(goal));
  const std::string message = applySettings(world, cost->setting);
  response.fidelity = settingName(cost->setting);
  return words(message, ": ", cost->at_most ? "at most " : "", cost->error.distance,
               " m per second simulated, ", cost->step_ms, " ms per step, measured on '", study.scene, "'",
               study.complete
                   ? ""
                   : words(" in ", study.windows, study.windows == 1 ? " window" : " windows",
                           " of an accuracy study that ended early: more of them may find larger errors"));
}

}  // namespace

void Services::offerAccuracy() {
  offerEdit<SetFidelity>("set_fidelity", setFidelity);
  offerEdit<TuneFidelity>("tune_fidelity", tuneFidelity);
  offerEdit<AccuracyGoal>("seek_accuracy", seek);
  offer<AccuracyGoal>("apply_accuracy",
                      [this](const AccuracyGoal::Request& request, AccuracyGoal::Response& response) {
                        const Goal goal = goalOf(request);
                        std::string message;
                        simulator_.edit([&](World& world) {
                          message = apply(world, accuracy_.foundFor(world.snapshot()), goal, response);
                        });
                        return message;
                      });
  offer<MeasureAccuracy>("measure_accuracy", [this](const MeasureAccuracy::Request& request,
                                                    MeasureAccuracy::Response& response) {
    AccuracyOptions options;
    if (request.seconds != 0.0) options.seconds = request.seconds;
    if (request.window != 0.0) options.window = request.window;
    if (request.windows != 0) options.windows = request.windows;
    if (request.max_cpu_seconds != 0.0) options.max_cpu_seconds = request.max_cpu_seconds;
    response.job = accuracy_.start(options);
    return words("measures for up to ", options.max_cpu_seconds, " s of CPU time (study ", response.job, ")");
  });
  offer<Trigger>("stop_accuracy", [this](const Trigger::Request&, Trigger::Response&) {
    return accuracy_.stop() ? "stopped; the results so far are kept" : "no accuracy study was running";
  });
  offer<SetBool>("estimate_error", [this](const SetBool::Request& request, SetBool::Response&) {
    simulator_.estimateErrors(request.data);
    return request.data ? "error estimation on: a second simulation with half the step size runs alongside"
                        : "error estimation off";
  });
  offer<SetBool>("show_ghost", [this](const SetBool::Request& request, SetBool::Response&) {
    reference_run_.show(request.data);
    return request.data ? "reference run on: it starts from the present state" : "reference run off";
  });
}

}  // namespace rbs
