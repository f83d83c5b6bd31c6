// SPDX-License-Identifier: BSD-3-Clause
// The pace of a simulation, on a clock that the test turns: it never looks at the one on the wall.
#include "simulator/pacer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

using namespace rbs;

namespace {

// A simulation whose steps and pictures take as long as they are told to.
struct Rig {
  double step = 1.0 / 60.0, speed = 1.0;             // s, times real time
  double step_seconds = 0.0, picture_seconds = 0.0;  // of wall time
  Pacer pacer{};
  double now = 0.0, simulated = 0.0;
  std::vector<double> pictures{};  // when they were taken

  Pacer::Time at(double s) const {
    return Pacer::Time{} +
           std::chrono::duration_cast<Pacer::Clock::duration>(std::chrono::duration<double>(s));
  }
  // As the simulator does: a step when one is due, a picture of it when that is due.
  void until(double end) {
    for (bool stale = false; now < end;) {
      if (at(now) >= pacer.nextStep()) {
        const double begin = now;
        now += step_seconds;
        simulated += step;
        pacer.stepped(at(begin), at(now), step);
        stale = true;
      } else if (!stale) {
        now += 1e-4;
      }
      if (!stale) continue;
      if (at(now) >= pacer.nextPicture()) {
        const double begin = now;
        now += picture_seconds;
        pacer.pictured(at(begin), at(now));
        pictures.push_back(begin);
        stale = false;
      } else if (at(now) < pacer.nextStep()) {
        now += 1e-4;
      }
    }
  }
  void begin() { pacer.restart(at(now), speed, step); }
  double achieved() const { return pacer.achievedSpeed(at(now)); }
  double longestGap() const {
    double longest = 0.0;
    for (std::size_t k = 1; k < pictures.size(); ++k)
      longest = std::max(longest, pictures[k] - pictures[k - 1]);
    return longest;
  }
};

// Found by random calls: 1e-300 of real time made an interval that no clock can hold.
TEST(Pacer, TheNextStepOfASpeedNearZeroIsInTheFarFuture) {
  Pacer pacer;
  const Pacer::Time now = Pacer::Time{} + std::chrono::hours(24);
  pacer.restart(now, 1e-300, 1.0 / 60.0);
  pacer.stepped(now, now, 1.0 / 60.0);
  EXPECT_GT(pacer.nextStep(), now + std::chrono::hours(24 * 365));
  EXPECT_GE(pacer.achievedSpeed(now), 0.0);
}

// A slider changes the speed many times a second.
TEST(Pacer, AChangeOfSpeedBringsNoStepForward) {
  Rig rig;
  rig.speed = 0.01;  // a step each 1.67 s
  rig.pacer.restart(rig.at(0.0), rig.speed, rig.step);
  rig.until(0.1);
  EXPECT_NEAR(rig.simulated, rig.step, 1e-12);
  for (int k = 1; k <= 100; ++k) {
    rig.pacer.restart(rig.at(rig.now), k % 2 ? 0.02 : 0.01, rig.step, rig.pacer.left(rig.at(rig.now)));
    rig.until(0.1 + 0.01 * k);
  }
  EXPECT_NEAR(rig.simulated, rig.step, 1e-12);  // 1.1 s at 0.01 to 0.02
  rig.until(2.0);
  EXPECT_NEAR(rig.simulated, 2.0 * rig.step, 1e-12);
}

TEST(Pacer, KeepsTheSpeedThatItCanKeep) {
  for (const double speed : {0.1, 1.0, 3.0}) {
    Rig run;
    run.speed = speed;
    run.step_seconds = 0.002;
    run.begin();
    run.until(5.0);
    EXPECT_NEAR(run.simulated, 5.0 * speed, 2.0 * run.step);
    EXPECT_NEAR(run.achieved(), speed, 0.02 * speed);
    EXPECT_EQ(run.pacer.lostTime(), 0.0);
  }
}

TEST(Pacer, ShowsEveryStepThatIsSlowEnoughToBeSeen) {
  Rig run;
  run.step_seconds = 0.002;
  run.begin();
  run.until(5.0);
  EXPECT_NEAR(run.pictures.size(), 300.0, 2.0);
}

TEST(Pacer, OfQuickStepsOnlyEightyASecondAreShown) {
  Rig run;
  run.speed = 0.0;
  run.step_seconds = 1e-4;
  run.begin();
  run.until(1.0);
  EXPECT_LE(run.pictures.size(), 81u);
  EXPECT_GE(run.pictures.size(), 75u);
}

// What no step that has caught up, and so no picture, ever came of: the lag is beyond the largest for good.
TEST(Pacer, ShowsTenPicturesASecondHoweverFarBehindItIs) {
  for (const double step_seconds : {0.02, 0.05, 0.09}) {
    for (const double speed : {1.0, 10.0, 1e6}) {
      Rig run;
      run.speed = speed;
      run.step_seconds = step_seconds;
      run.begin();
      run.until(10.0);
      EXPECT_LE(run.longestGap(), 0.1) << step_seconds << " s a step, " << speed << " x";
    }
  }
}

TEST(Pacer, TellsTheSpeedThatItComesToAndTheTimeThatItLoses) {
  Rig run;
  run.speed = 10.0;
  run.step_seconds = 0.05;
  run.begin();
  run.until(10.0);
  EXPECT_NEAR(run.achieved(), run.step / run.step_seconds, 1e-2);
  // What was asked for is what was simulated and what was lost, but for the lag that may yet be made up for.
  EXPECT_NEAR(run.simulated + run.pacer.lostTime(), 10.0 * 10.0, 10.0 * 0.16);
}

TEST(Pacer, AHitchIsMadeUpForIfItIsShort) {
  Rig run;
  run.begin();
  run.until(1.0);
  run.step_seconds = 0.09;
  run.until(1.05);
  run.step_seconds = 1e-4;
  run.until(2.0);
  EXPECT_NEAR(run.simulated, 2.0, 2.0 * run.step);
  EXPECT_EQ(run.pacer.lostTime(), 0.0);
}

TEST(Pacer, ALateStepCountsBeforeItHasEnded) {
  Rig run;
  run.step_seconds = 0.001;
  run.begin();
  run.until(3.0);
  EXPECT_NEAR(run.achieved(), 1.0, 0.02);
  EXPECT_NEAR(run.pacer.achievedSpeed(run.at(run.now + 4.0)), 1.0 / 5.0, 0.02);
  EXPECT_LE(run.pacer.late(run.at(run.now)), run.step_seconds);
  EXPECT_NEAR(run.pacer.late(run.at(run.now + 4.0)), 4.0, run.step);
}

TEST(Pacer, PicturesTakeATenthOfTheTime) {
  Rig run;
  run.picture_seconds = 0.004;
  run.step_seconds = 0.001;
  run.speed = 0.0;
  run.begin();
  run.until(4.0);
  EXPECT_LE(run.pictures.size() * run.picture_seconds, 0.1 * 4.0 * 1.05);
  run.pictures.clear();
  run.picture_seconds = 0.03;
  run.until(8.0);
  EXPECT_LE(run.longestGap(), 0.1 + run.step_seconds);
}

TEST(Pacer, SaysWhatWasAskedForUntilThereIsSomethingToMeasure) {
  Rig run;
  run.speed = 2.0;
  run.begin();
  EXPECT_EQ(run.achieved(), 2.0);
  EXPECT_EQ(run.pacer.late(run.at(run.now)), 0.0);
}

}  // namespace
