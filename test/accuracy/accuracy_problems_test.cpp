// SPDX-License-Identifier: BSD-3-Clause
// The exact answers of the accuracy problems, against motions that are found another way: Newton's law
// integrated with steps so small that their error is known, impacts found by bisection, other libraries'
// integration of a top.
#include "free_top_oracle.h"
#include "measure.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace rbs::accuracy {
namespace {

const Problem& problem(const std::string& name) {
  const auto it =
      std::find_if(problems().begin(), problems().end(), [&](const Problem& p) { return p.name == name; });
  if (it == problems().end()) throw std::runtime_error("no problem " + name);
  return *it;
}

/// The motions of a scene as it starts.
std::vector<Motion> start(const Problem& p) {
  std::vector<Motion> motions;
  for (const BodyDef& body : p.task.scene.bodies) motions.push_back({body.pose, body.twist});
  return motions;
}

/// That the exact answer agrees with these motions, and would not with others a little off.
void expectExact(const Problem& p, double time, std::vector<Motion> motions, double tolerance) {
  EXPECT_LE(p.error(time, motions), tolerance) << p.name << " at " << time;
  for (std::size_t k = 0; k < motions.size(); ++k) {
    if (p.task.scene.bodies[k].kind != BodyKind::Dynamic) continue;
    std::vector<Motion> off = motions;
    off[k].pose.p_WB += Vec3(1e-3, 2e-3, -1e-3) * 100;
    off[k].pose.q_WB = Quat(Eigen::AngleAxisd(0.1, Vec3::UnitX())) * off[k].pose.q_WB;
    EXPECT_GT(p.error(time, off), 1e-3) << p.name << ": body " << k << " does not count";
  }
}

using State = Eigen::Array4d;

/// Classical Runge-Kutta of fourth order.
template <class Rate>
State integrated(State s, double time, int steps, const Rate& rate) {
  const double h = time / steps;
  for (int k = 0; k < steps; ++k) {
    const State a = rate(s), b = rate(s + 0.5 * h * a), c = rate(s + 0.5 * h * b), d = rate(s + h * c);
    s += h / 6 * (a + 2 * b + 2 * c + d);
  }
  return s;
}

TEST(AccuracyProblems, everyOneIsSoundAndSaysWhatItIs) {
  ASSERT_GE(problems().size(), 13u);
  for (const Problem& p : problems()) {
    EXPECT_TRUE(validate(p.task.scene).empty()) << p.name;
    EXPECT_FALSE(p.sentence.empty() || p.measure.empty()) << p.name;
    EXPECT_TRUE(p.against == "exact" || p.against == "invariant") << p.name;
    EXPECT_TRUE(std::is_sorted(p.steps.rbegin(), p.steps.rend())) << p.name;
    for (double step : p.steps) EXPECT_NEAR(std::round(p.duration / step) * step, p.duration, 1e-9) << p.name;
    EXPECT_EQ(1, std::count_if(problems().begin(), problems().end(),
                               [&](const Problem& q) { return q.name == p.name; }));
  }
}

TEST(AccuracyProblems, projectileFollowsFromNewtonsLaw) {
  const Problem& p = problem("projectile");
  std::vector<Motion> m = start(p);
  const Vec3 v = m[0].twist.v_WB;
  const State z = integrated({m[0].pose.p_WB.z(), v.z(), 0, 0}, p.duration, 1000,
                             [](const State& s) { return State(s[1], -9.81, 0, 0); });
  m[0].pose.p_WB = Vec3(v.x() * p.duration, v.y() * p.duration, z[0]);
  expectExact(p, p.duration, m, 1e-13);
}

TEST(AccuracyProblems, topsAgreeWithExtrapolatedMidpoints) {
  for (const char* name : {"dzhanibekov", "slow_tumble"}) {
    const Problem& p = problem(name);
    std::vector<Motion> m = start(p);
    const Vec3 moments = momentsPerMass(p.task.scene.bodies[0].shape);
    const Vec3 l = moments.cwiseProduct(m[0].twist.w_WB);
    m[0].pose.q_WB = oracle::orientationOf(oracle::integrated(l, moments, p.duration));
    expectExact(p, p.duration, m, 1e-12);
  }
}

TEST(AccuracyProblems, bouncesFollowFromFlightsThatEndWhereBisectionFindsTheFloor) {
  for (const auto& [name, e] :
       {std::pair<const char*, double>{"bounce_elastic", 1.0}, {"bounce_damped", 0.8}}) {
    const Problem& p = problem(name);
    for (const double end : {0.3, 1.0, 1.9, p.duration}) {
      double z = 1.0, v = 0.0, time = 0.0;
      const auto height = [&](double t) { return z + v * t - 0.5 * 9.81 * t * t; };
      for (;;) {
        double lo = std::max(0.0, v / 9.81), hi = lo + 10;  // from the top of the flight on
        for (int k = 0; k < 200; ++k) (height(0.5 * (lo + hi)) > 0 ? lo : hi) = 0.5 * (lo + hi);
        if (time + lo > end) break;
        time += lo;
        v = e * (9.81 * lo - v), z = 0.0;
      }
      std::vector<Motion> m = start(p);
      m[1].pose.p_WB.z() = 0.5 + height(end - time);
      expectExact(p, end, m, 1e-11);
    }
  }
}

// Stiff springs between the balls, k -> infinity: an independent law of impact, right to the share of time in
// touch.
TEST(AccuracyProblems, elasticChainIsTheLimitOfStiffSprings) {
  const Problem& p = problem("elastic_chain");
  const auto worst = [&](double stiffness) {
    std::vector<Motion> m = start(p);
    const double h = 0.02 / std::sqrt(stiffness);
    const int steps = static_cast<int>(p.duration / h) + 1;
    std::array<double, 5> x{}, v{}, mass{}, a{};
    for (int k = 0; k < 5; ++k)
      x[k] = m[k].pose.p_WB.x(), v[k] = m[k].twist.v_WB.x(), mass[k] = *p.task.scene.bodies[k].mass;
    const auto accelerate = [&] {
      a.fill(0.0);
      for (int k = 0; k < 4; ++k) {
        const double f = stiffness * std::max(0.0, x[k] + 0.2 - x[k + 1]);
        a[k] -= f / mass[k], a[k + 1] += f / mass[k + 1];
      }
    };
    const double step = p.duration / steps;
    accelerate();
    for (int n = 0; n < steps; ++n) {
      for (int k = 0; k < 5; ++k) v[k] += 0.5 * step * a[k], x[k] += step * v[k];
      accelerate();
      for (int k = 0; k < 5; ++k) v[k] += 0.5 * step * a[k];
    }
    for (int k = 0; k < 5; ++k) m[k].pose.p_WB.x() = x[k];
    return p.error(p.duration, m);
  };
  const double soft = worst(1e6), stiff = worst(1e8);
  EXPECT_LT(stiff, 1e-3);            // measured: see the ratio below
  EXPECT_NEAR(soft / stiff, 10, 3);  // the time in touch, and with it the error, falls as 1/sqrt(stiffness)
}

TEST(AccuracyProblems, gasCountsEnergyAndNoticesABallThatLeft) {
  const Problem& p = problem("gas");
  std::vector<Motion> m = start(p);
  EXPECT_LE(p.error(0.0, m), 1e-15);
  // Energy without momentum in common: balls exchange their velocities, and a ball trades running for
  // spinning.
  std::swap(m[6].twist, m[20].twist);
  EXPECT_LE(p.error(0.0, m), 1e-14);
  const double v = m[6].twist.v_WB.norm();
  m[6].twist = {Vec3::Zero(), Vec3(0, v / std::sqrt(0.4) / 0.1, 0)};
  EXPECT_LE(p.error(0.0, m), 1e-14);
  m[7].twist.v_WB *= 1.01;
  EXPECT_GT(p.error(0.0, m), 1e-5);
  m[8].pose.p_WB.x() = 1.2;
  EXPECT_TRUE(std::isinf(p.error(0.0, m)));
}

// Coulomb's law for the centre of the box, smoothed: force mu m g tanh(v/eps), which is the law but for a
// creep of eps.
TEST(AccuracyProblems, slidingFollowsFromCoulombsLawIntegrated) {
  const auto slide = [](double v0, double pull, double mu_n, double time) {
    return integrated({0, v0, 0, 0}, time, 400000, [&](const State& s) {
      return State(s[1], pull - mu_n * std::tanh(s[1] / 1e-4), 0, 0);
    });
  };
  const Problem& stop = problem("sliding_stop");
  for (const double time : {0.5, stop.duration}) {
    std::vector<Motion> m = start(stop);
    const double way = slide(5.0, 0.0, 0.5 * 9.81, time)[0], heading = 20 * M_PI / 180;
    m[1].pose.p_WB += way * Vec3(std::cos(heading), std::sin(heading), 0);
    expectExact(stop, time, m, 2e-7);
  }
  const Problem& slip = problem("slope_slip");
  std::vector<Motion> m = start(slip);
  const double angle = 35 * M_PI / 180;
  m[1].pose.p_WB.x() += slide(0.0, 9.81 * std::sin(angle), 0.5 * 9.81 * std::cos(angle), slip.duration)[0];
  expectExact(slip, slip.duration, m, 1e-4);  // the creep at the start
  expectExact(problem("slope_stick"), 5.0, start(problem("slope_stick")), 0.0);
}

TEST(AccuracyProblems, rollingFollowsFromFrictionThatEndsTheSlip) {
  const Problem& p = problem("sliding_to_rolling");
  // x, v, spin; friction against the slip v - R w, smoothed.
  const State s = integrated({0, 10, 0, 0}, p.duration, 400000, [](const State& s) {
    const double f = 0.3 * 9.81 * std::tanh((s[1] - 0.5 * s[2]) / 1e-4);
    return State(s[1], -f, f * 0.5 / (0.4 * 0.25), 0);
  });
  std::vector<Motion> m = start(p);
  m[1].pose.p_WB.x() = s[0];
  m[1].twist = {Vec3(s[1], 0, 0), Vec3(0, s[2], 0)};
  expectExact(p, p.duration, m, 1e-6);

  // The plate and one of its balls; all others do as that one.
  const Problem& plate = problem("rolling_oblique");
  const State t = integrated({0, 0, 0, 0}, plate.duration, 400000, [](const State& s) {
    // v of the plate, v of a ball, R w of a ball, way of the plate
    const double slip = s[0] - s[1] - s[2];
    const double f2 = 0.8 * 9.81 * std::tanh(slip / 1e-3);
    return State((150 - 0.4 * 35 * 9.81 - 25 * f2) / 10, f2, 2.5 * f2, s[0]);
  });
  std::vector<Motion> moved = start(plate);
  const Vec3 along(0.5, std::sqrt(0.75), 0);
  for (std::size_t k = 1; k < moved.size(); ++k)
    moved[k].pose.p_WB += t[3] * (k == 1 ? 1.0 : t[1] / t[0]) * along;
  expectExact(plate, plate.duration, moved, 1e-3);
}

TEST(AccuracyProblems, whatStandsStays) {
  for (const char* name : {"stack", "mass_ratio"}) expectExact(problem(name), 2.0, start(problem(name)), 0.0);
}

// The impact drawn out: the normal impulse grows bit by bit, and friction acts against what slip there is.
TEST(AccuracyProblems, obliqueImpactsFollowFromAnImpactDrawnOut) {
  const Problem& p = problem("oblique_impact");
  std::vector<Motion> m = start(p);
  const double meets = 0.4137, mu = 0.3, e = 0.5, R = 0.1;
  for (std::size_t k = 1; k <= 2; ++k) {
    const Vec3 v = m[k].twist.v_WB;
    double along = v.x(), spin = 0.0;
    constexpr int kParts = 1000000;
    const double part = (1 + e) * -v.z() / kParts;
    for (int n = 0; n < kParts; ++n) {
      const double slip = along - R * spin;
      const double friction = std::min(mu * part, slip / 3.5);
      along -= friction, spin += friction * R / (0.4 * R * R);
    }
    const double after = p.duration - meets;
    m[k].pose.p_WB += meets * v + after * Vec3(along, 0, -e * v.z());
    m[k].twist = {Vec3(along, 0, -e * v.z()), Vec3(0, spin, 0)};
  }
  expectExact(p, p.duration, m, 1e-6);
}

TEST(AccuracyProblems, fallThroughAirFollowsFromTheLawOfDrag) {
  const Problem& p = problem("terminal_velocity");
  std::vector<Motion> m = start(p);
  const State s = integrated({0, 0, 0, 0}, p.duration, 20000, [](const State& s) {
    return State(s[1], 9.81 - 0.5 * 1.2 * 0.47 * M_PI * 0.0025 * s[1] * s[1] / 0.05, 0, 0);
  });
  m[0].pose.p_WB.z() -= s[0];
  expectExact(p, p.duration, m, 1e-12);
}

// --- the measurement

TEST(AccuracyMeasurement, anAnswerThatIsNotFiniteIsAFailureAndNoFigure) {
  class Broken : public peers::Engine {
    void step() override {}
    std::vector<Motion> read() const override { return {{{Vec3(NAN, 0, 0), Quat::Identity()}, {}}}; }
  };
  const Measurement m =
      measure(problem("projectile"),
              {"broken", "", "", "", [](const auto&) { return std::make_unique<Broken>(); }}, {});
  ASSERT_TRUE(m.failure);
  EXPECT_EQ("not finite", m.failure->kind);
}

TEST(AccuracyMeasurement, aRunOverItsTimeIsAFailureAndNoFigure) {
  class Slow : public peers::Engine {
    void step() override {
      for (int k = 0; k < 1000000; ++k) sink_ = sink_ + 1.0;
    }
    std::vector<Motion> read() const override { return {}; }
    volatile double sink_ = 0.0;
  };
  Request request;
  request.max_seconds = 1e-4;
  const Measurement m =
      measure(problem("projectile"),
              {"slow", "", "", "", [](const auto&) { return std::make_unique<Slow>(); }}, request);
  ASSERT_TRUE(m.failure);
  EXPECT_EQ("too slow", m.failure->kind);
}

TEST(AccuracyMeasurement, whatAnEngineDoesNotHaveIsAFailureThatSaysSo) {
  for (const peers::EngineSetting& engine : peers::engineSettings()) {
    const Measurement m = measure(problem("terminal_velocity"), engine, {});
    if (engine.engine == "ours") {
      EXPECT_FALSE(m.failure) << m.failure->detail;
      continue;
    }
    ASSERT_TRUE(m.failure) << engine.engine;
    EXPECT_EQ("not supported", m.failure->kind) << engine.engine;
  }
}

TEST(AccuracyMeasurement, theSameMeasurementTwiceGivesTheSameErrorToTheBit) {
  for (const peers::EngineSetting& engine : peers::engineSettings()) {
    const Measurement a = measure(problem("sliding_stop"), engine, {}),
                      b = measure(problem("sliding_stop"), engine, {});
    ASSERT_FALSE(a.failure) << engine.engine << ": " << a.failure->detail;
    EXPECT_EQ(a.error, b.error) << engine.engine << ' ' << engine.setting;
  }
}

// That every adapter makes the scene that it was given: what all engines do right, they must do right here.
// The box has moments of 1 : 0.77 : 0.38; one that is mixed up turns it elsewhere by radians.
TEST(AccuracyMeasurement, allEnginesThrowTheSameBallAndTumbleTheSameBox) {
  Request fine;
  fine.step = 1.0 / 960;
  for (const peers::EngineSetting& engine : peers::engineSettings()) {
    const Measurement flight = measure(problem("projectile"), engine, fine);
    ASSERT_FALSE(flight.failure) << engine.engine << ": " << flight.failure->detail;
    EXPECT_LT(flight.error, 1e-3) << engine.engine << ' ' << engine.setting;  // g t dt/2 is 5e-4
    const Measurement tumble = measure(problem("slow_tumble"), engine, fine);
    ASSERT_FALSE(tumble.failure) << engine.engine << ": " << tumble.failure->detail;
    EXPECT_LT(tumble.error, 0.2) << engine.engine << ' ' << engine.setting;  // ODE: 0.107, of first order
  }
}

}  // namespace
}  // namespace rbs::accuracy
