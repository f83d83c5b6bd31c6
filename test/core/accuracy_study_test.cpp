// SPDX-License-Identifier: BSD-3-Clause
// Measuring settings on a scene: the errors are those that a closed form gives, and what cannot be known is
// not told.
#include "make_scene.h"

#include "rigid_body_sim/accuracy.h"
#include "rigid_body_sim/scenes.h"

#include <gmock/gmock.h>

#include <cmath>

using namespace rbs;
using namespace rbs::test;

namespace {

const auto kAlways = [](double, const AccuracyStudy&) { return true; };

constexpr double kFriction = 0.5, kSpeed = 8.0;

SceneDef slidingBox() {
  SceneDef scene = onFloor(1.0 / 60.0, kFriction);
  scene.bodies.push_back(box("box", Vec3(1.0, 1.0, 0.2), Vec3(0.0, 0.0, 0.1)));
  scene.bodies.back().material.friction = kFriction;
  scene.bodies.back().twist.v_WB.x() = kSpeed;
  return scene;
}

const SettingCost& costOf(const AccuracyStudy& study, const Setting& setting) {
  for (const SettingCost& cost : study.settings)
    if (cost.setting == setting) return cost;
  throw std::out_of_range(settingName(setting));
}

// Sliding: x = v t - mu g t²/2.
TEST(AccuracyStudy, FindsTheErrorThatTheClosedFormGives) {
  AccuracyOptions options;
  options.windows = 1;
  const World world(slidingBox());
  const AccuracyStudy study = measureAccuracy(world, options, kAlways);
  ASSERT_EQ(study.trouble, "");
  EXPECT_TRUE(study.complete);
  const double t = study.window;
  EXPECT_NEAR(t, 0.25, 1e-12);
  for (const Fidelity fidelity : kFidelities) {
    World run(world);
    run.setFidelity(fidelity);
    advance(run, t);
    const Vec3 exact(kSpeed * t - 0.5 * kFriction * kGravity * t * t, 0.0, 0.1);
    const double error = (stateOf(run, "box").pose.p_WB - exact).norm() / t;
    const SettingCost& cost = costOf(study, fidelity);
    EXPECT_NEAR(cost.error.distance, error, 1e-3 * error + 1e-9) << fidelityName(fidelity);
    EXPECT_EQ(cost.worst.distance, cost.error.distance);
    EXPECT_GT(cost.step_ms, 0.0);
  }
  EXPECT_GT(costOf(study, Fidelity::Preview).error.distance, 1e-4);
  EXPECT_LT(costOf(study, Fidelity::Accurate).error.distance, 1e-6);
}

TEST(AccuracyStudy, SaysTheSameErrorsAgain) {
  AccuracyOptions options;
  options.windows = 3;
  options.seconds = 1.0;
  const World world(slidingBox());
  const AccuracyStudy a = measureAccuracy(world, options, kAlways),
                      b = measureAccuracy(world, options, kAlways);
  ASSERT_EQ(a.settings.size(), usualSettings().size());
  for (std::size_t k = 0; k < a.settings.size(); ++k) {
    EXPECT_EQ(a.settings[k].error.distance, b.settings[k].error.distance);
    EXPECT_EQ(a.settings[k].worst.angle, b.settings[k].worst.angle);
  }
}

TEST(AccuracyStudy, LeavesTheWorldAlone) {
  const World world(slidingBox());
  const std::uint64_t before = world.stateHash();
  AccuracyOptions options;
  options.windows = 1;
  measureAccuracy(world, options, kAlways);
  EXPECT_EQ(world.stateHash(), before);
}

TEST(AccuracyStudy, EndsWhenToldToAndWhenItsTimeIsOver) {
  const World world(slidingBox());
  AccuracyOptions options;
  int calls = 0;
  const AccuracyStudy stopped =
      measureAccuracy(world, options, [&](double, const AccuracyStudy&) { return ++calls < 10; });
  EXPECT_EQ(calls, 10);
  EXPECT_FALSE(stopped.complete);
  EXPECT_THAT(stopped.trouble,
              testing::HasSubstr("ended before each choice of solver settings had taken one step"));
  EXPECT_EQ(cheapestWithin(stopped, 1.0), nullptr);
  EXPECT_EQ(mostAccurateWithin(stopped, 1e9), nullptr);

  options.windows = 1000;
  options.max_cpu_seconds = 0.2;
  const AccuracyStudy some = measureAccuracy(world, options, kAlways);
  EXPECT_FALSE(some.complete);
  EXPECT_LT(some.windows, 1000u);
}

// In the second half of its time a ball is on the floor, in the first it flies and all settings are right.
TEST(AccuracyStudy, EndedEarlyItHasSeenAllPartsOfThePath) {
  SceneDef scene = onFloor(1.0 / 60.0, kFriction);
  scene.bodies.push_back(box("box", Vec3(1.0, 1.0, 0.2), Vec3(0.0, 0.0, 0.1 + 0.5 * kGravity * 0.81)));
  scene.bodies.back().material.friction = kFriction;
  scene.bodies.back().twist.v_WB.x() = kSpeed;
  const AccuracyStudy study = measureAccuracy(
      World(scene), {}, [](double, const AccuracyStudy& so_far) { return so_far.windows < 2; });
  EXPECT_EQ(study.windows, 2u);
  EXPECT_FALSE(study.complete);
  EXPECT_GT(costOf(study, Fidelity::Preview).error.distance, 1e-4);
}

// As many as are kept at a time, and one more.
TEST(AccuracyStudy, MeasuresAllWindowsThatAreAskedFor) {
  AccuracyOptions options;
  options.seconds = 0.5, options.window = 1.0 / 60.0, options.windows = 17;
  options.settings = {Fidelity::Preview};
  const AccuracyStudy study = measureAccuracy(World(slidingBox()), options, kAlways);
  EXPECT_EQ(study.windows, 17u);
  EXPECT_TRUE(study.complete);
}

TEST(AccuracyStudy, TellsHowFarItIs) {
  const World world(slidingBox());
  AccuracyOptions options;
  options.windows = 4;
  double before = 0.0;
  measureAccuracy(world, options, [&](double share, const AccuracyStudy&) {
    EXPECT_GE(share, before);
    EXPECT_LE(share, 1.0);
    before = share;
    return true;
  });
  EXPECT_GE(before, 0.75);
}

TEST(AccuracyStudy, SaysWhyThereIsNoError) {
  World still(onFloor(1.0 / 60.0, 0.5));
  EXPECT_EQ(measureAccuracy(still, {}, kAlways).trouble, "the scene has no dynamic body");
}

// Tumbling cubes that collide: in ten seconds halving the step of the reference changes everything.
SceneDef tumblingCubes() {
  SceneDef scene = onFloor(1.0 / 60.0, 0.5);
  scene.bodies[0].material.restitution = 0.9;
  for (int k = 0; k < 6; ++k) {
    scene.bodies.push_back(
        box("cube_" + std::to_string(k), Vec3(0.3, 0.3, 0.3), Vec3(0.05 * k, 0.03 * k, 0.5 + 0.5 * k)));
    scene.bodies.back().pose.q_WB = Quat(Eigen::AngleAxisd(0.3 + k, Vec3(1.0, k, 0.5).normalized()));
    scene.bodies.back().material.restitution = 0.9;
    scene.bodies.back().twist.w_WB = Vec3(3.0, 10.0 - k, 5.0);
  }
  return scene;
}

// The only error is that of the reference in half its divisions, its uncertainty: small only until the first
// impact, from which the runs go on together.
TEST(AccuracyStudy, MeasuresAWindowInPiecesInWhichTheReferenceConverges) {
  AccuracyOptions options;
  options.settings = {Fidelity::Reference};
  options.settings[0].divisions = 4;
  options.windows = 1;
  options.window = 10.0;
  options.max_cpu_seconds = 1e4;  // also with sanitizers, which take five times as long
  const AccuracyStudy study = measureAccuracy(World(tumblingCubes()), options, kAlways);
  EXPECT_EQ(study.trouble, "");
  EXPECT_EQ(study.windows, 1u);
  EXPECT_EQ(study.shortened, 1u);
  EXPECT_TRUE(study.complete);
  EXPECT_GE(study.inconclusive, 1u);
  EXPECT_LT(study.inconclusive, 200u);
  EXPECT_NEAR(study.shortest, 1.0 / 60.0, 1e-12);
  EXPECT_TRUE(study.settings[0].at_most);
}

// A cube that falls on its corner, on a loose plate, in large steps. It is in the impact, which no reference knows well, that
// `accurate` errs: the second corner comes down at no time of its own. So the answer is a bound, and no smaller than the
// mean of all whole windows, by a reference that is eight times as fine.
TEST(AccuracyStudy, DoesNotLeaveOutWhatIsHardToPredict) {
  SceneDef scene = onFloor(0.1, 0.5);
  scene.bodies.push_back(box("box", Vec3(0.5, 0.5, 0.5), Vec3(0.0, -3.0, 1.0)));
  scene.bodies.back().pose.q_WB = Quat(Eigen::AngleAxisd(0.576, Vec3(1.0, 2.0, 3.0).normalized()));
  scene.bodies.back().material.restitution = 0.3;
  scene.bodies.back().twist.v_WB.x() = 1.0;
  scene.bodies.push_back(box("plate", Vec3(4.0, 4.0, 0.2), Vec3(0.0, -3.0, 0.1)));
  AccuracyOptions options;
  options.windows = 20, options.window = 0.3;
  options.settings = {Fidelity::Preview, Fidelity::Accurate};
  const AccuracyStudy study = measureAccuracy(World(scene), options, kAlways);
  EXPECT_EQ(study.windows, 20u);

  scene.fidelity = Fidelity::Reference;
  World path(scene);
  double sum = 0.0;
  for (int window = 0; window < 20; ++window, path.step()) {
    Setting fine(Fidelity::Reference);
    fine.divisions = 64;
    World run(path), truth(path);
    run.setFidelity(Fidelity::Accurate);
    truth.setFidelity(fine);
    for (int k = 0; k < 3; ++k) run.step(), truth.step();
    sum += (stateOf(run, "box").pose.p_WB - stateOf(truth, "box").pose.p_WB).norm() / 0.3;
  }
  EXPECT_GT(sum / 20.0, 1e-3) << "an impact in large steps is not easy";
  EXPECT_TRUE(study.settings[1].at_most);
  EXPECT_GE(study.settings[1].error.distance, 0.5 * sum / 20.0);
  EXPECT_EQ(cheapestWithin(study, 0.2 * sum / 20.0), nullptr);
}

// However many windows are required: those that were measured lie along all of the path. The box is on the
// floor in the second half of it.
TEST(AccuracyStudy, EndedEarlyItHasSeenAllPartsOfThePathOfManyWindows) {
  SceneDef scene = onFloor(1.0 / 240.0, kFriction);
  scene.bodies.push_back(box("box", Vec3(1.0, 1.0, 0.2), Vec3(0.0, 0.0, 0.1 + 0.5 * kGravity * 0.81)));
  scene.bodies.back().material.friction = kFriction;
  scene.bodies.back().twist.v_WB.x() = kSpeed;
  AccuracyOptions options;
  options.windows = 400, options.window = 1.0 / 240.0, options.settings = {Fidelity::Preview};
  const auto errorAfter = [&](std::uint32_t windows) {
    const AccuracyStudy study =
        measureAccuracy(World(scene), options,
                        [&](double, const AccuracyStudy& so_far) { return so_far.windows <= windows; });
    return study.settings[0].error.distance;
  };
  const double all = errorAfter(400);
  EXPECT_GT(all, 1e-5);
  EXPECT_NEAR(errorAfter(32), all, 0.3 * all);
  EXPECT_NEAR(errorAfter(100), all, 0.15 * all);
}

// Steps of a second: there are two windows in two seconds, not one eight times.
TEST(AccuracyStudy, MeasuresNoWindowTwice) {
  SceneDef scene = onFloor(1.0, kFriction);
  scene.bodies.push_back(box("box", Vec3(0.4, 0.4, 0.4), Vec3(0.0, 0.0, 5.0)));
  const AccuracyStudy study = measureAccuracy(World(scene), {}, kAlways);
  EXPECT_EQ(study.windows, 2u);
  EXPECT_TRUE(study.complete);
}

// The exact step knows no rebound but that of located impacts: its ball lies where others rebound.
TEST(AccuracyStudy, HasNoReferenceForReboundsWithoutLocatedImpacts) {
  SceneDef scene = onFloor(1.0 / 60.0, kFriction);
  scene.bodies.push_back(ball("ball", 0.2, Vec3(0.0, 0.0, 1.2)));
  scene.effects[Effect::Impacts] = false;
  EXPECT_EQ(measureAccuracy(World(scene), {}, kAlways).trouble, "");
  scene.bodies.back().material.restitution = 0.8;
  EXPECT_THAT(measureAccuracy(World(scene), {}, kAlways).trouble, testing::HasSubstr("has no restitution"));
  scene.effects[Effect::Restitution] = false;
  EXPECT_EQ(measureAccuracy(World(scene), {}, kAlways).trouble, "");
}

// A look at the clock takes as long as the step of one ball, and is not part of it.
TEST(AccuracyStudy, LooksAtTheClockAreNoPartOfAStep) {
  SceneDef scene;
  scene.bodies.push_back(ball("ball", 0.2, Vec3::Zero()));
  AccuracyOptions options;
  options.seconds = 100.0, options.windows = 1, options.settings = {Fidelity::Preview};
  int calls = 0;
  measureAccuracy(World(scene), options, [&](double, const AccuracyStudy&) { return ++calls > 0; });
  EXPECT_LT(calls, 1000) << "of more than 6,000 steps";
}

// The largest error is that of the reference in half its divisions: which is the uncertainty, and tells
// nothing.
TEST(AccuracyStudy, WhereTheReferenceDoesNotConvergeForAStepErrorsAreBounds) {
  SceneDef scene = slidingBox();
  scene.bodies.back().twist.w_WB.y() = 1.0;
  World world(scene);
  AccuracyOptions options;
  options.settings = {Fidelity::Reference, Fidelity::Reference};
  options.settings[1].divisions = 4;
  options.windows = 2;
  options.seconds = 0.05;
  const AccuracyStudy study = measureAccuracy(world, options, kAlways);
  EXPECT_EQ(study.trouble, "");
  for (const SettingCost& cost : study.settings) {
    EXPECT_TRUE(cost.at_most);
    EXPECT_GE(cost.error.distance, study.uncertainty.distance);
    EXPECT_GE(cost.worst.distance, cost.error.distance);
  }
}

// By counted steps: the first answer takes one step of each setting and of the three runs of the reference.
TEST(AccuracyStudy, EveryStepOfTheScheduleRefinesAnAnswerThatIsThereFromTheFirst) {
  for (const char* name : {"playground", "gas", "mixed_rain"}) {
    const World world(readScene(std::string(RBS_SCENES) + "/" + name + ".yaml").scene);
    const std::size_t runs = usualSettings().size() + 3;
    std::size_t steps = 0;
    const AccuracyStudy study = measureAccuracy(world, {}, [&](double, const AccuracyStudy& so_far) {
      ++steps;
      EXPECT_EQ(so_far.windows, steps > runs ? 1u : 0u) << name << " " << steps;
      return steps <= 2 * runs;
    });
    EXPECT_EQ(study.trouble, "") << name;
    EXPECT_GT(study.first_answer, 0.0) << name;
    for (const SettingCost& cost : study.settings) {
      EXPECT_TRUE(std::isfinite(cost.error.distance)) << name;
      EXPECT_GT(cost.step_ms, 0.0) << name;
      EXPECT_GE(cost.steps, 1u) << name;
    }
    EXPECT_NE(cheapestWithin(study, 1e3), nullptr) << name;
  }
}

// Which could not be measured: collisions part the reference from its own half step within a quarter of a
// second. Where that is so, the window ends earlier, or the error is told as a bound.
TEST(AccuracyStudy, MeasuresTheDemosOwnScene) {
  const World world(readScene(std::string(RBS_SCENES) + "/playground.yaml").scene);
  AccuracyOptions options;
  options.windows = 1;
  options.settings = {Fidelity::Preview, Fidelity::Interactive};
  const AccuracyStudy study = measureAccuracy(world, options, kAlways);
  EXPECT_EQ(study.trouble, "");
  EXPECT_TRUE(study.complete);
  EXPECT_EQ(study.windows, 1u);
  EXPECT_GT(costOf(study, Fidelity::Preview).error.distance, 1e-3);
  EXPECT_LT(costOf(study, Fidelity::Preview).error.distance, 10.0);
  EXPECT_GT(costOf(study, Fidelity::Interactive).error.distance, 0.0);
}

TEST(AccuracyStudy, RefusesWhatMakesNoSense) {
  const World world(slidingBox());
  const auto refused = [&](auto change) {
    AccuracyOptions options;
    change(options);
    EXPECT_THROW(measureAccuracy(world, options, kAlways), InvalidInput);
  };
  refused([](AccuracyOptions& o) { o.seconds = 0.0; });
  refused([](AccuracyOptions& o) { o.window = NAN; });
  refused([](AccuracyOptions& o) { o.windows = 0; });
  refused([](AccuracyOptions& o) { o.max_cpu_seconds = -1.0; });
  refused([](AccuracyOptions& o) { o.settings.resize(1), o.settings[0].divisions = 0; });
}

TEST(Choice, TakesTheCheapestThatIsGoodEnoughAndTheBestThatIsCheapEnough) {
  AccuracyStudy study;
  study.windows = 1;
  study.uncertainty.distance = 1e-9;
  const auto add = [&](Fidelity fidelity, double ms, double error) {
    study.settings.emplace_back();
    study.settings.back().setting = fidelity;
    study.settings.back().step_ms = ms;
    study.settings.back().error.distance = error;
  };
  add(Fidelity::Preview, 0.1, 1e-2);
  add(Fidelity::Interactive, 0.4, 1e-4);
  add(Fidelity::Accurate, 2.0, 1e-11);
  add(Fidelity::Reference, 3.0, 1e-12);
  EXPECT_EQ(cheapestWithin(study, 1e-3)->setting, Setting(Fidelity::Interactive));
  EXPECT_EQ(cheapestWithin(study, 1.0)->setting, Setting(Fidelity::Preview));
  EXPECT_EQ(cheapestWithin(study, 1e-13), nullptr);
  EXPECT_EQ(mostAccurateWithin(study, 1.0)->setting, Setting(Fidelity::Interactive));
  EXPECT_EQ(mostAccurateWithin(study, 10.0)->setting, Setting(Fidelity::Accurate))
      << "both are too small to be measured";
  EXPECT_EQ(mostAccurateWithin(study, 0.01), nullptr);
  study.uncertainty.distance = 2e-5;
  study.settings[2].error.distance = 1.2e-4, study.settings[3].error.distance = 6e-5;
  EXPECT_EQ(mostAccurateWithin(study, 10.0)->setting, Setting(Fidelity::Reference))
      << "not measured to a tenth, but known to be the better";
}

}  // namespace
