// SPDX-License-Identifier: BSD-3-Clause
// What the plots record: peaks outlive decimation, time that goes back begins a run, and the table is read back
// by a reader that knows only RFC 4180.
#include "history.h"
#include "physics_time.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

using namespace rbs;

namespace {

constexpr double kStep = 0.1;  // s

std::vector<Sample> randomSamples(std::size_t count) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  std::vector<Sample> samples;
  for (std::size_t i = 0; i < count; ++i) samples.push_back({kStep * static_cast<double>(i), normal(random)});
  return samples;
}

Trace traceOf(const std::vector<Sample>& samples) {
  Trace trace;
  for (const Sample& sample : samples) trace.add(sample);
  return trace;
}

double lowest(const std::vector<Sample>& samples) {
  return std::min_element(samples.begin(), samples.end(),
                          [](const Sample& a, const Sample& b) { return a.value < b.value; })
      ->value;
}

double highest(const std::vector<Sample>& samples) {
  return std::max_element(samples.begin(), samples.end(),
                          [](const Sample& a, const Sample& b) { return a.value < b.value; })
      ->value;
}

bool isOrdered(const std::vector<Sample>& samples) {
  return std::is_sorted(samples.begin(), samples.end(),
                        [](const Sample& a, const Sample& b) { return a.time < b.time; });
}

/// The cells of a CSV, rows first, read one character after the other as RFC 4180 has it.
std::vector<std::vector<std::string>> cellsOf(const std::string& text) {
  std::vector<std::vector<std::string>> rows = {{""}};
  bool is_quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    std::string& cell = rows.back().back();
    if (is_quoted) {
      if (text[i] != '"') {
        cell += text[i];
      } else if (i + 1 < text.size() && text[i + 1] == '"') {
        cell += text[++i];
      } else {
        is_quoted = false;
      }
    } else if (text[i] == '"') {
      is_quoted = true;
    } else if (text[i] == ',') {
      rows.back().emplace_back();
    } else if (text[i] == '\r' && i + 1 < text.size() && text[i + 1] == '\n') {
      rows.push_back({""});
      ++i;
    } else {
      cell += text[i];
    }
  }
  rows.pop_back();  // the last line ends as well
  return rows;
}

TEST(Trace, HasEverySampleOfTheRecentPast) {
  const std::vector<Sample> samples = randomSamples(3 * Trace::kCapacity);
  const std::vector<Sample> kept = traceOf(samples).samples();
  ASSERT_EQ(kept.size(), samples.size());
  for (std::size_t i = 0; i < kept.size(); ++i) {
    EXPECT_EQ(kept[i].time, samples[i].time);
    EXPECT_EQ(kept[i].value, samples[i].value);
  }
}

TEST(Trace, KeepsEqualNeighbours) {
  Trace trace;
  for (std::size_t i = 0; i < 3 * Trace::kCapacity; ++i) trace.add({kStep * static_cast<double>(i), 1.0});
  EXPECT_EQ(trace.size(), 3 * Trace::kCapacity);
}

TEST(Trace, DecimationKeepsEachPeakWhereItWas) {
  constexpr std::size_t kCount = 200 * Trace::kCapacity;
  std::vector<Sample> samples = randomSamples(kCount);
  for (const std::size_t i : {std::size_t(1), kCount / 3, kCount / 2 + 1, kCount - 7}) {
    samples[i].value = 100.0 + static_cast<double>(i);
    samples[i + 2].value = -100.0 - static_cast<double>(i);
  }
  const Trace trace = traceOf(samples);
  const std::vector<Sample> kept = trace.samples();
  EXPECT_LE(kept.size(), 2 * Trace::kLevels * (Trace::kCapacity + 1));
  EXPECT_LT(kept.size(), samples.size() / 5);
  EXPECT_TRUE(isOrdered(kept));
  for (const std::size_t i : {std::size_t(1), kCount / 3, kCount / 2 + 1, kCount - 7})
    for (const Sample& peak : {samples[i], samples[i + 2]})
      EXPECT_TRUE(std::any_of(kept.begin(), kept.end(), [&](const Sample& sample) {
        return sample.time == peak.time && sample.value == peak.value;
      })) << i;
  EXPECT_EQ(kept.back().time, samples.back().time);
}

