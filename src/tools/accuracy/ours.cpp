// SPDX-License-Identifier: BSD-3-Clause
// This simulator behind the seam, at every fidelity, and with the numbers behind them changed.
#include "../../../test/benchmark/peers/engine.h"
#include "rigid_body_sim/world.h"

namespace rbs::peers {
namespace {

class Ours : public Engine {
 public:
  Ours(const Task& task, const Setting& setting) : world_(at(task.scene, setting)) {
    for (const Push& push : task.pushes) {
      const BodyDef& body = task.scene.bodies[push.body];
      constexpr double kWholeRun = 1e6;
      world_.applyWrench(world_.find(body.name), push.force_W, Vec3::Zero(), body.pose.p_WB, kWholeRun);
    }
  }
  void step() override { world_.step(); }
  std::vector<Motion> read() const override {
    std::vector<Motion> motions;
    for (const BodyState& state : world_.snapshot().states) motions.push_back({state.pose, state.twist});
    return motions;
  }

 private:
  static SceneDef at(SceneDef scene, const Setting& setting) {
    scene.fidelity = setting;
    return scene;
  }

  World world_;
};

void add(const Setting& setting, const std::string& sentence) {
  const bool tuned = setting != Setting(setting.preset);
  RegisterEngine({"ours", settingName(setting), "0.1.0", sentence,
                  [setting](const Task& task) { return std::make_unique<Ours>(task, setting); },
                  tuned ? fidelityName(setting.preset) : ""});
}

void addSubSteps(Fidelity preset, std::initializer_list<std::uint32_t> numbers) {
  for (const std::uint32_t sub_steps : numbers) {
    Setting setting(preset);
    setting.sub_steps = sub_steps;
    add(setting, "other sub-steps");
  }
}

void addTolerances(Fidelity preset, std::initializer_list<double> tolerances) {
  for (const double tolerance : tolerances) {
    Setting setting(preset);
    setting.tolerance = tolerance;
    add(setting, "another tolerance");
  }
}

[[maybe_unused]] const bool added = [] {
  add(Fidelity::Preview, "soft contacts, four sub-steps");
  add(Fidelity::Interactive, "soft contacts, eight sub-steps; the default");
  add(Fidelity::Accurate, "Coulomb's law to 1e-6, stops of sliding located in time");
  add(Fidelity::Reference, "Coulomb's law to 1e-12, stops of sliding located in time");
  addSubSteps(Fidelity::Preview, {1, 2, 8});
  addSubSteps(Fidelity::Interactive, {2, 4, 16, 32});
  addTolerances(Fidelity::Accurate, {1e-2, 1e-4, 1e-8});
  addTolerances(Fidelity::Reference, {1e-6, 1e-9});
  return true;
}();

}  // namespace
}  // namespace rbs::peers
