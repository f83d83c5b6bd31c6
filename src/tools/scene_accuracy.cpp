// SPDX-License-Identifier: BSD-3-Clause
// Says what accuracy costs for a scene file: the error and the time of each setting, and which one to take.
#include "catalogue.h"
#include "study_json.h"

#include "rigid_body_sim/scenes.h"

#include <boost/program_options.hpp>

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <iostream>
#include <iterator>
#include <stdexcept>

namespace {

using namespace rbs;

volatile std::sig_atomic_t interrupted = 0;

// The second signal ends the program at once, in the middle of a step.
void endAtSignal(int number) {
  struct sigaction action {};
  action.sa_handler = [](int) { interrupted = 1; };
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigaction(number, &action, nullptr);
}

struct Request {
  std::string scene, folder, fidelity;
  AccuracyOptions options;
  std::int64_t windows = AccuracyOptions{}.windows;  // with a sign, so that a negative number does not wrap
  double from = 0.0, max_error = 0.0, max_step_ms = 0.0;
  bool json = false, progress = false, background = false;
};

/// "3.2 mm", with a unit that makes the number handy.
std::string lengthText(double metres) {
  struct Unit {
    double metres;
    const char* name;
  };
  constexpr Unit kUnits[] = {{1.0, "m"}, {1e-3, "mm"}, {1e-6, "um"}, {1e-9, "nm"}, {1e-12, "pm"}};
  const auto unit = std::find_if(std::begin(kUnits), std::end(kUnits) - 1,
                                 [&](const Unit& u) { return metres >= 0.9995 * u.metres; });
  char text[32];
  std::snprintf(text, sizeof text, "%.3g %s", metres / unit->metres, unit->name);
  return text;
}

std::string windowsText(std::uint32_t n) {
  return std::to_string(n) + (n == 1 ? " window" : " windows");
}

/// Degrees with two digits, and without a power of ten.
std::string angleText(double radians) {
  const double degrees = radians * 180.0 / 3.14159265358979323846;
  char text[32];
  std::snprintf(text, sizeof text, degrees < 99.5 ? "%.2g" : "%.0f", degrees);
  return text;
}

void printChoice(const AccuracyStudy& study, const Request& request) {
  const auto say = [](const std::string& wish, const SettingCost* cost) {
    if (!cost) {
      std::printf("%s: none of the measured solver settings\n", wish.c_str());
      return;
    }
    std::printf("%s: %s (%s a second, %.3g ms a step)\n", wish.c_str(), settingName(cost->setting).c_str(),
                lengthText(cost->error.distance).c_str(), cost->step_ms);
  };
  if (request.max_error > 0.0)
    say("Cheapest within " + lengthText(request.max_error) + " a second",
        cheapestWithin(study, request.max_error));
  if (request.max_step_ms > 0.0) {
    char budget[32];
    std::snprintf(budget, sizeof budget, "%.3g", request.max_step_ms);
    say("Most accurate within " + std::string(budget) + " ms a step",
        mostAccurateWithin(study, request.max_step_ms));
  }
}

void printWindows(const AccuracyStudy& study) {
  std::printf("A window is %.3g s long.", study.window);
  if (study.shortened > 0)
    std::printf(
        " %u of them are in pieces, the shortest of %.3g s, or end earlier: the reference does not converge "
        "for "
        "longer, or the CPU time ran out.",
        study.shortened, study.shortest);
  if (study.inconclusive > 0)
    std::printf(" Steps in which the reference does not converge: %u. Their errors count as upper bounds.",
                study.inconclusive);
  std::printf("\n\n");
}

void print(const AccuracyStudy& study, const Request& request) {
  std::printf("%s from %.6g s on, steps of %.6g s\n", study.scene.c_str(), study.time, study.step);
  if (!study.trouble.empty()) {
    std::printf("No errors can be given: %s\n", study.trouble.c_str());
    return;
  }
  std::printf(
      "Deviation of the worst body from the reference per second simulated, and the CPU time of a step.\n"
      "Means of %s along %.3g s%s. Halving the step of the reference changes %s a second.\n",
      windowsText(std::max(study.windows, 1u)).c_str(), study.seconds,
      study.complete ? "" : " (there was no time for all)", lengthText(study.uncertainty.distance).c_str());
  printWindows(study);
  std::printf("  %-38s %12s %14s %14s %12s %12s\n", "solver settings", "ms a step", "position", "at worst",
              "orientation", "energy");
  for (const SettingCost& cost : study.settings)
    std::printf("  %-38s %12.3g %s%12s %14s %8s deg %10.2g %%\n", settingName(cost.setting).c_str(),
                cost.step_ms, cost.at_most ? "<=" : "  ", lengthText(cost.error.distance).c_str(),
                lengthText(cost.worst.distance).c_str(), angleText(cost.error.angle).c_str(),
                100.0 * cost.error.energy);
  printChoice(study, request);
}

/// Tells how far the study is: on a terminal, or as lines of JSON for a program.
class Progress {
 public:
  explicit Progress(const Request& request)
      : json_(request.progress), terminal_(!json_ && isatty(STDERR_FILENO) == 1) {}
  bool operator()(double share, const AccuracyStudy& study) {
    const auto now = std::chrono::steady_clock::now();
    const double elapsed = std::chrono::duration<double>(now - begin_).count();
    if (elapsed - told_ > 0.2 && (json_ || terminal_)) {
      told_ = elapsed;
      if (json_) {
        std::cout << nlohmann::json{{"share", share}, {"study", study}}.dump() << std::endl;
      } else {
        const int filled = static_cast<int>(20 * share);
        std::fprintf(stderr, "\r\033[K[%s%s] %.0f s, at most %.0f s left: %s",
                     std::string(filled, '#').c_str(), std::string(20 - filled, '.').c_str(), elapsed,
                     elapsed * (1.0 - share) / std::max(share, 1e-3), windowsText(study.windows).c_str());
      }
    }
    return interrupted == 0;
  }
  ~Progress() {
    if (terminal_) std::fprintf(stderr, "\r\033[K");
  }