TEST(Trace, DoesNotGrowWithoutEnd) {
  Trace trace;
  std::size_t largest = 0;
  constexpr std::size_t kHeld = Trace::kCapacity << Trace::kLevels;
  for (std::size_t i = 0; i < 2 * kHeld; ++i) {
    trace.add({static_cast<double>(i), static_cast<double>(i % 97)});
    if (i % kHeld == 0) largest = std::max(largest, trace.size());
  }
  EXPECT_LE(std::max(largest, trace.size()), 2 * Trace::kLevels * (Trace::kCapacity + 1));
  EXPECT_GT(trace.begin(), 0.0);
  EXPECT_EQ(trace.end(), static_cast<double>(2 * kHeld - 1));
}

TEST(Trace, FewSamplesOfAWindowStillHaveItsExtremes) {
  const std::vector<Sample> samples = randomSamples(20000);
  const Trace trace = traceOf(samples);
  for (const double from : {0.0, 333.3, 1700.0, 1990.0}) {
    const double to = from + 150.0;
    const std::vector<Sample> all = trace.samples(from, to, 1u << 30), few = trace.samples(from, to, 50);
    EXPECT_LE(few.size(), 100u);
    EXPECT_TRUE(isOrdered(few));
    EXPECT_EQ(lowest(few), lowest(all));
    EXPECT_EQ(highest(few), highest(all));
  }
}

TEST(Trace, AWindowIsDrawnToItsEdges) {
  const Trace trace = traceOf(randomSamples(100));
  const std::vector<Sample> window = trace.samples(2.05, 3.05, 1000);
  EXPECT_NEAR(window.front().time, 2.0, 1e-12);
  EXPECT_NEAR(window.back().time, 3.1, 1e-12);
  EXPECT_EQ(window.size(), 12u);
}

TEST(Trace, AValueHoldsUntilTheNext) {
  const std::vector<Sample> samples = randomSamples(5000);
  const Trace trace = traceOf(samples);
  EXPECT_FALSE(trace.valueAt(-0.01));
  EXPECT_EQ(trace.valueAt(samples.back().time + 5.0), samples.back().value);
  for (std::size_t i = 5000 - 3 * Trace::kCapacity; i + 1 < 5000; i += 7)
    EXPECT_EQ(trace.valueAt(samples[i].time + 0.5 * kStep), samples[i].value);
}

TEST(Trace, DropsWhatCannotBeDrawn) {
  Trace trace;
  trace.add({1.0, 5.0});
  trace.add({2.0, std::numeric_limits<double>::quiet_NaN()});
  trace.add({2.0, std::numeric_limits<double>::infinity()});
  trace.add({std::numeric_limits<double>::infinity(), 1.0});
  trace.add({0.5, 6.0});
  EXPECT_EQ(trace.size(), 1u);
  trace.add({1.0, 7.0});
  EXPECT_EQ(trace.size(), 1u);
  EXPECT_EQ(trace.valueAt(1.0), 7.0);
}

TEST(History, ARunLeavesTheOneBeforeAndItsMarksBehind) {
  History history;
  history.add("height", {1.0, 10.0});
  history.add("height", {2.0, 20.0});
  history.mark(2.0, "edited");
  history.beginRun();
  history.add("height", {0.5, 30.0});
  EXPECT_EQ(history.present("height").samples().size(), 1u);
  EXPECT_EQ(history.before("height").valueAt(2.0), 20.0);
  EXPECT_EQ(history.end(), 0.5);
  EXPECT_TRUE(history.marks().empty());
  history.beginRun();
  EXPECT_EQ(history.before("height").valueAt(2.0), 30.0);
  EXPECT_TRUE(history.present("height").empty());
  EXPECT_TRUE(history.present("unknown").empty());
}

TEST(History, MarksOfOneMomentAreOneAndAllAreBounded) {
  History history;
  for (int i = 0; i < 5000; ++i) history.mark(1.0, "spawned");
  ASSERT_EQ(history.marks().size(), 1u);
  EXPECT_LT(history.marks().front().text.size(), 200u);
  for (int i = 0; i < 5000; ++i) history.mark(2.0 + i, "edited");
  EXPECT_LE(history.marks().size(), 1000u);
  EXPECT_EQ(history.marks().back().time, 5001.0);
}

