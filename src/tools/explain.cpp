// SPDX-License-Identifier: BSD-3-Clause
// Prints the stages that a scene runs, the reason for each, and its cost, without a node.
#include "catalogue.h"

#include "rigid_body_sim/modelling_error.h"
#include "rigid_body_sim/scenes.h"

#include <nlohmann/json.hpp>

#include <boost/program_options.hpp>

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <ctime>
#include <iostream>

namespace {

using namespace rbs;

struct Request {
  std::string scene, folder;
  std::vector<std::string> on, off;
  std::string fidelity;
  std::int64_t steps = 0;
  bool json = false;
};

constexpr std::int64_t kMostSteps = 1000000;
constexpr int kInterrupted = 130;  // exit code, as of a program that ended by SIGINT

volatile std::sig_atomic_t interrupted = 0;

/// Shows on a terminal how far the steps are.
class Progress {
 public:
  /// For this number of steps in all.
  explicit Progress(std::int64_t steps) : steps_(steps) {}
  /// Counts steps that were taken. Returns whether to go on.
  bool operator()(std::int64_t more) {
    taken_ += more;
    const auto now = std::chrono::steady_clock::now();
    if (terminal_ && now - told_ > std::chrono::milliseconds(200)) {
      told_ = now;
      std::fprintf(stderr, "\r\033[K%3d %%", static_cast<int>(100 * taken_ / steps_));
    }
    return interrupted == 0;
  }
  ~Progress() {
    if (terminal_) std::fprintf(stderr, "\r\033[K");
  }

 private:
  const bool terminal_ = isatty(STDERR_FILENO) == 1;
  const std::int64_t steps_;
  std::int64_t taken_ = 0;
  std::chrono::steady_clock::time_point told_ = std::chrono::steady_clock::now();
};

/// The result for a scene.
struct Explanation {
  Snapshot snapshot;
  std::vector<StageInfo> stages;  ///< with the mean seconds of a step, of those that were taken
  std::vector<std::string> neglected;
  std::int64_t steps = 0;    ///< steps taken: all that were requested, unless it was interrupted
  double cpu_seconds = 0.0;  ///< mean CPU time of a step in a run that reads nothing, s; 0: not measured
};

double cpuSeconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// CPU time of a step, s; 0 where it was interrupted. A short run is disturbed by caches and clocks, so it is
/// repeated and the fastest of three counts.
double cpuSecondsOfAStep(const World& begin, std::int64_t steps, Progress& progress) {
  constexpr int kRuns = 3;
  constexpr double kShort = 0.1;
  constexpr std::int64_t kChunk = 100;  // between two looks at the progress, which are not timed
  double fastest = 0.0;
  for (int run = 0; run < kRuns && (run == 0 || fastest < kShort); ++run) {
    World world(begin);
    double seconds = 0.0;
    for (std::int64_t left = steps; left > 0; left -= kChunk) {
      const std::int64_t chunk = std::min(left, kChunk);
      const double start = cpuSeconds();
      for (std::int64_t k = 0; k < chunk; ++k) world.step();
      seconds += cpuSeconds() - start;
      if (!progress(chunk)) return 0.0;
    }
    fastest = run == 0 ? seconds : std::min(fastest, seconds);
  }
  return fastest / static_cast<double>(steps);
}

Explanation explain(const Request& request) {
  SceneFile file = readScene(findScene(request.folder, request.scene));
  if (!request.fidelity.empty()) file.scene.fidelity = fidelityNamed(request.fidelity);
  for (const std::string& name : request.on) file.scene.effects[effectNamed(name)] = true;
  for (const std::string& name : request.off) file.scene.effects[effectNamed(name)] = false;

  World world(file.scene, file.state);
  const World begin(world);
  std::vector<StageInfo> stages = world.pipeline();
  std::vector<double> seconds(stages.size(), 0.0);
  Progress progress(2 * request.steps);
  std::int64_t steps = 0;
  while (steps < request.steps && progress(1)) {
    world.step();
    ++steps;
    stages = world.pipeline();
    for (std::size_t row = 0; row < stages.size(); ++row) seconds[row] += stages[row].seconds;
  }
  for (std::size_t row = 0; row < stages.size(); ++row)
    stages[row].seconds = steps > 0 ? seconds[row] / steps : 0.0;
  const double cpu_seconds = steps > 0 && interrupted == 0 ? cpuSecondsOfAStep(begin, steps, progress) : 0.0;

  Explanation result{world.snapshot(), std::move(stages), {}, steps, cpu_seconds};
  for (const auto& [effect, on] : file.scene.effects) {
    if (on) continue;
    const auto error = measureModellingError(file.scene, file.state.value_or(SavedState{}), {{effect, false}},
                                             [] { return interrupted == 0; });
    if (interrupted != 0) break;
    result.neglected.push_back(std::string("without ") + effectName(effect) + ": " +
                               (error ? describe(*error) : "the scene is too large to measure"));
  }
  return result;
}

nlohmann::json asJson(const Explanation& e) {
  nlohmann::json stages = nlohmann::json::array();
  for (const StageInfo& stage : e.stages) {
    nlohmann::json row{{"name", stage.name}, {"active", stage.active}, {"reason", stage.reason}};
    if (stage.active) row["items"] = stage.items, row["unit"] = stage.unit;
    if (stage.active && e.steps > 0) row["seconds_per_step"] = stage.seconds;
    stages.push_back(std::move(row));
  }
  nlohmann::json result{{"scene", e.snapshot.scene},
                        {"fidelity", settingName(e.snapshot.fidelity)},
                        {"step", e.snapshot.step},
                        {"steps_taken", e.steps},
                        {"bodies", e.snapshot.bodies->size()},
                        {"stages", std::move(stages)},
                        {"neglected", e.neglected}};
  if (e.cpu_seconds > 0.0) result["cpu_seconds_per_step"] = e.cpu_seconds;
  return result;
}

void print(const Request& request, const Explanation& e) {
  std::printf("%s: %zu bodies, %s, steps of %.6g s\n", e.snapshot.scene.c_str(), e.snapshot.bodies->size(),
              settingName(e.snapshot.fidelity).c_str(), e.snapshot.step);
  for (const StageInfo& stage : e.stages) {
    char cost[32] = "on";
    if (!stage.active) {
      std::snprintf(cost, sizeof cost, "off");
    } else if (e.steps > 0 && stage.seconds > 0.0) {
      std::snprintf(cost, sizeof cost, "%.3f ms", 1e3 * stage.seconds);
    }
    const std::string items =
        stage.active && e.steps > 0 ? std::to_string(stage.items) + ' ' + stage.unit : "";
    std::printf("  %-22s %10s  %-14s %s\n", stage.name.c_str(), cost, items.c_str(), stage.reason.c_str());
  }
  for (const std::string& line : e.neglected) std::printf("%s\n", line.c_str());
  if (request.steps == 0) std::printf("No step was taken; --steps 100 measures the cost of each part.\n");
  if (e.cpu_seconds > 0.0)
    std::printf("A step takes %.4g ms of CPU time in a run that reads nothing.\n", 1e3 * e.cpu_seconds);
  if (interrupted != 0)
    std::printf("Interrupted after %lld of %lld steps.\n", static_cast<long long>(e.steps),
                static_cast<long long>(request.steps));
}

/// Unsigned numbers would take -1 for a huge one.
void check(const Request& request) {
  if (request.steps >= 0 && request.steps <= kMostSteps) return;
  throw InvalidInput({{"--steps", std::to_string(request.steps), "0 to 1,000,000"}});
}

// A second Ctrl-C ends the program at once.
void interrupt(int) {
  interrupted = 1;
  std::signal(SIGINT, SIG_DFL);
}

}  // namespace