 private:
  const bool json_, terminal_;
  const std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  double told_ = 0.0;
};

// A scene by its name or file, or "-": from standard input.
SceneFile readRequested(const Request& request) {
  if (request.scene != "-") return readScene(findScene(request.folder, request.scene));
  return parseScene(std::string(std::istreambuf_iterator<char>(std::cin), {}), "standard input");
}

// Every fault of the numbers of a request.
std::vector<Problem> faults(const Request& request) {
  std::vector<Problem> problems = validate(request.options);
  if (request.windows != request.options.windows)
    problems.push_back({"windows", std::to_string(request.windows), "1 to 1000"});
  for (const auto& [name, value] :
       {std::pair("from", request.from), std::pair("max-error", request.max_error),
        std::pair("max-step-ms", request.max_step_ms)})
    if (!(value >= 0.0 && value <= 1e6)) {
      char number[32];
      std::snprintf(number, sizeof number, "%g", value);
      problems.push_back({name, number, "0 to 1e6"});
    }
  return problems;
}

int run(const Request& request) {
  SceneFile file = readRequested(request);
  if (!request.fidelity.empty()) file.scene.fidelity = fidelityNamed(request.fidelity);
  World world(file.scene, file.state);
  const double until = world.time() + request.from - 0.5 * file.scene.step;
  while (world.time() < until && interrupted == 0) world.step();
  if (interrupted != 0) throw std::runtime_error("interrupted before it began to measure");
  if (request.background) setpriority(PRIO_PROCESS, 0, 19);

  AccuracyStudy study;
  {
    Progress progress(request);
    study = measureAccuracy(world, request.options, std::ref(progress));
  }
  if (request.progress) {
    std::cout << nlohmann::json{{"share", 1.0}, {"study", study}, {"done", true}}.dump() << std::endl;
  } else if (request.json) {
    std::cout << nlohmann::json(study).dump(1) << std::endl;
  } else {
    print(study, request);
  }
  if (interrupted != 0) return 130;
  return study.trouble.empty() ? 0 : 3;
}

}  // namespace

int main(int argc, char** argv) {
  namespace po = boost::program_options;
  Request request;
  AccuracyOptions& o = request.options;
  po::options_description options(
      "Accuracy study of a scene: error and CPU time of each choice of solver settings.\n"
      "Usage: scene_accuracy SCENE [OPTIONS]      SCENE: a name of the catalogue, a .yaml file, or - for "
      "standard input\n"
      "Exit codes: 0 done, 1 bad scene or request, 2 bad arguments, 3 no errors can be given, 130 "
      "interrupted");
  auto add = options.add_options();
  add("help", "print this");
  add("scene", po::value(&request.scene), "the same as SCENE");
  add("folder", po::value(&request.folder)->default_value(catalogueFolder(RBS_SCENE_FOLDER)),
      "the catalogue of scenes");
  add("from", po::value(&request.from), "s of physics time to simulate first, 0 to 1e6");
  add("fidelity", po::value(&request.fidelity),
      "for that, instead of the scene's: preview, interactive, accurate or reference");
  add("seconds", po::value(&o.seconds)->default_value(o.seconds),
      "s of physics time to look ahead, 1e-6 to 1000");
  add("window", po::value(&o.window)->default_value(o.window),
      "length of a window, in which the settings run from a common state, 1e-6 to 1000 s");
  add("windows", po::value(&request.windows)->default_value(request.windows),
      "number of windows, evenly spaced along the seconds, 1 to 1000");
  add("max-seconds", po::value(&o.max_cpu_seconds)->default_value(o.max_cpu_seconds),
      "CPU time that the study may take, 1e-3 to 1e6 s");
  add("max-error", po::value(&request.max_error),
      "m per second simulated, up to 1e6: print the cheapest settings within this error");
  add("max-step-ms", po::value(&request.max_step_ms),
      "ms, up to 1e6: print the most accurate settings within this time of a step");
  add("json", po::bool_switch(&request.json), "print JSON");
  add("progress", po::bool_switch(&request.progress), "print lines of JSON while it runs, for programs");
  add("background", po::bool_switch(&request.background), "at the lowest priority");
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
    o.windows = static_cast<std::uint32_t>(std::clamp<std::int64_t>(request.windows, 1, 1000));
    if (const std::vector<Problem> problems = faults(request); !problems.empty())
      throw InvalidInput(problems);
  } catch (const po::error& error) {
    std::cerr << "scene_accuracy: " << error.what() << "\n\n" << options;
    return 2;
  } catch (const std::exception& error) {
    std::cerr << "scene_accuracy: " << error.what() << '\n';
    return 2;
  }
  endAtSignal(SIGINT);
  endAtSignal(SIGTERM);
  try {
    return run(request);
  } catch (const std::exception& error) {
    std::cerr << "scene_accuracy: " << error.what() << '\n';
    return interrupted != 0 ? 130 : 1;
  }
}
