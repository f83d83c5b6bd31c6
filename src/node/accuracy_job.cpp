// SPDX-License-Identifier: BSD-3-Clause
#include "accuracy_job.h"

#include "../tools/study_json.h"
#include "convert.h"
#include "same_scene.h"
#include "words.h"

#include "rigid_body_sim/scenes.h"

#include <rigid_body_sim/AccuracyStudy.h>

#include <boost/filesystem.hpp>

#include <chrono>
#include <utility>

namespace rbs {
namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr auto kPoll = 100ms;
/// How long the program may take to end after SIGTERM, and how long it may be silent without using CPU time.
constexpr auto kGrace = 2s, kSilence = 20s;
constexpr double kComparePeriod = 0.2;  // s

// The program that measures is installed beside that of the node.
std::string program() {
  return (boost::filesystem::read_symlink("/proc/self/exe").parent_path() / "scene_accuracy").string();
}

std::vector<std::string> commandFor(const AccuracyOptions& options) {
  const auto option = [](const char* name, auto value) { return words("--", name, "=", value); };
  return {program(),
          "-",
          "--progress",
          "--background",
          option("seconds", options.seconds),
          option("window", options.window),
          option("windows", options.windows),
          option("max-seconds", options.max_cpu_seconds)};
}

rigid_body_sim::SettingCost costMessage(const SettingCost& cost) {
  rigid_body_sim::SettingCost msg;
  msg.name = settingName(cost.setting);
  msg.preset = fidelityName(cost.setting.preset);
  msg.divisions = cost.setting.divisions;
  msg.sub_steps = cost.setting.sub_steps.value_or(0);
  msg.tolerance = cost.setting.tolerance.value_or(0.0);
  msg.step_ms = cost.step_ms;
  msg.error = finite(cost.error.distance);
  msg.worst_error = finite(cost.worst.distance);
  msg.angle_error = finite(cost.error.angle);
  msg.energy_error = finite(cost.error.energy);
  msg.at_most = cost.at_most;
  return msg;
}

}  // namespace

AccuracyJob::AccuracyJob(ros::NodeHandle& node, Simulator& simulator, Timeline& timeline)
    : simulator_(simulator),
      timeline_(timeline),
      publisher_(node.advertise<rigid_body_sim::AccuracyStudy>("accuracy", 10, true)),
      compare_(node.createWallTimer(ros::WallDuration(kComparePeriod),
                                    [this](const ros::WallTimerEvent&) { compare(); })) {}

AccuracyJob::~AccuracyJob() {
  compare_.stop();
  stop();
}

std::uint32_t AccuracyJob::start(const AccuracyOptions& options) {
  const std::vector<Problem> problems = validate(options);
  if (!problems.empty()) throw InvalidInput(problems);
  std::lock_guard<std::mutex> lock(running_);
  auto [world, then] = simulator_.copy();
  std::string scene =
      writeScene(world.capture(), world.captureState());  // may refuse: nothing has changed then
  end();
  std::uint32_t job = 0;
  {
    std::lock_guard<std::mutex> lock_known(mutex_);
    job = known_.job + 1;
    known_ = {job, {}, 0.0, false, then, ""};
  }
  stop_ = false;
  std::promise<void> started;
  std::future<void> running = started.get_future();
  reader_ =
      std::thread(&AccuracyJob::follow, this, commandFor(options), std::move(scene), std::move(started));
  running.get();
  return job;
}

bool AccuracyJob::stop() {
  std::lock_guard<std::mutex> lock(running_);
  bool was_running = false;
  {
    std::lock_guard<std::mutex> lock_known(mutex_);
    was_running = reader_.joinable() && !known_.done;
  }
  end();
  return was_running;
}

void AccuracyJob::end() {
  stop_ = true;
  if (reader_.joinable()) reader_.join();
}