TEST(History, TheTableIsReadBackAsItWas) {
  const std::vector<Column> columns = {
      {"energy kinetic (J)", {{0.1, 1.0 / 3.0}, {0.2, -1e-300}}},
      {"height of \"a, b\" (m)", {{0.05, 5.0}, {0.2, 6.02214076e23}}},
  };
  const std::vector<std::vector<std::string>> rows = cellsOf(csvOf(columns));
  ASSERT_EQ(rows.size(), 4u);
  EXPECT_EQ(rows[0], (std::vector<std::string>{"time (s)", "energy kinetic (J)", "height of \"a, b\" (m)"}));
  EXPECT_EQ(rows[1][1], "");
  EXPECT_EQ(rows[2][2], "");
  EXPECT_EQ(std::stod(rows[1][0]), 0.05);
  EXPECT_EQ(std::stod(rows[1][2]), 5.0);
  EXPECT_EQ(std::stod(rows[2][0]), 0.1);
  EXPECT_EQ(std::stod(rows[2][1]), 1.0 / 3.0);
  EXPECT_EQ(std::stod(rows[3][0]), 0.2);
  EXPECT_EQ(std::stod(rows[3][1]), -1e-300);
  EXPECT_EQ(std::stod(rows[3][2]), 6.02214076e23);
}

TEST(PhysicsTime, GoesOnBetweenTwoStatuses) {
  PhysicsTime clock;
  EXPECT_TRUE(clock.isAhead(5.0));
  EXPECT_FALSE(clock.learn(5.0, 4.0));
  EXPECT_FALSE(clock.learn(5.1, 4.1));
  EXPECT_TRUE(clock.isAhead(5.2));
  ASSERT_TRUE(clock.of(5.03));
  EXPECT_NEAR(clock.of(5.03)->time, 4.03, 1e-12);
  EXPECT_TRUE(clock.of(5.03)->is_of_this_run);
  EXPECT_FALSE(clock.of(4.9));
}

TEST(PhysicsTime, AResetBetweenTwoStatusesPartsWhatIsBetweenThem) {
  PhysicsTime clock;
  clock.learn(5.0, 4.0);
  clock.learn(5.1, 4.1);
  EXPECT_TRUE(clock.learn(5.2, 0.04));  // reset at the stamp 5.16
  ASSERT_TRUE(clock.of(5.15));
  EXPECT_FALSE(clock.of(5.15)->is_of_this_run);
  EXPECT_NEAR(clock.of(5.15)->time, 4.15, 1e-12);
  ASSERT_TRUE(clock.of(5.18));
  EXPECT_TRUE(clock.of(5.18)->is_of_this_run);
  EXPECT_NEAR(clock.of(5.18)->time, 0.02, 1e-12);
}

TEST(PhysicsTime, UndoGoesBackIntoTheMiddleAndAheadAgain) {
  PhysicsTime clock;
  clock.learn(5.0, 4.0);
  clock.learn(5.1, 4.1);
  EXPECT_TRUE(clock.learn(5.2, 2.0));
  EXPECT_FALSE(clock.of(5.15));
  EXPECT_EQ(clock.of(5.2)->time, 2.0);
  EXPECT_FALSE(clock.learn(5.3, 2.1));
  EXPECT_TRUE(clock.learn(5.4, 4.2));
}

TEST(PhysicsTime, AnotherStartOfTheSimulatorBeginsARun) {
  PhysicsTime clock;
  clock.learn(5.0, 4.0);
  clock.learn(5.1, 4.1);
  EXPECT_TRUE(clock.learn(1.0, 0.0));
  EXPECT_FALSE(clock.isAhead(0.5));
  EXPECT_FALSE(clock.of(0.5));
  PhysicsTime paused;
  paused.learn(5.0, 0.0);
  EXPECT_TRUE(paused.learn(1.0, 0.0));
}

TEST(PhysicsTime, StampsOfTheWallClockHoldForAStatusAlone) {
  PhysicsTime clock;
  clock.learn(1.7e9, 4.0);
  EXPECT_FALSE(clock.learn(1.7e9 + 0.1, 4.05));
  EXPECT_FALSE(clock.learn(1.7e9 + 0.2, 4.05));  // paused
  EXPECT_FALSE(clock.learn(1.7e9 + 0.3, 4.35));  // faster than the clock
  EXPECT_FALSE(clock.of(1.7e9 + 0.25));
  EXPECT_EQ(clock.of(1.7e9 + 0.3)->time, 4.35);
}

}  // namespace
