// SPDX-License-Identifier: BSD-3-Clause
// Prints what a scene simulates, why, and what each part costs, without a node.
#include "catalogue.h"

#include "rigid_body_sim/neglect.h"
#include "rigid_body_sim/scenes.h"

#include <nlohmann/json.hpp>

#include <boost/program_options.hpp>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <iostream>

namespace {

using namespace rbs;

struct Request {
  std::string scene, folder;
  std::vector<std::string> on, off;
  std::string fidelity;
  std::uint64_t steps = 0;
  bool json = false;
};

/// What there is to say of a scene.
struct Explanation {
  Snapshot snapshot;
  std::vector<StageInfo> stages;  ///< with the mean seconds of a step, of those that were taken
  std::vector<std::string> neglected;
  double cpu_seconds = 0.0;  ///< of a step, the mean of a run that looks at nothing else
};

/// Of a short run, which caches and clocks disturb, the fastest of three.
double cpuSecondsOfAStep(const World& begin, std::uint64_t steps) {
  constexpr int kRuns = 3;
  constexpr double kShort = 0.1;
  const auto now = [] {
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
  };
  double fastest = 0.0;
  for (int run = 0; run < kRuns && (run == 0 || fastest < kShort); ++run) {
    World world(begin);
    const double start = now();
    for (std::uint64_t k = 0; k < steps; ++k) world.step();
    const double seconds = now() - start;
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
  const double cpu_seconds = request.steps > 0 ? cpuSecondsOfAStep(world, request.steps) : 0.0;
  std::vector<StageInfo> stages = world.pipeline();
  std::vector<double> seconds(stages.size(), 0.0);
  for (std::uint64_t k = 0; k < request.steps; ++k) {
    world.step();
    stages = world.pipeline();
    for (std::size_t row = 0; row < stages.size(); ++row) seconds[row] += stages[row].seconds / request.steps;
  }
  for (std::size_t row = 0; row < stages.size(); ++row) stages[row].seconds = seconds[row];

  Explanation result{world.snapshot(), std::move(stages), {}, cpu_seconds};
  for (const auto& [effect, on] : file.scene.effects) {
    if (on) continue;
    const auto neglect = measureNeglect(file.scene, file.state.value_or(SavedState{}), {{effect, false}});
    result.neglected.push_back(std::string("without ") + effectName(effect) + ": " +
                               (neglect ? describe(*neglect) : "the scene is too large to tell"));
  }
  return result;
}

nlohmann::json asJson(const Request& request, const Explanation& e) {
  nlohmann::json stages = nlohmann::json::array();
  for (const StageInfo& stage : e.stages) {
    nlohmann::json row{{"name", stage.name}, {"active", stage.active}, {"reason", stage.reason}};
    if (stage.active) row["items"] = stage.items, row["unit"] = stage.unit;
    if (stage.active && request.steps > 0) row["seconds_per_step"] = stage.seconds;
    stages.push_back(std::move(row));
  }
  nlohmann::json result{{"scene", e.snapshot.scene},
                        {"fidelity", settingName(e.snapshot.fidelity)},
                        {"step", e.snapshot.step},
                        {"steps_taken", request.steps},
                        {"bodies", e.snapshot.bodies->size()},
                        {"stages", std::move(stages)},
                        {"neglected", e.neglected}};
  if (request.steps > 0) result["cpu_seconds_per_step"] = e.cpu_seconds;
  return result;
}

void print(const Request& request, const Explanation& e) {
  std::printf("%s: %zu bodies, %s, steps of %.6g s\n", e.snapshot.scene.c_str(), e.snapshot.bodies->size(),
              settingName(e.snapshot.fidelity).c_str(), e.snapshot.step);
  for (const StageInfo& stage : e.stages) {
    char cost[32] = "on";
    if (!stage.active) {
      std::snprintf(cost, sizeof cost, "off");
    } else if (request.steps > 0 && stage.seconds > 0.0) {
      std::snprintf(cost, sizeof cost, "%.3f ms", 1e3 * stage.seconds);
    }
    const std::string items =
        stage.active && request.steps > 0 ? std::to_string(stage.items) + ' ' + stage.unit : "";
    std::printf("  %-22s %10s  %-14s %s\n", stage.name.c_str(), cost, items.c_str(), stage.reason.c_str());
  }
  for (const std::string& line : e.neglected) std::printf("%s\n", line.c_str());
  if (request.steps == 0)
    std::printf("Nothing was run; --steps 100 measures what each part costs.\n");
  else
    std::printf("A step takes %.4g ms of CPU time where nobody looks on.\n", 1e3 * e.cpu_seconds);
}

}  // namespace

int main(int argc, char** argv) {
  namespace po = boost::program_options;
  Request request;
  po::options_description options("What a scene simulates, why, and what each part costs.\n"
                                  "Usage: explain SCENE [OPTIONS]      SCENE: a name of the catalogue or a .yaml file");
  auto add = options.add_options();
  add("help", "print this");
  add("scene", po::value(&request.scene));
  add("folder", po::value(&request.folder)->default_value(catalogueFolder(RBS_SCENE_FOLDER)), "the catalogue of scenes");
  add("fidelity", po::value(&request.fidelity), "preview, interactive, accurate or reference");
  add("on", po::value(&request.on)->multitoken()->composing(), "effects to force on");
  add("off", po::value(&request.off)->multitoken()->composing(), "effects to force off, and what that neglects");
  add("steps", po::value(&request.steps), "take this many steps and print the mean cost of one");
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
    const Explanation explanation = explain(request);
    if (request.json) {
      std::cout << asJson(request, explanation).dump(2) << '\n';
    } else {
      print(request, explanation);
    }
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "explain: " << error.what() << '\n';
    return 2;
  }
}