// The thread of a study. It alone starts, reads and reaps the program.
void AccuracyJob::follow(std::vector<std::string> command, std::string scene, std::promise<void> started) {
  std::optional<ChildProcess> program;
  try {
    program.emplace(command, scene);
  } catch (const std::exception& error) {
    AccuracyStudy nothing;
    nothing.trouble = words("scene_accuracy cannot be run: ", error.what());
    started.set_exception(std::make_exception_ptr(std::runtime_error(nothing.trouble)));
    update(0.0, true, nothing);
    return;
  }
  started.set_value();
  update(1.0, true, read(*program));
}

// The study when the program ends, is stopped, or fails.
AccuracyStudy AccuracyJob::read(ChildProcess& program) {
  AccuracyStudy study;
  std::string trouble = "it ended early";
  std::optional<Clock::time_point> terminated;  // when SIGTERM was sent
  Clock::time_point alive = Clock::now();
  double cpu = 0.0;
  try {
    while (!program.ended()) {
      const Clock::time_point now = Clock::now();
      if (stop_ && !terminated) program.terminate(), terminated = now, trouble = "it was stopped";
      if (terminated && now - *terminated > kGrace) break;
      const std::optional<std::string> line = program.readLine(kPoll);
      if (line) {
        const nlohmann::json report = nlohmann::json::parse(*line);
        study = report.at("study").get<AccuracyStudy>();
        if (report.contains("done")) return study;
        update(report.at("share"), false, study);
      }
      if (line || program.cpuSeconds() > cpu) alive = now, cpu = program.cpuSeconds();
      if (now - alive > kSilence) {
        trouble = "it did nothing for " + std::to_string(kSilence.count()) + " s";
        break;
      }
    }
  } catch (const std::exception& error) {
    trouble = words("its output is not an accuracy study: ", error.what());
  }
  if (!stop_) ROS_WARN_STREAM("scene_accuracy was ended: " << trouble);
  if (!stop_ || study.windows == 0) study.trouble = "the measurement gave no result: " + trouble;
  return study;
}

void AccuracyJob::update(double progress, bool done, const AccuracyStudy& study) {
  std::lock_guard<std::mutex> lock(mutex_);
  known_.study = study;
  known_.progress = progress;
  known_.done = done;
  publish();
}

// Updates `stale`: whether the study is still valid for the running scene.
void AccuracyJob::compare() {
  std::lock_guard<std::mutex> lock(mutex_);
  if (known_.job == 0) return;
  const std::string stale = sceneChange(*known_.scene, *simulator_.snapshot());
  if (stale != std::exchange(known_.stale, stale)) publish();
}

void AccuracyJob::publish() {
  const AccuracyStudy& study = known_.study;
  rigid_body_sim::AccuracyStudy msg;
  msg.header.stamp = timeline_.stamp();
  msg.job = known_.job;
  msg.scene = known_.scene->scene;
  msg.time = known_.scene->time;
  msg.step = known_.scene->step;
  msg.stale = known_.stale;
  msg.progress = known_.progress;
  msg.done = known_.done;
  msg.complete = study.complete;
  msg.trouble = study.trouble;
  msg.window = study.window;
  msg.shortest = study.shortest;
  msg.seconds = study.seconds;
  msg.windows = study.windows;
  msg.shortened = study.shortened;
  msg.inconclusive = study.inconclusive;
  msg.uncertainty = finite(study.uncertainty.distance);
  for (const SettingCost& cost : study.settings) msg.settings.push_back(costMessage(cost));
  publisher_.publish(msg);
}

AccuracyStudy AccuracyJob::foundFor(const Snapshot& now) const {
  std::lock_guard<std::mutex> lock(mutex_);
  if (!known_.done)
    throw std::runtime_error(
        "no accuracy study is finished: call measure_accuracy, and wait until ~accuracy is done");
  const AccuracyStudy& study = known_.study;
  if (!study.trouble.empty()) throw std::runtime_error("the study has no errors: " + study.trouble);
  const std::string stale = sceneChange(*known_.scene, now);
  if (!stale.empty())
    throw std::runtime_error(
        words("'", study.scene, "' was measured, but ", stale, " since: call measure_accuracy again"));
  return study;
}

}  // namespace rbs
