// SPDX-License-Identifier: BSD-3-Clause
#include "accuracy_job.h"

#include "../tools/study_json.h"
#include "convert.h"
#include "words.h"

#include "rigid_body_sim/scenes.h"

#include <rigid_body_sim/AccuracyStudy.h>

#include <boost/filesystem.hpp>
#include <boost/process.hpp>
#include <boost/process/extend.hpp>

#include <fcntl.h>

#include <csignal>
#include <fstream>
#include <utility>

namespace rbs {
namespace {

namespace bp = boost::process;

// Its program stands beside that of the node.
boost::filesystem::path program() {
  return boost::filesystem::read_symlink("/proc/self/exe").parent_path() / "scene_accuracy";
}

// In the process to be, before its program begins: the threads of ROS block all signals, and its sockets are not for
// others.
constexpr auto startAfresh = [](auto&) {
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  constexpr int kFirst = 3, kMost = 4096;
  for (int handle = kFirst; handle < kMost; ++handle) fcntl(handle, F_SETFD, FD_CLOEXEC);
};

std::string writeTemporary(const std::string& text) {
  const auto path = boost::filesystem::temp_directory_path() / boost::filesystem::unique_path("rigid_body_sim_%%%%%%%%.yaml");
  std::ofstream stream(path.string());
  stream << text;
  stream.close();
  if (!stream) throw std::runtime_error("cannot write " + path.string());
  return path.string();
}

rigid_body_sim::SettingCost toMsg(const SettingCost& cost) {
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
      publisher_(node.advertise<rigid_body_sim::AccuracyStudy>("accuracy", 10, true)) {}

AccuracyJob::~AccuracyJob() {
  stop();
}

std::uint32_t AccuracyJob::start(const AccuracyOptions& options) {
  const std::vector<Problem> problems = validate(options);
  if (!problems.empty()) throw InvalidInput(problems);
  std::lock_guard<std::mutex> lock(running_);
  end();
  const World world = simulator_.copy().first;
  file_ = writeTemporary(writeScene(world.capture(), world.captureState()));
  bp::ipstream lines;
  const auto option = [](const char* name, auto value) { return words("--", name, "=", value); };
  try {
    process_.emplace(program(), file_, "--progress", "--background", option("seconds", options.seconds),
                     option("window", options.window), option("windows", options.windows),
                     option("max-seconds", options.max_cpu_seconds), bp::std_in < bp::null, bp::std_out > lines,
                     bp::extend::on_exec_setup = startAfresh);
  } catch (const std::exception& error) {
    end();
    throw std::runtime_error(words(program().string(), " cannot be run: ", error.what()));
  }
  const std::uint32_t job = ++jobs_;
  reader_ = std::thread([this, job, lines = std::move(lines)]() mutable { follow(lines, job); });
  return job;
}

bool AccuracyJob::stop() {
  std::lock_guard<std::mutex> lock(running_);
  const bool was_running = process_ && process_->running();
  end();
  return was_running;
}

// The program ends at SIGTERM with what it knows.
void AccuracyJob::end() {
  if (process_ && process_->running()) kill(process_->id(), SIGTERM);
  if (reader_.joinable()) reader_.join();
  if (process_) process_->wait();
  process_.reset();
  if (!file_.empty()) boost::filesystem::remove(std::exchange(file_, ""));
}

void AccuracyJob::follow(bp::ipstream& lines, std::uint32_t job) {
  AccuracyStudy study;
  bool done = false;
  for (std::string line; std::getline(lines, line);) {
    const nlohmann::json told = nlohmann::json::parse(line);
    study = told.at("study");
    done = told.contains("done");
    publish(job, told.at("share"), done, study);
  }
  if (done) return;
  study.trouble = "the process that measures has ended before its time";
  publish(job, 1.0, true, study);
}

void AccuracyJob::publish(std::uint32_t job, double progress, bool done, const AccuracyStudy& study) {
  if (done) {
    std::lock_guard<std::mutex> lock(mutex_);
    found_ = study;
  }
  rigid_body_sim::AccuracyStudy msg;
  msg.header.stamp = timeline_.stamp();
  msg.job = job;
  msg.scene = study.scene;
  msg.time = study.time;
  msg.step = study.step;
  msg.progress = progress;
  msg.done = done;
  msg.complete = study.complete;
  msg.trouble = study.trouble;
  msg.window = study.window;
  msg.seconds = study.seconds;
  msg.windows = study.windows;
  msg.dropped = study.dropped;
  msg.uncertainty = study.uncertainty.distance;
  for (const SettingCost& cost : study.settings) msg.settings.push_back(toMsg(cost));
  publisher_.publish(msg);
}

std::optional<AccuracyStudy> AccuracyJob::found() const {
  std::lock_guard<std::mutex> lock(mutex_);
  return found_;
}

}  // namespace rbs
