// SPDX-License-Identifier: BSD-3-Clause
#include "status_publisher.h"

#include "convert.h"
#include "names.h"
#include "pace.h"
#include "words.h"

#include <rigid_body_sim/Status.h>
#include <rigid_body_sim/Wind.h>

#include <algorithm>

namespace rbs {
namespace {

rigid_body_sim::StageStatus stageMsg(const StageInfo& stage) {
  rigid_body_sim::StageStatus msg;
  msg.name = stage.name;
  msg.active = stage.active;
  msg.reason = stage.reason;
  msg.items = stage.items;
  msg.unit = stage.unit;
  msg.seconds = stage.seconds;
  msg.part_of = stage.part_of;
  return msg;
}

rigid_body_sim::IslandStatus islandMsg(const IslandResiduals& island) {
  rigid_body_sim::IslandStatus msg;
  msg.bodies = island.bodies;
  msg.contacts = island.contacts;
  msg.method = island.method;
  msg.iterations = island.iterations;
  msg.signorini = finite(island.signorini);
  msg.coulomb = finite(island.coulomb);
  msg.dissipation = finite(island.dissipation);
  msg.converged = island.converged;
  msg.deepest_penetration = finite(island.deepest_penetration);
  msg.energy_change = finite(island.energy_change);
  msg.turn = finite(island.turn);
  return msg;
}

// A heap of a thousand bodies has hundreds of islands at times; nobody reads them all.
void fillResiduals(std::vector<IslandResiduals> islands, rigid_body_sim::Status& msg) {
  constexpr std::size_t kMost = 20;
  std::stable_sort(islands.begin(), islands.end(), [](const IslandResiduals& a, const IslandResiduals& b) {
    return a.contacts > b.contacts;
  });
  if (islands.size() > kMost) islands.resize(kMost);
  for (const IslandResiduals& island : islands) msg.residuals.push_back(islandMsg(island));
}

void fillReport(const StepReport& report, rigid_body_sim::Status& msg) {
  msg.step_seconds = report.seconds;
  msg.pairs = report.pairs;
  msg.overlap_tests = report.overlap_tests;
  msg.axis_queries = report.axis_queries;
  msg.axes_kept = report.axes_kept;
  msg.contacts = report.contacts;
  msg.islands = report.islands;
  msg.flying = report.flying;
  msg.impacts = report.impacts;
  msg.deferred_impacts = report.deferred_impacts;
  msg.repeated = report.repeated;
  msg.deepest_penetration = finite(report.deepest_penetration);
}

void fillTotals(const Totals& totals, rigid_body_sim::Status& msg) {
  msg.kinetic_energy = finite(totals.kinetic_energy);
  msg.potential_energy = finite(totals.potential_energy);
  msg.momentum = toMsg(totals.momentum);
  msg.angular_momentum = toMsg(totals.angular_momentum);
}

void fillSettings(const Snapshot& snapshot, rigid_body_sim::Status& msg) {
  msg.fidelity = settingName(snapshot.fidelity);
  msg.dial_reason = snapshot.dial_reason;
  const Goal goal = snapshot.goal.value_or(Goal{});
  msg.max_error = goal.max_error.value_or(0.0);
  msg.max_step_ms = goal.max_step_ms.value_or(0.0);
  if (!snapshot.estimate) return;
  const ErrorEstimate& estimate = *snapshot.estimate;
  rigid_body_sim::ErrorEstimate& out = msg.estimate.emplace_back();
  out.distance = finite(estimate.error.distance);
  out.angle = finite(estimate.error.angle);
  out.energy = finite(estimate.error.energy);
  out.window = estimate.window;
  out.fidelity = settingName(estimate.setting);
  out.beside = settingName(estimate.beside);
  out.beside_ms = estimate.beside_ms;
}

void fillPace(const Pace& pace, const Snapshot& snapshot, rigid_body_sim::Status& msg) {
  msg.paused = pace.paused;
  msg.requested_speed = pace.requested_speed;
  msg.achieved_speed = finite(pace.achieved_speed);
  msg.lost_time = pace.lost_time;
  msg.bottleneck = bottleneck(pace, snapshot);
  msg.steps_left = pace.steps_left;
}

rigid_body_sim::Status statusMsg(const Timeline::Moment& moment, const Pace& pace) {
  const Snapshot& snapshot = *moment.snapshot;
  rigid_body_sim::Status msg;
  msg.header.stamp = moment.stamp;
  msg.header.frame_id = worldFrame();
  msg.scene = snapshot.scene;
  msg.view_eye = toPoint(snapshot.view.eye);
  msg.view_target = toPoint(snapshot.view.target);
  msg.time = snapshot.time;
  msg.steps = snapshot.steps;
  msg.world = snapshot.world;
  msg.recorded = snapshot.recorded;
  msg.step = snapshot.step;
  msg.bodies = snapshot.bodies->size();
  msg.gravity = toMsg(snapshot.gravity);
  msg.wind = snapshot.air.wind;
  msg.undo = snapshot.undo;
  msg.redo = snapshot.redo;
  msg.unsaved = snapshot.unsaved;
  msg.hash = hexadecimal(snapshot.hash);
  fillPace(pace, snapshot, msg);
  msg.step_cpu_seconds = snapshot.step_cpu_seconds;
  fillReport(snapshot.report, msg);
  fillTotals(snapshot.totals, msg);
  fillSettings(snapshot, msg);
  fillResiduals(snapshot.report.residuals, msg);
  for (const StageInfo& stage : snapshot.pipeline) msg.pipeline.push_back(stageMsg(stage));
  for (const auto& [effect, is_on] : snapshot.effects)
    (is_on ? msg.forced_on : msg.forced_off).push_back(effectName(effect));
  return msg;
}

rigid_body_sim::Wind windMsg(const Timeline::Moment& moment) {
  const AirState& air = moment.snapshot->air;
  rigid_body_sim::Wind msg;
  msg.header.stamp = moment.stamp;
  msg.header.frame_id = worldFrame();
  msg.air = air.air;
  msg.enabled = air.wind;
  msg.density = air.density;
  msg.mean = toMsg(air.mean);
  msg.gust = air.gust;
  msg.velocity = toMsg(air.velocity);
  return msg;
}

std::size_t frozenBodies(const Snapshot& snapshot) {
  return std::count_if(snapshot.bodies->begin(), snapshot.bodies->end(),
                       [](const BodyDescription& body) { return body.frozen; });
}

// It may be changed while the node runs.
double diagnosticPeriod() {
  constexpr double kUsual = 1.0, kShortest = 0.01, kLongest = 1e6;  // s
  double period = kUsual;
  ros::param::getCached("~diagnostic_period", period);
  if (period >= kShortest && period <= kLongest) return period;  // which NaN is not
  ROS_ERROR_NAMED("status", "~diagnostic_period: %g (allowed: %g to %g); it is set to %g s", period,
                  kShortest, kLongest, kUsual);
  ros::param::set("~diagnostic_period", kUsual);
  return kUsual;
}

}  // namespace

StatusPublisher::StatusPublisher(ros::NodeHandle& node, const Simulator& simulator,
                                 const ReferenceRun& reference_run)
    : simulator_(simulator),
      reference_run_(reference_run),
      status_(Topic::of<rigid_body_sim::Status>(node, "status", 10)),
      wind_(Topic::of<rigid_body_sim::Wind>(node, "wind", 10)),
      diagnostics_(node.advertise<diagnostic_msgs::DiagnosticArray>("/diagnostics", 1)) {}

void StatusPublisher::publish(const Timeline::Moment& moment) {
  const std::vector<Warning> warnings = new_warnings_.takeWithLast(*moment.snapshot);
  if (status_.wanted(true)) {
    rigid_body_sim::Status msg = statusMsg(moment, simulator_.pace());
    msg.estimates_error = simulator_.estimatesErrors();
    for (const Warning& warning : warnings) msg.warnings.push_back(warning.kind + ": " + warning.text);
    if (const std::optional<double> lag = reference_run_.lag(msg.time)) msg.ghost_lag.push_back(*lag);
    status_.send(msg);
  }
  if (wind_.wanted(true)) wind_.send(windMsg(moment));
}

void StatusPublisher::diagnose(const Timeline::Moment& moment) {
  const ros::SteadyTime now = ros::SteadyTime::now();
  if (!last_diagnosis_.isZero() && (now - last_diagnosis_).toSec() < diagnosticPeriod()) return;
  last_diagnosis_ = now;
  diagnostic_updater::DiagnosticStatusWrapper status;
  status.name = ros::this_node::getName().substr(1) + ": simulation";
  status.hardware_id = "none";
  describeSimulation(*moment.snapshot, status);
  diagnostic_msgs::DiagnosticArray msg;
  msg.header.stamp = moment.stamp;
  msg.status.push_back(status);
  diagnostics_.publish(msg);
}

void StatusPublisher::describeSimulation(const Snapshot& snapshot,
                                         diagnostic_updater::DiagnosticStatusWrapper& status) {
  using Level = diagnostic_msgs::DiagnosticStatus;
  const Pace pace = simulator_.pace();
  const std::size_t frozen = frozenBodies(snapshot);
  status.summary(Level::OK, inWords(pace));
  if (fallsBehind(pace))
    status.mergeSummary(Level::WARN, "below the requested speed: " + bottleneck(pace, snapshot));
  for (const Warning& warning : undiagnosed_.takeWithLast(snapshot))
    status.mergeSummary(Level::WARN, warning.text);
  if (frozen > 0) status.mergeSummary(Level::ERROR, bodyCount(frozen) + " frozen: delete or reset");
  status.add("scene", snapshot.scene);
  status.add("bodies", snapshot.bodies->size());
  status.add("frozen bodies", frozen);
  status.add("requested real-time factor", pace.requested_speed);
  status.add("achieved real-time factor", pace.achieved_speed);
  status.add("simulated time lost, s", pace.lost_time);
  status.add("wall time of the last step, s", snapshot.report.seconds);
  status.add("deepest penetration, m", snapshot.report.deepest_penetration);
}

std::string statusLine(const Snapshot& snapshot, const Pace& pace) {
  const std::string slowed_by = bottleneck(pace, snapshot);
  return words(snapshot.scene, "  ", snapshot.time, " s  ", inWords(pace),
               slowed_by.empty() ? "" : " (" + slowed_by + ")", "  ", bodyCount(snapshot.bodies->size()),
               "  ", snapshot.report.contacts, " contacts  ", 1e3 * snapshot.report.seconds,
               " ms per step  penetration ", snapshot.report.deepest_penetration, " m");
}

}  // namespace rbs
