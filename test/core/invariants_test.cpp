// SPDX-License-Identifier: BSD-3-Clause
// The check of the stores: it finds nothing in sound ones, and each of the faults put into them here.
#include "state/invariants.h"

#include "make_scene.h"
#include "step/analyse_scene.h"
#include "step/pipeline.h"

#include <gtest/gtest.h>

#include <functional>

namespace rbs::test {
namespace {

// A stack of two boxes, a ball in the air and a kinematic box, at the end of a step.
struct Stores {
  SceneStore scene;
  StepStore step;

  Stores() {
    scene.settings.step = 1.0 / 60.0;
    scene.settings.gravity = kGravity * -Vec3::UnitZ();
    std::vector<BodyDef> bodies{
        floorOf(0.5), box("low", Vec3::Ones(), {0.0, 0.0, 0.5}), box("high", Vec3::Ones(), {0.0, 0.0, 1.5}),
        ball("ball", 0.2, {5.0, 0.0, 3.0}), box("lift", Vec3::Ones(), {9.0, 0.0, 4.0})};
    bodies.back().kind = BodyKind::Kinematic;
    for (const BodyDef& def : bodies) scene.bodies.append({scene.bodies.size() + 1}, def);
    const SceneAnalysis analysis = analyseScene(scene);
    Pipeline pipeline;
    pipeline.filter(analysis);
    step.begin(scene, 0.0, scene.settings.step);
    Context context{scene, step, analysis};
    pipeline.run(context);
  }
};

TEST(Invariants, HoldAtTheEndOfAStep) {
  const Stores stores;
  EXPECT_EQ(invariants::broken(stores.scene), "");
  EXPECT_EQ(invariants::broken(stores.scene, stores.step), "");
  EXPECT_FALSE(stores.scene.contacts.active.at(0).points.empty());
  EXPECT_TRUE(invariants::hold(""));
  EXPECT_FALSE(invariants::hold("a fault"));
}

TEST(Invariants, OfASceneAreFoundBroken) {
  const std::vector<std::pair<const char*, std::function<void(SceneStore&)>>> faults{
      {"the arrays of bodies differ in size", [](auto& s) { s.bodies.color.pop_back(); }},
      {"the analysis has counted other bodies", [](auto& s) { s.counts.entries.pop_back(); }},
      {"the list of rest is of other bodies", [](auto& s) { s.rest.resize(2); }},
      {"body 'low': its number is not above the last one's",
       [](auto& s) { s.bodies.id[1] = s.bodies.id[0]; }},
      {"body 'low': its position is not finite", [](auto& s) { s.bodies.pose[1].p_WB.x() = NAN; }},
      {"body 'low': its quaternion is not of unit length",
       [](auto& s) { s.bodies.pose[1].q_WB.coeffs() *= 1.0 + 1e-8; }},
      {"body 'low': its velocity is not finite", [](auto& s) { s.bodies.twist[1].w_WB.x() = INFINITY; }},
      {"body 'low': its inverse mass is not that of its kind",
       [](auto& s) { s.bodies.inertia[1].inv_mass = 0; }},
      {"body 'low': an inverse moment of inertia is below zero",
       [](auto& s) { s.bodies.inertia[1].inv_moments.x() = -1.0; }},
      {"body 'low': a moment of inertia is not above zero",
       [](auto& s) { s.bodies.inertia[1].moments.setZero(); }},
      {"body 'lift': something may turn it, although nothing turns it",
       [](auto& s) { s.bodies.inertia[4].inv_moments.x() = 1.0; }},
      {"a list of bodies is not in order",
       [](auto& s) {
         s.lists.in_islands = {2, 1, 3};
       }},
      {"a list of bodies that feel an effect is not in order", [](auto& s) { s.lists.feeling[1] = {7}; }},
      {"body 'high': it is not on exactly one list of awake dynamic bodies",
       [](auto& s) { s.lists.ballistic = {2}; }},
      {"body 'lift': the list of kinematic bodies is wrong about it",
       [](auto& s) { s.lists.kinematic.clear(); }},
      {"the broad phase does not sort the bodies that may meet",
       [](auto& s) { s.pair_search.order.pop_back(); }},
  };
  for (const auto& [words, put] : faults) {
    Stores stores;
    put(stores.scene);
    EXPECT_EQ(invariants::broken(stores.scene), words);
  }
}

TEST(Invariants, OfContactsAreFoundBroken) {
  const std::vector<std::pair<const char*, std::function<void(Contacts&)>>> faults{
      {"contacts are not in order", [](auto& c) { std::swap(c.active[0], c.active[1]); }},
      {"the bodies of a contact are not in canonical order",
       [](auto& c) {
         c.dormant.push_back(c.active[0]);
         std::swap(c.dormant[0].key.i, c.dormant[0].key.j);
       }},
      {"the normal of a contact point is not of unit length",
       [](auto& c) { c.active[0].points.at(0).n_W *= 2.0; }},
      {"a contact point pulls", [](auto& c) { c.active[0].points.at(0).normal = -1.0; }},
  };
  for (const auto& [words, put] : faults) {
    Stores stores;
    ASSERT_GT(stores.scene.contacts.active.size(), 1u);
    put(stores.scene.contacts);
    EXPECT_EQ(invariants::broken(stores.scene), words);
  }
}

TEST(Invariants, OfAStepAreFoundBroken) {
  const std::vector<std::pair<const char*, std::function<void(SceneStore&, StepStore&)>>> faults{
      {"the step has arrays of other bodies", [](auto&, auto& s) { s.load.pop_back(); }},
      {"the arrays of the step differ in size", [](auto&, auto& s) { s.stamp.pop_back(); }},
      {"a contact has a body that is not there", [](auto& scene, auto&) { scene.contacts.active[0].j = 99; }},
      {"a contact has other bodies than its key says",
       [](auto& scene, auto&) { scene.contacts.active[0].j = 3; }},
      {"a place in a problem was not given back", [](auto&, auto& s) { s.slot[2] = 0; }},
      {"a body is in two islands", [](auto&, auto& s) { s.islands.push_back(s.islands[0]); }},
      {"body 'ball': it does not know its island", [](auto&, auto& s) { s.island[3] = 9; }},
      {"an island has a contact that is not there", [](auto&, auto& s) { s.islands[0].contacts.at(0) = 99; }},
      {"an island has not come to the end of the step", [](auto&, auto& s) { s.islands[0].time = 0.0; }},
      {"body 'low': the islands do not hold the awake dynamic bodies",
       [](auto&, auto& s) { s.islands[0].bodies.clear(); }},
  };
  for (const auto& [words, put] : faults) {
    Stores stores;
    put(stores.scene, stores.step);
    EXPECT_EQ(invariants::broken(stores.scene, stores.step), words);
  }
}

}  // namespace
}  // namespace rbs::test
