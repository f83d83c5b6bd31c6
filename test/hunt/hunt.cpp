// SPDX-License-Identifier: BSD-3-Clause
// Hunts for scenes in which something happens that must never happen; see invariants.h. scripts/hunt runs it, a share of
// the seeds each time. Findings go to standard error, counts as JSON to standard output.
#include "invariants.h"
#include "random_scene.h"
#include "shrink.h"

#include "rigid_body_sim/scenes.h"

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <string>

namespace {

// A step of a small scene may take a second.
constexpr rbs::hunt::Demands kDemands{60, 1.0, 0.05};

void report(std::uint64_t seed, const rbs::SceneDef& scene, const rbs::hunt::Finding& broken,
            const std::string& folder) {
  const rbs::hunt::Small small = rbs::hunt::shrink(scene, kDemands, broken);
  const std::string file = folder + "/" + broken.invariant + "_" + std::to_string(seed) + ".yaml";
  std::ofstream(file) << "# SPDX-License-Identifier: BSD-3-Clause\n# " << rbs::hunt::text(small.finding)
                      << "\n"
                      << rbs::writeScene(small.scene);
  std::fprintf(stderr, "seed %llu, %s, steps of %.4g s: %s; %zu of %zu bodies are left in %s\n",
               static_cast<unsigned long long>(seed), rbs::settingName(scene.fidelity).c_str(), scene.step,
               rbs::hunt::text(broken).c_str(), small.scene.bodies.size(), scene.bodies.size(), file.c_str());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) {
    std::cerr << "usage: hunt FIRST_SEED STRIDE SECONDS FOLDER\n";
    return 2;
  }
  const std::uint64_t first = std::strtoull(argv[1], nullptr, 10),
                      stride = std::strtoull(argv[2], nullptr, 10);
  const double seconds = std::strtod(argv[3], nullptr);
  const auto start = std::chrono::steady_clock::now();
  const auto elapsed = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  int scenes = 0, findings = 0;
  for (std::uint64_t seed = first; elapsed() < seconds; seed += stride, ++scenes) {
    const rbs::SceneDef scene = rbs::hunt::randomScene(seed);
    if (const auto broken = rbs::hunt::firstBroken(scene, kDemands)) {
      ++findings;
      report(seed, scene, *broken, argv[4]);
    }
  }
  std::printf("{\"scenes\": %d, \"findings\": %d}\n", scenes, findings);
  return findings > 0 ? 1 : 0;
}
