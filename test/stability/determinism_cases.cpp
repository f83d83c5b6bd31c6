// Energy, jitter, step sizes and determinism.
#include "measure.h"

#include "rigid_body_sim/scenes.h"

#include <algorithm>

namespace rbs::stability {
namespace {

using namespace test;

// A scene is passive when nothing works on it: neither wind nor a led body.
bool isPassive(const SceneDef& scene) {
  const bool led = std::any_of(scene.bodies.begin(), scene.bodies.end(),
                               [](const BodyDef& body) { return body.kind == BodyKind::Kinematic; });
  return !scene.wind && !led;
}

void energyAudit(Sheet& sheet) {
  for (const SceneEntry& entry : listScenes(RBS_SCENES)) {
    const SceneDef scene = fromCatalogue(entry.name);
    if (!isPassive(scene)) continue;
    Watch watch(scene, sheet.setting());
    // As many steps as make the scenes cost about the same.
    watch.run(sheet.length(std::clamp(600.0 / scene.bodies.size(), 2.0, 5.0), 10.0));
    sheet.error("gained in a step, of its scale: " + entry.name, "", watch.growthInAStep(), exact(1e-9));
    Bound in_all = fastAndExact(1e-3, 1e-6);
    in_all.preview = 1e-3;
    sheet.error("gained in all, of its scale: " + entry.name, "", watch.growthInAll(), in_all);
  }
}

}  // namespace

std::vector<Case> determinismCases() {
  return {
      {"A75", "Energy audit",
       "Every passive scene of the catalogue for 10 s (in the tests 2 to 5 s, by its number of bodies): how "
       "much energy "
       "it gains in a step and above the start. The scale is its kinetic energy at the start and its weight "
       "times the "
       "range of its heights.",
       energyAudit},
  };
}

}  // namespace rbs::stability
