// SPDX-License-Identifier: BSD-3-Clause
// Random sequences of edits and steps, with numbers as people give them: nothing ends the program, all stays finite, and
// a copy and a resumed state go on as the world does.
#include "make_scene.h"

#include <gtest/gtest.h>

#include <random>

using namespace rbs;
using namespace rbs::test;

namespace {

class Edits {
 public:
  explicit Edits(unsigned seed) : random_(seed), world_(emptyScene()) {
    if (chance(0.85)) world_.addBody(floorOf(0.5));
    for (int k = 0; k < 8; ++k) spawn();
  }

  void run(int edits) {
    for (int k = 0; k < edits && !::testing::Test::HasFailure(); ++k) {
      edit();
      for (const BodyState& state : world_.states()) {
        ASSERT_TRUE(state.pose.p_WB.allFinite() && state.pose.q_WB.coeffs().allFinite() &&
                    state.twist.v_WB.allFinite() && state.twist.w_WB.allFinite())
            << "after edit " << k;
      }
    }
  }

 private:
  double uniform(double from, double to) { return std::uniform_real_distribution<>(from, to)(random_); }
  bool chance(double share) { return uniform(0.0, 1.0) < share; }
  template <class T>
  T oneOf(std::initializer_list<T> list) {
    return list.begin()[random_() % list.size()];
  }
  Vec3 vector(double most) { return {uniform(-most, most), uniform(-most, most), uniform(-most, most)}; }
  Vec3 place() { return {uniform(-0.7, 0.7), uniform(-0.7, 0.7), uniform(0.1, 2.5)}; }

  SceneDef emptyScene() {
    SceneDef scene;
    scene.step = oneOf({1.0 / 240.0, 1.0 / 60.0, 1.0 / 30.0});
    scene.fidelity = kFidelities[random_() % kFidelities.size()];
    if (chance(0.4)) scene.effects[Effect::Sleeping] = true;
    return scene;
  }

  Shape shape() {
    const double size = uniform(0.1, 0.5);
    switch (random_() % 5) {
      case 0:
        return Sphere{size};
      case 1:
        return Box{size * Vec3(uniform(0.2, 2.0), uniform(0.2, 2.0), uniform(0.2, 2.0))};
      case 2:
        return Capsule{size / 2.0, size * uniform(0.1, 2.0)};
      case 3:
        return Cylinder{size, size * uniform(0.1, 3.0)};
      default:
        return Cone{size, size * uniform(0.3, 3.0)};
    }
  }

  void spawn() {
    BodyDef def = body("body_" + std::to_string(spawned_++), shape(), place());
    if (chance(0.7)) def.pose.q_WB = Quat::FromTwoVectors(Vec3::UnitZ(), vector(1.0));
    def.kind = oneOf({BodyKind::Dynamic, BodyKind::Dynamic, BodyKind::Dynamic, BodyKind::Kinematic});
    if (chance(0.6)) def.twist = {vector(2.0), vector(5.0)};
    def.material.friction = oneOf({0.0, 0.5, 1.0});
    def.material.restitution = oneOf({0.0, 0.0, 0.5, 1.0});
    if (chance(0.2)) def.material.rolling_resistance = 0.01;
    if (chance(0.2)) def.material.torsional_resistance = 0.01;
    if (chance(0.3)) def.density = std::pow(10.0, uniform(1.0, 4.5));
    if (chance(0.2)) def.mask = random_() % 4;
    if (chance(0.2)) def.group = 1 + random_() % 3;
    world_.addBody(def);
  }

  BodyEdit change() {
    BodyEdit edit;
    if (chance(0.15)) edit.kind = oneOf({BodyKind::Dynamic, BodyKind::Static, BodyKind::Kinematic});
    if (chance(0.15)) edit.shape = shape();
    if (chance(0.15)) edit.pose = Pose{place(), Quat::Identity()};
    if (chance(0.15)) edit.twist = Twist{vector(2.0), vector(5.0)};
    if (chance(0.15)) edit.restitution = oneOf({0.0, 0.5, 1.0});
    if (chance(0.15)) edit.torsional_resistance = oneOf({0.0, 0.02});
    if (chance(0.15)) edit.mask = oneOf({0u, 1u, 2u, ~0u});
    if (chance(0.15)) edit.density = std::pow(10.0, uniform(1.0, 4.0));
    return edit;
  }

  void edit() {
    const std::vector<BodyDescription> bodies = *world_.bodies();
    const BodyId id = bodies.empty() ? BodyId{} : bodies[random_() % bodies.size()].id;
    try {
      switch (random_() % 20) {
        case 0:
          return world_.setEffects(overrides());
        case 1:
        case 2:
          return world_.editBody(id, change());
        case 3:
          return spawn();
        case 4:
          return world_.removeBody(id);
        case 5:
          return world_.setGravity({0.0, 0.0, oneOf({0.0, -9.81, 9.81})});
        case 6:
          return world_.setAir(chance(0.5) ? std::optional<Air>() : Air{oneOf({1.2, 100.0})});
        case 7:
          return world_.setWind(Wind{vector(3.0), oneOf({0.0, 1.0})});
        case 8:
          return world_.setFluid(chance(0.5) ? std::optional<Fluid>() : Fluid{1000.0, uniform(-1.0, 2.0)});
        case 9:
          return world_.setFidelity(kFidelities[random_() % kFidelities.size()]);
        case 10:
          return world_.grab(id, Grab{Vec3::Zero(), place()});
        case 11:
          return world_.hold(id, Pose{place(), Quat::Identity()});
        case 12:
          return world_.release(id);
        case 13:
          return world_.applyWrench(id, vector(10.0), vector(1.0), vector(1.0), oneOf({0.05, 1.0}));
        case 14:
          return chance(0.1) ? world_.clear() : world_.applyImpulse(id, vector(1.0), vector(0.3));
        case 15:
          return stepBeside(World(world_), "a copy");
        case 16:
          return stepBeside(World(world_.capture(), world_.captureExactState()), "a resumed state");
        default:
          for (std::size_t k = random_() % 40; k > 0; --k) step();
      }
    } catch (const InvalidInput&) {  // a plane has no mass, a static body cannot be pulled, and so on
    }
  }

  EffectOverrides overrides() {
    EffectOverrides effects;
    for (const Effect effect : kEffects)
      if (chance(0.2)) effects[effect] = chance(0.4);
    return effects;
  }

  void step() {
    for (const Warning& warning : world_.step().warnings)
      ASSERT_NE(warning.kind, "non_finite") << warning.text;
  }

  void stepBeside(World other, const char* what) {
    ASSERT_EQ(other.stateHash(), world_.stateHash()) << what << " differs";
    for (int k = 0; k < 8; ++k) {
      step(), other.step();
      ASSERT_EQ(other.stateHash(), world_.stateHash()) << what << " differs after " << k + 1 << " steps";
    }
  }

  std::mt19937 random_;
  World world_;
  int spawned_ = 0;
};

TEST(RandomEdits, LeaveAWorldThatGoesOn) {
  for (unsigned seed = 0; seed < 400 && !HasFailure(); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Edits(seed).run(20);
  }
}

}  // namespace