int main(int argc, char** argv) {
  namespace po = boost::program_options;
  Request request;
  po::options_description options(
      "Lists the stages that a scene runs, the reason for each, and its cost.\n"
      "Usage: explain SCENE [OPTIONS]      SCENE: a name of the catalogue or a .yaml file\n"
      "Exit codes: 0 done, 2 bad arguments or a bad scene, 130 interrupted");
  auto add = options.add_options();
  add("help", "print this");
  add("scene", po::value(&request.scene), "the same as SCENE");
  add("folder", po::value(&request.folder)->default_value(catalogueFolder(RBS_SCENE_FOLDER)),
      "the catalogue of scenes");
  add("fidelity", po::value(&request.fidelity), "preview, interactive, accurate or reference");
  add("on", po::value(&request.on)->multitoken()->composing(), "effects to force on");
  add("off", po::value(&request.off)->multitoken()->composing(),
      "effects to force off; prints the modelling error");
  add("steps", po::value(&request.steps),
      "take this many steps, up to 1,000,000, and print the mean cost of one; Ctrl-C ends them early");
  add("json", po::bool_switch(&request.json), "print JSON");
  po::positional_options_description positions;
  positions.add("scene", 1);
  try {
    po::variables_map given;
    po::store(po::command_line_parser(argc, argv).options(options).positional(positions).run(), given);
    po::notify(given);
    if (given.count("help") || request.scene.empty()) {
      std::cout << options;
      return given.count("help") ? 0 : 2;
    }
    check(request);
    std::signal(SIGINT, interrupt);
    const Explanation explanation = explain(request);
    if (request.json) {
      std::cout << asJson(explanation).dump(2) << '\n';
    } else {
      print(request, explanation);
    }
    return interrupted != 0 ? kInterrupted : 0;
  } catch (const po::error& error) {
    std::cerr << "explain: " << error.what() << "\n\n" << options;
    return 2;
  } catch (const std::exception& error) {
    std::cerr << "explain: " << error.what() << '\n';
    return 2;
  }
}
