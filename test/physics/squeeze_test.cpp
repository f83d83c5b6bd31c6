// SPDX-License-Identifier: BSD-3-Clause
// Motions that contradict each other: a kinematic plate comes down on bodies that have no room below.
#include "make_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace rbs::test {
namespace {

constexpr double kDown = 0.5;  // m/s, of the plate

struct Squeezed {
  std::string name;
  std::vector<BodyDef> bodies;
};

std::vector<Squeezed> squeezed() {
  std::vector<BodyDef> balls;
  for (int k = 0; k < 3; ++k) balls.push_back(ball("body_" + std::to_string(k), 0.25, {0.52 * k, 0.0, 0.25}));
  BodyDef leaning = box("body", {0.1, 0.3, 0.5}, {0.0, 0.0, 0.3});
  leaning.pose.q_WB = Eigen::AngleAxisd(0.4, Vec3(1.0, 0.5, 0.2).normalized());
  return {{"box", {box("body", Vec3::Constant(0.5), {0.0, 0.0, 0.25})}},
          {"balls", balls},
          {"leaning box", {leaning}},
          {"cylinder", {body("body", Cylinder{0.2, 0.25}, {0.0, 0.0, 0.25})}},
          {"cone", {body("body", Cone{0.2, 0.5}, {0.0, 0.0, 0.125})}}};
}

// Before, a box left at 5 km/s, and the residuals were told to have converged.
TEST(Squeeze, NoBodyIsThrownOutFasterThanItCouldFall) {
  for (const Squeezed& what : squeezed())
    for (const Fidelity fidelity : kFidelities) {
      SceneDef scene = onFloor(1.0 / 60.0, 0.6);
      scene.fidelity = fidelity;
      BodyDef plate = box("plate", {4.0, 4.0, 0.2}, {0.0, 0.0, 1.0});
      plate.kind = BodyKind::Kinematic;
      plate.twist.v_WB = {0.0, 0.0, -kDown};
      scene.bodies.push_back(plate);
      scene.bodies.insert(scene.bodies.end(), what.bodies.begin(), what.bodies.end());
      World world(ordered(scene));
      const std::string where = what.name + " at " + fidelityName(fidelity);
      double fastest = 0.0;
      bool warned = false;
      while (world.time() < 2.0) {
        const StepReport& report = world.step();
        for (const Warning& warning : report.warnings) {
          EXPECT_EQ(warning.kind, "unsolved") << where << ": " << warning.text;
          EXPECT_NE(warning.text.find("'plate'"), std::string::npos) << where << ": " << warning.text;
          warned = true;
        }
        for (const BodyDef& def : what.bodies)
          fastest = std::max(fastest, stateOf(world, def.name).twist.v_WB.norm());
        if (fidelity < Fidelity::Accurate) continue;
        for (const IslandResiduals& residuals : report.residuals) {
          const double worst = std::max({residuals.signorini, residuals.coulomb, residuals.dissipation});
          if (residuals.converged) {
            EXPECT_LE(worst, 1e-4) << where << ", t " << world.time();
          }
        }
      }
      EXPECT_LE(fastest, kDown + std::sqrt(kGravity * 0.5)) << where;
      EXPECT_EQ(warned, fidelity >= Fidelity::Accurate) << where;
    }
}

// The speed of an elastic body times the distance of walls that close stays the same: it meets them without
// number. Counts end that. Without the count of queries a box took 2,000,000 impacts and 40 s.
TEST(Squeeze, ElasticBodiesEndTheirReboundsByCount) {
  for (const Squeezed& what : squeezed()) {
    if (what.bodies.size() > 1) continue;
    for (const Fidelity fidelity : kFidelities) {
      SceneDef scene = onFloor(1.0 / 60.0, 0.0);
      scene.fidelity = fidelity;
      BodyDef plate = box("plate", {4.0, 4.0, 0.2}, {0.0, 0.0, 1.0});
      plate.kind = BodyKind::Kinematic;
      plate.twist.v_WB = {0.0, 0.0, -kDown};
      scene.bodies.push_back(plate);
      scene.bodies.push_back(what.bodies[0]);
      scene.bodies.back().twist.w_WB = {1.0, 2.0, 3.0};  // nothing meets flat: no symmetry ends the rebounds
      for (BodyDef& def : scene.bodies) def.material.restitution = 1.0, def.material.friction = 0.0;
      World world(ordered(scene));
      bool warned = false;
      while (!warned && world.time() < 2.0) {
        const StepReport& report = world.step();
        EXPECT_LE(report.impacts, 25000u) << what.name << " at " << fidelityName(fidelity);
        for (const Warning& warning : report.warnings)
          warned =
              warned || (warning.kind == "impact_budget" && warning.text.find("'body'") != std::string::npos);
      }
      EXPECT_TRUE(warned) << what.name << " at " << fidelityName(fidelity);
    }
  }
}

}  // namespace
}  // namespace rbs::test
