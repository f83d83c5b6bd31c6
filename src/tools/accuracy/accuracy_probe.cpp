// SPDX-License-Identifier: BSD-3-Clause
// Makes one measurement of accuracy and cost, and prints it as JSON.
#include "measure.h"

#include <nlohmann/json.hpp>

#include <boost/program_options.hpp>

#include <algorithm>
#include <cmath>
#include <iostream>

namespace rbs::accuracy {
namespace {

using nlohmann::json;

/// The names of what there is, for messages.
template <class List, class Name>
std::string namesOf(const List& list, const Name& name) {
  std::string names;
  for (const auto& entry : list) names += (names.empty() ? "" : ", ") + name(entry);
  return names;
}

json listed() {
  json result{{"problems", json::array()}, {"engines", json::array()}};
  for (const Problem& problem : problems())
    result["problems"].push_back({{"name", problem.name},
                                  {"sentence", problem.sentence},
                                  {"against", problem.against},
                                  {"measure", problem.measure},
                                  {"duration", problem.duration},
                                  {"steps", problem.steps}});
  for (const peers::EngineSetting& engine : peers::engineSettings())
    result["engines"].push_back({{"engine", engine.engine},
                                 {"setting", engine.setting},
                                 {"base", engine.base},
                                 {"version", engine.version},
                                 {"sentence", engine.sentence}});
  result["build"] = {{"compiler", __VERSION__}, {"flags", RBS_FLAGS}};
  return result;
}

json asJson(const Problem& problem, const peers::EngineSetting& engine, const Request& request,
            const Measurement& m) {
  json result{{"problem", problem.name},
              {"engine", engine.engine},
              {"setting", engine.setting},
              {"version", engine.version},
              {"step", request.step},
              {"steps", m.steps},
              {"against", problem.against},
              {"measure", problem.measure},
              {"seed", problem.task.scene.seed},
              {"error", nullptr},
              {"cpu_seconds", nullptr},
              {"cpu_spread", nullptr},
              {"repetitions", m.repetitions},
              {"failure", nullptr}};
  if (m.failure) {
    result["failure"] = {{"kind", m.failure->kind}, {"detail", m.failure->detail}};
  } else {
    if (request.error) result["error"] = m.error;
    if (request.time) result["cpu_seconds"] = m.cpu_seconds, result["cpu_spread"] = m.cpu_spread;
  }
  return result;
}

int refuse(const std::string& message) {
  std::cerr << "accuracy_probe: " << message << '\n';
  return 2;
}

int run(int argc, char** argv) {
  namespace po = boost::program_options;
  // Adapters add themselves in an order that the linker chooses: ours goes first, and settings stay as they
  // are.
  std::stable_sort(peers::engineSettings().begin(), peers::engineSettings().end(),
                   [](const auto& a, const auto& b) {
                     return std::pair(a.engine != "ours", a.engine) < std::pair(b.engine != "ours", b.engine);
                   });
  std::sort(problems().begin(), problems().end(),
            [](const auto& a, const auto& b) { return a.name < b.name; });
  std::string problem_name, engine_name, setting, only;
  Request request;
  po::options_description options(
      "Measures the error and the CPU time of an engine on a problem with a known answer");
  options.add_options()("help", "print this")("list", "print problems, engines and settings, as JSON")(
      "problem", po::value(&problem_name), "which problem")(
      "engine", po::value(&engine_name)->default_value("ours"), "ours, or another that is built in")(
      "setting", po::value(&setting),
      "of the engine: a fidelity of ours, as it is or \"preview, 4 sub-steps\"; default or better of "
      "another")("step", po::value(&request.step), "s, 1e-6 to 1")(
      "only", po::value(&only), "measure the error alone, or the time alone: error or time")(
      "repetitions", po::value(&request.repetitions)->default_value(3), "of the timed run, 1 to 1000")(
      "max-seconds", po::value(&request.max_seconds)->default_value(60.0),
      "CPU seconds that one run may take, > 0");
  po::variables_map given;
  try {
    po::store(po::command_line_parser(argc, argv).options(options).positional({}).run(), given);
    po::notify(given);
  } catch (const po::error& e) {
    std::cerr << "accuracy_probe: " << e.what() << "\n\n" << options;
    return 2;
  }
  if (given.count("help") != 0) {
    std::cout << options;
    return 0;
  }
  if (given.count("list") != 0) {
    std::cout << listed().dump(1) << '\n';
    return 0;
  }
  for (const char* needed : {"problem", "setting", "step"})
    if (given.count(needed) == 0)
      return refuse(std::string("--") + needed + " is missing; see --help and --list");

  const auto problem = std::find_if(problems().begin(), problems().end(),
                                    [&](const Problem& p) { return p.name == problem_name; });
  if (problem == problems().end())
    return refuse("no problem \"" + problem_name + "\"; there are " +
                  namesOf(problems(), [](const Problem& p) { return p.name; }));
  const auto& engines = peers::engineSettings();
  const auto engine = std::find_if(engines.begin(), engines.end(), [&](const peers::EngineSetting& e) {
    return e.engine == engine_name && e.setting == setting;
  });
  if (engine == engines.end())
    return refuse("no engine \"" + engine_name + "\" with setting \"" + setting + "\"; there are " +
                  namesOf(engines, [](const peers::EngineSetting& e) { return e.engine + " " + e.setting; }));
  // Written so that a NaN is refused, too.
  if (!(request.step >= Limits::min_step && request.step <= Limits::max_step))
    return refuse("--step is " + std::to_string(request.step) + "; allowed is 1e-6 to 1 s");
  if (request.step > problem->duration)
    return refuse("--step is longer than the " + std::to_string(problem->duration) + " s of the problem");
  if (given.count("only") != 0 && only != "error" && only != "time")
    return refuse("--only is \"" + only + "\"; allowed is error or time");
  request.error = only != "time", request.time = only != "error";
  if (request.repetitions < 1 || request.repetitions > 1000)
    return refuse("--repetitions is " + std::to_string(request.repetitions) + "; allowed is 1 to 1000");
  if (!(request.max_seconds > 0.0)) return refuse("--max-seconds must be above 0");

  std::cout << asJson(*problem, *engine, request, measure(*problem, *engine, request)).dump() << '\n';
  return 0;
}

}  // namespace
}  // namespace rbs::accuracy

int main(int argc, char** argv) {
  return rbs::accuracy::run(argc, argv);
}
