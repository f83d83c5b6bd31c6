// SPDX-License-Identifier: BSD-3-Clause
// The time of a step of whole scenes, of this simulator and of other engines in one run, with the error of each. The engines take turns of a few steps, so that a noisy machine is noisy for all of them. Steps of 1/60 s,
// one thread, nobody asleep. The overlap is found by our narrow phase on the poses of any engine.
//
// A row for each run goes to standard output as CSV: the median, the 99th percentile and the mean processor time of a
// step, the first step, the deepest overlap (at the end and every 100 steps), and the error of the family of scenes.
// scripts/performance_report makes pictures of such a file and compares two of them.
#include "broadphase/bounds_tree.h"
#include "families.h"
#include "narrowphase/collide.h"

#include <boost/program_options.hpp>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <iostream>
#include <numeric>

namespace {

using namespace rbs;

constexpr int kTurn = 10;  // steps

double processorSeconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double deepestOverlap(const SceneDef& scene, const std::vector<peers::Motion>& now) {
  std::vector<Bounds> bounds(now.size());
  std::vector<Index> order;
  std::vector<Traits> traits(now.size());
  for (std::size_t k = 0; k < now.size(); ++k) {
    const Vec3& p = now[k].pose.p_WB;
    if (!p.allFinite()) return std::numeric_limits<double>::infinity();
    const double r = boundingRadius(scene.bodies[k].shape);
    bounds[k].lo << p, p.sum() / std::sqrt(3.0);
    bounds[k].hi = bounds[k].lo + r, bounds[k].lo -= r;
    traits[k].kind = scene.bodies[k].kind;
    order.push_back(static_cast<Index>(k));
  }
  sortByPlace(order, bounds);
  Workers workers;
  IndexPairs pairs;
  BoundsTree(order, bounds).findPairs(traits, workers, pairs);
  double deepest = 0.0;
  for (const auto& [i, j] : pairs) {
    const Manifold manifold =
        collide(scene.bodies[i].shape, now[i].pose, scene.bodies[j].shape, now[j].pose, 0.0);
    for (int k = 0; k < manifold.size; ++k) deepest = std::max(deepest, -manifold.points[k].separation);
  }
  return deepest;
}

double quantile(std::vector<double> values, double share) {
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

// An engine with a scene.
struct Run {
  const peers::EngineSetting* setting;
  std::unique_ptr<peers::Engine> engine{};
  std::vector<double> seconds{};  // of each step
  double spent = 0.0, deepest = 0.0;
  std::string failure{};  // of the engine; empty: none
};

void takeTurn(Run& run, const SceneDef& scene, int steps) try {
  for (int k = 0; k < kTurn && static_cast<int>(run.seconds.size()) < steps; ++k) {
    const double begin = processorSeconds();
    run.engine->step();
    run.seconds.push_back(processorSeconds() - begin);
    run.spent += run.seconds.back();
  }
  if (run.seconds.size() % 100 == 0)
    run.deepest = std::max(run.deepest, deepestOverlap(scene, run.engine->read()));
} catch (const std::runtime_error& error) {
  run.failure = error.what();
}

void print(Run& run, const std::string& family, const SceneDef& scene, int round) {
  const auto bodies = std::count_if(scene.bodies.begin(), scene.bodies.end(),
                                    [](const BodyDef& body) { return body.kind == BodyKind::Dynamic; });
  std::printf("%s,%td,%s,\"%s\",\"%s\",%d,%zu,", family.c_str(), bodies, run.setting->engine.c_str(),
              run.setting->setting.c_str(), run.setting->version.c_str(), round, run.seconds.size());
  std::vector<peers::Motion> now;
  try {
    if (run.failure.empty()) now = run.engine->read();
  } catch (const std::runtime_error& error) {
    run.failure = error.what();
  }
  if (!run.failure.empty()) return void(std::printf(",,,,,,\"%s\"\n", run.failure.c_str()));
  const double time = scene.step * static_cast<double>(run.seconds.size());
  std::printf("%.6g,%.6g,%.6g,%.6g,%.4g,%.4g,\"%s\"\n", 1e3 * quantile(run.seconds, 0.5),
              1e3 * quantile(run.seconds, 0.99), 1e3 * run.spent / static_cast<double>(run.seconds.size()),
              1e3 * run.seconds.front(), 1e3 * std::max(run.deepest, deepestOverlap(scene, now)),
              families::all().at(family).errorOf(scene, now, time), families::all().at(family).error);
  std::fflush(stdout);
}

struct Options {
  std::vector<std::string> scenes, engines;
  int steps, rounds;
  double seconds;
};

bool isCalled(const peers::EngineSetting& setting, const std::string& name) {
  return name == setting.engine || name == setting.engine + ":" + setting.setting;
}

void race(const std::string& family, int size, const Options& options) {
  SceneDef scene = families::all().at(family).make(size);
  for (std::size_t k = 0; k < scene.bodies.size(); ++k) scene.bodies[k].name = "body_" + std::to_string(k);
  for (int round = 1; round <= options.rounds; ++round) {
    std::vector<Run> runs;
    for (const peers::EngineSetting& setting : peers::engineSettings()) {
      const auto called = [&](const std::string& name) { return isCalled(setting, name); };
      if (std::none_of(options.engines.begin(), options.engines.end(), called)) continue;
      Run& run = runs.emplace_back(Run{&setting});
      try {
        run.engine = setting.make({scene, {}});
      } catch (const std::runtime_error& error) {
        run.failure = error.what();
      }
    }
    const auto goesOn = [&](const Run& run) {
      return run.failure.empty() && static_cast<int>(run.seconds.size()) < options.steps &&
             run.spent < options.seconds;
    };
    while (std::any_of(runs.begin(), runs.end(), goesOn)) {
      for (Run& run : runs)
        if (goesOn(run)) takeTurn(run, scene, options.steps);
      std::fprintf(stderr, "\r%s of %d, round %d: step %zu of %d ", family.c_str(), size, round,
                   runs.front().seconds.size(), options.steps);
    }
    for (Run& run : runs) print(run, family, scene, round);
  }
  std::fprintf(stderr, "\r%*s\r", 60, "");
}

std::string engineNames() {
  std::string names;
  for (const peers::EngineSetting& setting : peers::engineSettings())
    names += (names.empty() ? "" : "; ") + setting.engine + ":" + setting.setting;
  return names;
}

}  // namespace

int main(int argc, char** argv) {
  namespace po = boost::program_options;
  Options options;
  using Names = std::vector<std::string>;
  options.scenes = {"wall:210",    "wall:1830", "pile:1000",      "rain:3000",
                    "towers:1000", "gas:10000", "free_fall:10000"};
  options.engines = {"ours:preview", "ours:interactive", "bullet:default", "ode:default"};
  po::options_description description("Times steps of whole scenes, and prints CSV. Options");
  description.add_options()("help", "print this text")(
      "scenes",
      po::value<Names>()->multitoken()->notifier([&](const Names& names) { options.scenes = names; }),
      "NAME:BODIES ...: free_fall, gas, pile, rain, towers, wall")(
      "engines",
      po::value<Names>()->multitoken()->notifier([&](const Names& names) { options.engines = names; }),
      ("ENGINE or ENGINE:SETTING ...: " + engineNames()).c_str())(
      "steps", po::value(&options.steps)->default_value(300), "steps of a run")(
      "seconds", po::value(&options.seconds)->default_value(20.0),
      "processor time of the steps of a run, after which it ends early")(
      "rounds", po::value(&options.rounds)->default_value(3), "runs of each, which show the noise");
  try {
    po::variables_map given;
    po::store(po::parse_command_line(argc, argv, description), given);
    po::notify(given);
    if (given.count("help")) return std::cout << description, 0;
    if (options.steps < 1 || options.rounds < 1) throw std::runtime_error("--steps and --rounds: at least 1");
    std::vector<std::pair<std::string, int>> races;
    for (const std::string& one : options.scenes) {
      const std::size_t colon = one.find(':');
      const std::string name = one.substr(0, colon);
      const int size = colon == std::string::npos ? 0 : std::atoi(one.c_str() + colon + 1);
      if (families::all().count(name) == 0 || size < 1 || size > 1'000'000)
        throw std::runtime_error("--scenes: '" + one + "' (allowed: NAME:BODIES, see --help)");
      races.emplace_back(name, size);
    }
    for (const std::string& one : options.engines)
      if (std::none_of(peers::engineSettings().begin(), peers::engineSettings().end(),
                       [&](const auto& setting) { return isCalled(setting, one); }))
        throw std::runtime_error("--engines: '" + one + "' (allowed: " + engineNames() + ")");
    std::puts(
        "scene,bodies,engine,setting,version,round,steps,median_ms,p99_ms,mean_ms,first_ms,overlap_mm,error,"
        "error_of");
    for (const auto& [name, size] : races) race(name, size, options);
  } catch (const std::exception& error) {
    return std::cerr << "scene_benchmark: " << error.what() << "\n", 2;
  }
}
