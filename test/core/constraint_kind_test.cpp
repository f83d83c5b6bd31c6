// SPDX-License-Identifier: BSD-3-Clause
// A kind of constraint that the program does not have goes through the graph, sleep and the soft step, beside contacts.
// coupling/coupling_test.cpp takes it through whole steps.
#include "coupling/coupling.h"
#include "make_scene.h"
#include "solver/residuals.h"
#include "solver/soft_step.h"
#include "step/analyse_scene.h"
#include "step/constraints.h"
#include "step/islands.h"
#include "step/sleep.h"

#include <gtest/gtest.h>

using namespace rbs;
using namespace rbs::test;

namespace {

struct Scene {
  SceneStore scene;
  StepStore step;
  SceneAnalysis analysis;
  Context context{scene, step, analysis};
  static constexpr double kStep = 0.01;

  explicit Scene(const Vec3& gravity) { scene.settings.gravity = gravity; }

  Index add(const BodyDef& def) {
    scene.bodies.append(BodyId{scene.bodies.size() + 1}, def);
    return scene.bodies.size() - 1;
  }
  // One step of all islands that the couplings and contacts make.
  void advance(const std::vector<std::pair<Index, Index>>& couplings,
               const std::vector<std::pair<Index, Index>>& contacts) {
    analysis = analyseScene(scene);
    step.begin(scene, 0.0, kStep);
    step.row_seconds.assign(kInnerRows, 0.0);
    for (const Index i : scene.lists.in_islands) step.load[i].a_W = scene.settings.gravity;
    scene.contacts.update(scene.bodies, contacts, [](const Contact&) { return false; });
    std::vector<Edge> edges;
    for (Index k = 0; k < scene.contacts.active.size(); ++k)
      edges.push_back(constraints::edgeOf(scene.contacts, k));
    for (const auto& [i, j] : couplings)
      edges.push_back({kCoupling, static_cast<Index>(edges.size()), {i, j, kNone, kNone}});
    islands::connect(context, context.scene.lists.in_islands, edges);
    for (const Island& island : step.islands) {
      soft_step::SoftStep<Coupling> method(context, island, 0.0, kStep);
      InnerClock clock(step.row_seconds);
      runInnerStep(method, clock);
    }
    scene.contacts.endStep([](const Contact&) { return false; });
  }
};

TEST(ConstraintKind, OfItsOwnIsSolvedWithoutContacts) {
  Scene scene(Vec3::Zero());
  BodyDef light = ball("light", 0.1, Vec3::Zero()), heavy = ball("heavy", 0.1, Vec3(5.0, 0.0, 0.0));
  light.mass = 1.0, heavy.mass = 3.0;
  light.twist.v_WB = {4.0, 0.0, 2.0};
  const Index i = scene.add(light), j = scene.add(heavy);
  scene.advance({{i, j}}, {});
  ASSERT_EQ(scene.step.islands.size(), 1u);
  const Vec3 common(1.0, 0.0, 0.5);
  EXPECT_LE((scene.scene.bodies.twist[i].v_WB - common).norm(), 1e-14);
  EXPECT_LE((scene.scene.bodies.twist[j].v_WB - common).norm(), 1e-14);
  EXPECT_LE((scene.scene.bodies.pose[j].p_WB - heavy.pose.p_WB - Scene::kStep * common).norm(), 1e-13)
      << "50 sub-steps at 5 m";
}

// It hangs on a body that nothing moves, which no contact knows.
TEST(ConstraintKind, OfItsOwnTiesABodyToTheWorld) {
  Scene scene(Vec3(0.0, 0.0, -10.0));
  BodyDef post = ball("post", 0.1, Vec3(0.0, 0.0, 9.0));
  post.kind = BodyKind::Static;
  const Index anchor = scene.add(post), hanging = scene.add(ball("hanging", 0.1, Vec3(5.0, 0.0, 7.0)));
  for (int k = 0; k < 20; ++k) scene.advance({{hanging, anchor}}, {});
  EXPECT_LE((scene.scene.bodies.pose[hanging].p_WB - Vec3(5.0, 0.0, 7.0)).norm(), 1e-3);
  EXPECT_EQ(scene.scene.bodies.pose[anchor].p_WB, Vec3(0.0, 0.0, 9.0));
  residuals::check(scene.context);
  ASSERT_EQ(scene.step.report.residuals.size(), 1u) << "of an island without a contact too";
  EXPECT_EQ(scene.step.report.residuals[0].bodies, 1u);
}

TEST(ConstraintKind, OfItsOwnSaysHowLongASubStepMayBeAndHowWellItHolds) {
  Scene scene(Vec3(0.0, 0.0, -10.0));
  const Index i = scene.add(ball("one", 0.1, Vec3::Zero())),
              j = scene.add(ball("other", 0.1, Vec3(5.0, 0.0, 0.0)));
  const Index alone = scene.add(ball("alone", 0.1, Vec3(0.0, 5.0, 0.0)));
  scene.advance({{i, j}}, {});
  const IslandResiduals &tied = scene.step.islands[scene.step.island[i]].residuals,
                        &free = scene.step.islands[scene.step.island[alone]].residuals;
  EXPECT_STREQ(tied.method, "soft_step");
  EXPECT_EQ(tied.iterations, 50u) << "sub-steps of 0.2 ms";
  EXPECT_LE(tied.signorini, 1e-15) << "the last pass finds both at one velocity";
  EXPECT_STREQ(free.method, "");
}

// Of two that are coupled one sleeps: the other wakes it as it moves, in whichever place of the edge it stands.
TEST(ConstraintKind, OfItsOwnWakesWhatSleeps) {
  Scene scene(Vec3::Zero());
  const Index i = scene.add(ball("one", 0.1, Vec3::Zero())),
              j = scene.add(ball("other", 0.1, Vec3(5.0, 0.0, 0.0)));
  scene.scene.rest.resize(2);
  sleep::putToSleep(scene.scene, {i});
  const Edge first{kCoupling, 0, {i, j, kNone, kNone}}, second{kCoupling, 0, {j, kNone, i, kNone}};
  EXPECT_EQ(sleep::reachedSleepers(scene.scene, {first}), std::vector<Index>{i});
  EXPECT_EQ(sleep::reachedSleepers(scene.scene, {second}), std::vector<Index>{i});
  sleep::putToSleep(scene.scene, {j});
  EXPECT_TRUE(sleep::reachedSleepers(scene.scene, {first, second}).empty()) << "none of the two moves";
}

// A ball stands on a plane and bears another, which is coupled to it and stands on nothing.
TEST(ConstraintKind, OfItsOwnIsSolvedBesideContacts) {
  Scene scene(Vec3(0.0, 0.0, -10.0));
  BodyDef ground = body("ground", Plane{}, Vec3::Zero());
  ground.kind = BodyKind::Static;
  BodyDef standing = ball("standing", 0.1, Vec3(0.0, 0.0, 0.1)),
          hanging = ball("hanging", 0.1, Vec3(5.0, 0.0, 7.0));
  standing.mass = 2.0, hanging.mass = 1.0;
  const Index plane = scene.add(ground), i = scene.add(standing), j = scene.add(hanging);
  for (int k = 0; k < 200; ++k) scene.advance({{i, j}}, {{plane, i}});
  ASSERT_EQ(scene.step.islands.size(), 1u);
  ASSERT_EQ(scene.scene.contacts.active.at(0).points.size(), 1u);
  const SolvedPoint& point = scene.scene.contacts.active[0].points[0];
  EXPECT_NEAR(point.normal, 30.0, 0.3) << "the weight of both";
  EXPECT_NEAR(point.normal_impulse, 30.0 * Scene::kStep, 0.003);
  EXPECT_LE(scene.scene.bodies.twist[j].v_WB.norm(), 1e-3);
  EXPECT_NEAR(scene.scene.bodies.pose[j].p_WB.z(), 7.0, 1e-3);
}

}  // namespace
