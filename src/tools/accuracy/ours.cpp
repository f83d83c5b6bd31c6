// This simulator behind the seam, at every fidelity.
#include "../../../test/benchmark/peers/engine.h"
#include "rigid_body_sim/world.h"

namespace rbs::peers {
namespace {

class Ours : public Engine {
 public:
  Ours(const Task& task, Fidelity fidelity) : world_(at(task.scene, fidelity)) {
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
  static SceneDef at(SceneDef scene, Fidelity fidelity) {
    scene.fidelity = fidelity;
    return scene;
  }

  World world_;
};

RegisterEngine add(Fidelity fidelity, const std::string& sentence) {
  return RegisterEngine({"ours", fidelityName(fidelity), "0.1.0", sentence,
                         [fidelity](const Task& task) { return std::make_unique<Ours>(task, fidelity); }});
}

const RegisterEngine preview = add(Fidelity::Preview, "soft contacts, one sub-step");
const RegisterEngine interactive = add(Fidelity::Interactive, "soft contacts, eight sub-steps; the default");
const RegisterEngine accurate =
    add(Fidelity::Accurate, "Coulomb's law to 1e-6, stops of sliding located in time");
const RegisterEngine reference = add(Fidelity::Reference, "the same to 1e-12");

}  // namespace
}  // namespace rbs::peers
