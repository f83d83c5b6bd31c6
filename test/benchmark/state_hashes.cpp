// SPDX-License-Identifier: BSD-3-Clause
// The state hashes of scenes at every setting, to compare two builds: equal lines are equal simulations.
//
// Usage: state_hashes [--steps N] [--seconds S] [SCENE...]
//   --steps N     steps of each run (default: 600)
//   --seconds S   processor time after which a run ends early (default: 60)
//   SCENE         names in the catalogue or files (default: the catalogue)
// A line for every scene and setting goes to standard output, with the hashes after 1, 10, 60, 200 and N
// steps; "-" stands for steps that a run did not reach. The times go to standard error.
#include "rigid_body_sim/scenes.h"
#include "rigid_body_sim/world.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <string>
#include <vector>

namespace {

using namespace rbs;

double processorSeconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

void run(const std::string& name, const std::string& file, Fidelity fidelity, int steps, double seconds) {
  SceneDef scene = readScene(file).scene;
  scene.fidelity = fidelity;
  scene.goal.reset();
  World world(scene);
  std::printf("%-16s %-12s", name.c_str(), fidelityName(fidelity));
  const double begin = processorSeconds();
  int done = 0;
  for (const int mark : {1, 10, 60, 200, steps}) {
    while (done < std::min(mark, steps) && processorSeconds() - begin < seconds) world.step(), ++done;
    if (done == std::min(mark, steps)) {
      std::printf(" %016llx", static_cast<unsigned long long>(world.stateHash()));
    } else {
      std::printf(" -");
    }
  }
  std::printf("\n");
  std::fflush(stdout);
  std::fprintf(stderr, "%s %s: %.3f ms a step over %d steps\n", name.c_str(), fidelityName(fidelity),
               1e3 * (processorSeconds() - begin) / std::max(done, 1), done);
}

int usage() {
  std::fprintf(stderr, "usage: state_hashes [--steps N] [--seconds S] [SCENE...]\n");
  return 2;
}

}  // namespace

int main(int count, char** arguments) {
  int steps = 600;
  double seconds = 60.0;
  std::vector<std::string> scenes;
  for (int k = 1; k < count; ++k) {
    const bool is_option = arguments[k][0] == '-';
    if (is_option && k + 1 == count) return usage();
    if (std::strcmp(arguments[k], "--steps") == 0) {
      steps = std::atoi(arguments[++k]);
    } else if (std::strcmp(arguments[k], "--seconds") == 0) {
      seconds = std::atof(arguments[++k]);
    } else if (is_option) {
      return usage();
    } else {
      scenes.emplace_back(arguments[k]);
    }
  }
  if (steps < 1 || !(seconds > 0.0)) return usage();
  if (scenes.empty()) {
    for (const auto& entry : std::filesystem::directory_iterator(RBS_SCENES))
      if (entry.path().extension() == ".yaml") scenes.push_back(entry.path().stem());
    std::sort(scenes.begin(), scenes.end());
  }
  try {
    for (const std::string& scene : scenes)
      for (const Fidelity fidelity : kFidelities)
        run(scene, findScene(RBS_SCENES, scene), fidelity, steps, seconds);
  } catch (const InvalidInput& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
