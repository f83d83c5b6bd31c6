// SPDX-License-Identifier: BSD-3-Clause
// Restitution and impacts.
#include "measure.h"

#include <algorithm>
#include <numeric>

namespace rbs::stability {
namespace {

using namespace test;

/// A frictionless elastic ball of a mass.
BodyDef billiardBall(const std::string& name, double radius, double mass, const Vec3& p_W) {
  BodyDef def = ball(name, radius, p_W);
  def.mass = mass;
  def.material.friction = 0.0;
  def.material.restitution = 1.0;
  return def;
}

std::string inSteps(double step) {
  char text[32];
  std::snprintf(text, sizeof text, ", steps of %.3g s", step);
  return text;
}

void bouncing(Sheet& sheet) {
  std::vector<double> steps{1e-1, 1e-2, 1e-3};
  if (sheet.length(false, true)) steps.insert(steps.end(), {1e-4, 1e-5});
  for (const double step : steps) {
    SceneDef scene = fromCatalogue("bouncing_49");
    scene.step = step;
    scene.fidelity = sheet.setting();
    World world(scene);
    const long double start = 49.0L * 10.0L * static_cast<long double>(kGravity) * 5.0L;
    long double sum = 0.0L;
    const long count = std::lround(20.0 / step);
    // Every step down to 1e-3 s; below that, every 1e-3 s of it, so that the sums do not cost more than the
    // steps.
    const long stride = std::max(1L, count / 20000);
    long samples = 0;
    for (long k = 1; k <= count; ++k) {
      world.step();
      if (k % stride != 0) continue;
      const long double error = energyOf(world) - start;
      sum += error * error, ++samples;
    }
    sheet.error("mean squared error of the energy" + inSteps(step), "J²", static_cast<double>(sum / samples),
                closedForm(1e-16));
  }
}

// A ball let fall over a gap of 1 m comes to the floor at t0 = sqrt(2/g), and the bounce n after the first is
// at t0 (1 + 2 e (1 - e^n)/(1 - e)).
double bounceTime(double e, int n) {
  return std::sqrt(2.0 / kGravity) * (1.0 + 2.0 * e * (1.0 - std::pow(e, n)) / (1.0 - e));
}

SceneDef bouncingBall(double step, double e) {
  SceneDef scene = onFloor(step, 0.6);
  scene.bodies.push_back(ball("ball", 0.5, Vec3(0.0, 0.0, 1.5)));
  scene.bodies.back().material.restitution = e;
  return scene;
}

/// The gap to the floor at any time, of the closed form.
double exactGap(double e, double t) {
  double start = std::sqrt(2.0 / kGravity), speed = e * kGravity * start;
  if (t < start) return 1.0 - 0.5 * kGravity * t * t;
  while (t > start + 2.0 * speed / kGravity) {
    start += 2.0 * speed / kGravity, speed *= e;
    if (speed < 1e-15) return 0.0;
  }
  return (t - start) * (speed - 0.5 * kGravity * (t - start));
}

void bounceToRest(Sheet& sheet) {
  for (const double e : {0.0, 0.1, 0.5, 0.9, 0.99}) {
    char which[32];
    std::snprintf(which, sizeof which, ", e = %g", e);

    // Steps so short that each of the first twelve bounces has its own; its time is read off the parabola
    // after it.
    Watch fine(bouncingBall(1e-4, e), sheet.setting());
    double worst = 0.0;
    int bounces = 0;
    // With small e the bounces are soon shorter than any step.
    const int asked = e == 0.0 ? 1 : e < 0.5 ? 3 : 12;
    const double last = e == 0.0 ? bounceTime(e, 0) : bounceTime(e, asked - 1);
    while (bounces < asked && fine.world().time() < last + 1e-3) {
      const std::uint64_t before = fine.impacts();
      fine.step();
      if (fine.impacts() == before) continue;
      const BodyState state = fine["ball"];
      const double gap = state.pose.p_WB.z() - 0.5, v = state.twist.v_WB.z();
      const double since = (-v + std::sqrt(std::max(0.0, v * v + 2.0 * kGravity * gap))) / kGravity;
      const double time = e == 0.0 ? bounceTime(e, 0) : fine.world().time() - since;
      worst = std::max(worst, std::abs(time - bounceTime(e, bounces++)));
    }
    sheet.value(std::string("first bounces found") + which, "", bounces, asked, closedForm(0.0));
    sheet.error(std::string("times of the first bounces") + which, "s", worst, closedForm(1e-9));

    // At the ordinary step: height throughout, and rest.
    Watch watch(bouncingBall(kFrame, e), sheet.setting());
    double height = 0.0;
    const double total = std::sqrt(2.0 / kGravity) * (1.0 + e) / (1.0 - e);
    while (watch.world().time() < std::min(total, 10.0) + 1.0) {
      watch.step();
      height =
          std::max(height, std::abs(watch["ball"].pose.p_WB.z() - 0.5 - exactGap(e, watch.world().time())));
    }
    sheet.error(std::string("height at every step of 1/60 s") + which, "m", height, exact(1e-9));
    watch.run(std::max(0.0, total + 1.0 - watch.world().time()));
    const std::uint64_t events = watch.impacts();
    const BodyState rest = watch["ball"];
    watch.run(2.0);
    sheet.error(std::string("speed at rest") + which, "m/s", watch["ball"].twist.v_WB.norm(),
                fastAndReference(1e-12, 1e-12));
    sheet.error(std::string("drift at rest") + which, "m", (watch["ball"].pose.p_WB - rest.pose.p_WB).norm(),
                exact(0.0));
    sheet.error(std::string("impacts after rest") + which, "", watch.impacts() - events, every(0.0));
    sheet.error(std::string("impacts before rest") + which, "", events, every(5000.0));
  }

  // When it is at rest, to a microsecond: the last bounces at steps of that length.
  Watch coarse(bouncingBall(1e-4, 0.5), sheet.setting());
  coarse.run(1.35);
  SceneDef scene = coarse.world().capture();
  scene.step = 1e-6;
  World world(scene, coarse.world().captureState());
  const double asked = 3.0 * std::sqrt(2.0 / kGravity);
  while (world.time() < asked + 1e-3 && stateOf(world, "ball").twist.v_WB.norm() > 1e-12) world.step();
  sheet.value("time of rest, e = 0.5", "s", world.time(), asked, exact(1e-6));
}

// With n from 1 to 2, the contact's velocity u has the normal part u_n, which takes J = -(1+e) m u_n, and a
// tangential part, which takes 2/7 m |u_t| to stop, or mu J if that is less; 1/m = 1/m1 + 1/m2.
void obliqueSpheres(Sheet& sheet) {
  const double r1 = 0.5, r2 = 0.7, m1 = 1.0, m2 = 3.0, m = 0.75;
  struct Worst {
    double velocity = 0.0, momentum = 0.0, angular = 0.0;
  } full, grazing;
  for (const double e : {0.0, 0.5, 1.0}) {
    for (const double mu : {0.0, 0.3}) {
      for (const double share : {0.0, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99, 0.999}) {
        SceneDef scene = emptySpace(kFrame);
        const Vec3 d(2.0, share * (r1 + r2), 0.0);
        scene.bodies = {ball("one", r1, Vec3::Zero()), ball("two", r2, d)};
        for (BodyDef& def : scene.bodies) def.material.friction = mu, def.material.restitution = e;
        scene.bodies[0].mass = m1, scene.bodies[1].mass = m2;
        const Vec3 v1(3.0, 0.0, 0.0), w1(1.0, 4.0, 5.0), v2(-1.0, 0.0, 0.0), w2(2.0, 0.0, -1.0);
        scene.bodies[0].twist = {v1, w1}, scene.bodies[1].twist = {v2, w2};
        scene.fidelity = sheet.setting();
        World world(scene);
        const Totals before = world.totals();
        advance(world, 0.6);

        Worst& worst = share > 0.95 ? grazing : full;
        const Vec3 v = v2 - v1;
        const double b = d.dot(v), c = d.squaredNorm() - (r1 + r2) * (r1 + r2);
        const double t = c / (-b + std::sqrt(b * b - v.squaredNorm() * c));
        const Vec3 n = (d + t * v) / (r1 + r2);
        const Vec3 u = v - (r2 * w2 + r1 * w1).cross(n);
        const double u_n = u.dot(n), J = -(1.0 + e) * m * u_n;
        const Vec3 u_t = u - u_n * n;
        const double stick = 2.0 / 7.0 * m * u_t.norm(), f = std::min(stick, mu * J);
        const Vec3 P = J * n - (u_t.norm() > 0.0 ? Vec3(f / u_t.norm() * u_t) : Vec3::Zero());  // on two
        const double I1 = 0.4 * m1 * r1 * r1, I2 = 0.4 * m2 * r2 * r2;
        const BodyState one = stateOf(world, "one"), two = stateOf(world, "two");
        worst.velocity = std::max({worst.velocity, (one.twist.v_WB - (v1 - P / m1)).norm(),
                                   (two.twist.v_WB - (v2 + P / m2)).norm(),
                                   r1 * (one.twist.w_WB - (w1 - (r1 * n).cross(P) / I1)).norm(),
                                   r2 * (two.twist.w_WB - (w2 - (r2 * n).cross(P) / I2)).norm()});
        const Totals after = world.totals();
        worst.momentum = std::max(worst.momentum, (after.momentum - before.momentum).norm());
        worst.angular = std::max(worst.angular, (after.angular_momentum - before.angular_momentum).norm());
      }
    }
  }
  const auto write = [&sheet](const Worst& worst, const std::string& which) {
    sheet.error("velocities after, of the 4 m/s of approach" + which, "", worst.velocity / 4.0,
                closedForm(1e-13));
    sheet.error("momentum, of the largest of one ball" + which, "", worst.momentum / 3.0, closedForm(1e-14));
    sheet.error("angular momentum, of the largest of one ball" + which, "", worst.angular / 3.6,
                closedForm(1e-14));
  };
  write(full, "");
  write(grazing, ", grazing at 0.99 and 0.999");
}

std::vector<double> cradle(Fidelity setting, const std::vector<double>& masses,
                           const std::vector<double>& speeds, double gap) {
  SceneDef scene = emptySpace(kFrame);
  for (std::size_t k = 0; k < speeds.size(); ++k) {
    scene.bodies.push_back(billiardBall("ball_" + std::to_string(k), 0.5, masses[k],
                                        Vec3(k * (1.0 + gap) + (speeds[k] == 0.0 ? 0.25 : 0.0), 0.0, 0.0)));
    scene.bodies.back().twist.v_WB.x() = speeds[k];
  }
  scene.fidelity = setting;
  World world(scene);
  advance(world, 1.0);
  std::vector<double> after;
  for (const BodyState& state : world.snapshot().states) after.push_back(state.twist.v_WB.x());
  return after;
}

double worstOf(const std::vector<double>& is, const std::vector<double>& expected) {
  double worst = 0.0;
  for (std::size_t k = 0; k < is.size(); ++k) worst = std::max(worst, std::abs(is[k] - expected[k]));
  return worst;
}

void newtonsCradle(Sheet& sheet) {
  const std::vector<double> equal(5, 1.0);
  for (const double gap : {0.0, 1e-9, 1e-3}) {
    char which[32];
    std::snprintf(which, sizeof which, ", gaps of %g m", gap);
    sheet.error(std::string("one comes, one leaves") + which, "m/s",
                worstOf(cradle(sheet.setting(), equal, {1, 0, 0, 0, 0}, gap), {0, 0, 0, 0, 1}),
                closedForm(1e-12));
    sheet.error(std::string("two come, two leave") + which, "m/s",
                worstOf(cradle(sheet.setting(), equal, {1, 1, 0, 0, 0}, gap), {0, 0, 0, 1, 1}),
                closedForm(1e-12));
  }
  // One after the other: the first on the heavy one, then that on the last.
  const double first = -999.0 / 1001.0, second = 2.0 / 1001.0;
  sheet.error("three touching balls, 1 : 1000 : 1", "m/s",
              worstOf(cradle(sheet.setting(), {1, 1000, 1}, {1, 0, 0}, 0.0),
                      {first, second * 999.0 / 1001.0, second * 2000.0 / 1001.0}),
              closedForm(1e-12));
}

// G. Galperin, "Playing pool with pi", 2003. All along z, so that nothing is rounded sideways.
void billiardOfPi(Sheet& sheet) {
  const int digits[] = {3, 31, 314, 3141, 31415, 314159};
  for (int k = 0; k < sheet.length(6, 3, 6); ++k) {
    SceneDef scene = emptySpace(kFrame);
    scene.bodies = {floorOf(0.0), billiardBall("light", 0.5, 1.0, Vec3(0.0, 0.0, 2.0)),
                    billiardBall("heavy", 0.5, std::pow(100.0, k), Vec3(0.0, 0.0, 4.0))};
    scene.bodies[2].twist.v_WB.z() = -1.0;
    scene.fidelity = sheet.setting();
    World world(scene);
    const double before = energy(world);
    std::uint64_t count = 0;
    for (int step = 0; step < 12 * 60; ++step) count += world.step().impacts;
    const std::string which = ", masses 1 : 1e" + std::to_string(2 * k);
    sheet.value("impacts" + which, "", count, digits[k], closedForm(0.0));
    sheet.error("energy, relative" + which, "", energy(world) / before - 1.0, closedForm(1e-11));
  }
}

/// The largest overlap of any two balls of equal radius, or of a ball and the floor, m; and the sum of the
/// squares.
struct Overlaps {
  double deepest = 0.0, squares = 0.0;
};

Overlaps overlapsOfBalls(const World& world, double radius) {
  std::vector<Vec3> centres;
  const Snapshot snapshot = world.snapshot();
  for (std::size_t k = 0; k < snapshot.states.size(); ++k)
    if ((*snapshot.bodies)[k].kind == BodyKind::Dynamic) centres.push_back(snapshot.states[k].pose.p_WB);
  Overlaps result;
  const auto add = [&result](double depth) {
    if (depth <= 0.0) return;
    result.deepest = std::max(result.deepest, depth);
    result.squares += depth * depth;
  };
  for (std::size_t i = 0; i < centres.size(); ++i) {
    add(radius - centres[i].z());
    for (std::size_t j = i + 1; j < centres.size(); ++j)
      if ((centres[i] - centres[j]).squaredNorm() < 4.0 * radius * radius)
        add(2.0 * radius - (centres[i] - centres[j]).norm());
  }
  return result;
}

void elastic666(Sheet& sheet) {
  SceneDef scene = fromCatalogue("elastic_666");
  scene.step = 0.01;
  scene.fidelity = sheet.setting();
  World world(scene);
  const long double start = energyOf(world);
  long double sum = 0.0L;
  double deepest = 0.0;
  const long steps = std::lround(sheet.length(4.0, 0.5, 10.0) / scene.step);
  for (long k = 0; k < steps; ++k) {
    world.step();
    const long double error = energyOf(world) - start;
    sum += error * error;
    deepest = std::max(deepest, overlapsOfBalls(world, 0.1).deepest);
  }
  sheet.error("mean squared error of the energy", "J²", static_cast<double>(sum / steps), closedForm(1e-16));
  sheet.error("deepest overlap", "m", deepest, closedForm(1e-12));
}

void balls666(Sheet& sheet) {
  SceneDef scene = fromCatalogue("balls_666");
  scene.step = 0.01;
  Watch watch(scene, sheet.setting());
  double sum = 0.0, deepest = 0.0;
  const long steps = std::lround(sheet.length(3.0, 0.1, 10.0) / scene.step);
  for (long k = 0; k < steps; ++k) {
    watch.step();
    const Overlaps overlaps = overlapsOfBalls(watch.world(), 0.1);
    sum += overlaps.squares / steps;
    deepest = std::max(deepest, overlaps.deepest);
  }
  sheet.error("sum of the squared overlaps, mean over time", "m²", sum, exact(1e-9));
  sheet.error("deepest overlap", "m", deepest, shown());
  watch.writePromises(sheet);
}

void flatAndOnEdge(Sheet& sheet) {
  SceneDef flat = onFloor(kFrame, 0.6);
  flat.bodies.push_back(box("box", Vec3(1.0, 0.6, 0.4), Vec3(0.3, -0.2, 1.2)));
  flat.bodies.back().material.restitution = 0.5;
  Watch falls(flat, sheet.setting());
  const double arrival = std::sqrt(2.0 / kGravity);
  while (falls.world().time() < arrival + 0.1) falls.step();
  const Twist twist = falls["box"].twist;
  const double since = falls.world().time() - arrival;
  sheet.error("speed of rebound, flat", "m/s", twist.v_WB.z() - (0.5 * kGravity * arrival - kGravity * since),
              closedForm(1e-10));
  sheet.error("spin after, flat", "rad/s", twist.w_WB.norm(), closedForm(1e-12));

  // A rod at angle th, without friction: J = (1+e) v/(1/m + (l cos th)²/I), l its lever's length. The lowest
  // edge is at (1, -0.05) in the rod's x and z.
  for (const double th : {0.2, 0.5, 1.0}) {
    const double e = 0.5, x = std::cos(th) - 0.05 * std::sin(th), z = std::sin(th) + 0.05 * std::cos(th);
    SceneDef scene = onFloor(kFrame, 0.0);
    BodyDef rod = box("rod", Vec3(2.0, 0.1, 0.1), Vec3(0.0, 0.0, 2.0));
    rod.pose.q_WB = Quat(Eigen::AngleAxisd(th, Vec3::UnitY()));
    rod.mass = 1.0;
    rod.material.restitution = e;
    scene.bodies.push_back(rod);
    Watch watch(scene, sheet.setting());
    const bool met =
        watch.runUntil(2.0, [](const World& world) { return stateOf(world, "rod").twist.w_WB.norm() > 0.0; });
    const double fall = std::sqrt(2.0 * kGravity * (2.0 - z)), I = (4.0 + 0.01) / 12.0;
    const double J = (1.0 + e) * fall / (1.0 + x * x / I);
    const double spin = met ? std::abs(watch["rod"].twist.w_WB.y()) : 0.0;
    char which[48];
    std::snprintf(which, sizeof which, "spin of a rod at %g rad, relative", th);
    sheet.error(which, "", spin / (J * x / I) - 1.0, closedForm(1e-10));
  }
}

void bouncyStack(Sheet& sheet) {
  SceneDef scene = onFloor(kFrame, 0.6);
  for (int k = 0; k < 10; ++k) {
    scene.bodies.push_back(box("box_" + std::to_string(k), Vec3::Ones(), Vec3(0.0, 0.0, 1.0 + k)));
    scene.bodies.back().material.restitution = 0.8;
  }
  Watch watch(scene, sheet.setting());
  double risen = -1.0;
  const long steps = std::lround(sheet.length(8.0, 20.0) / kFrame);
  for (long k = 0; k < steps; ++k) {
    watch.step();
    for (int b = 0; b < 10; ++b)
      risen = std::max(risen, watch["box_" + std::to_string(b)].pose.p_WB.z() - (1.0 + b));
  }
  sheet.check("no box above where it started", risen <= 1e-9, fastAndExact(0.0, 0.0));
  sheet.error("speed at the end", "m/s", fastestPoint(watch.world()), fastAndReference(1e-4, 1e-9));
  watch.writePromises(sheet);
}

// The largest distance between the distribution of the velocities' components and a normal one (Kolmogorov,
// Smirnov).
double distanceToNormal(std::vector<double> values) {
  double squares = 0.0;
  for (const double v : values) squares += v * v;
  const double deviation = std::sqrt(squares / values.size());
  std::sort(values.begin(), values.end());
  double worst = 0.0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    const double normal = 0.5 * std::erfc(-values[k] / (deviation * std::sqrt(2.0)));
    worst = std::max({worst, normal - static_cast<double>(k) / values.size(),
                      static_cast<double>(k + 1) / values.size() - normal});
  }
  return worst;
}

void gas(Sheet& sheet) {
  SceneDef scene = fromCatalogue("gas");
  scene.fidelity = sheet.setting();
  World world(scene);
  const double start = world.totals().kinetic_energy;
  advance(world, sheet.length(1.5, 0.5, 100.0));
  sheet.error("energy, relative", "", world.totals().kinetic_energy / start - 1.0, fastAndExact(1e-2, 1e-12));
  int escaped = 0;
  std::vector<double> components;
  const Snapshot snapshot = world.snapshot();
  for (std::size_t k = 0; k < snapshot.states.size(); ++k) {
    if ((*snapshot.bodies)[k].kind != BodyKind::Dynamic) continue;
    escaped += snapshot.states[k].pose.p_WB.lpNorm<Eigen::Infinity>() > 5.0;
    for (int axis = 0; axis < 3; ++axis) components.push_back(snapshot.states[k].twist.v_WB[axis]);
  }
  sheet.error("escaped balls", "", escaped, every(0.0));
  // 1.63/sqrt(n) is the distance that one normal sample in a hundred exceeds.
  sheet.error("velocities: distance to a normal distribution, of that at p = 0.01", "",
              distanceToNormal(components) * std::sqrt(components.size()) / 1.63, closedForm(1.0));
}

}  // namespace

std::vector<Case> impactCases() {
  return {
      {"A10", "49 bouncing balls",
       "49 elastic balls of 10 kg (R = 0.1 m) fall from 5 m and bounce for 20 s, at steps from 1e-5 (from "
       "1e-3 in the "
       "tests) to 1e-1 s. Measured: the mean over time of (E − E0)², E0 = 24,034.5 J (SimBenchmark's "
       "measure; scene "
       "bouncing_49).",
       bouncing},
      {"A11", "A ball bounces to rest",
       "A ball (R = 0.5 m) falls over a gap of 1 m, with restitution e. Bounce n is at t0 (1 + 2e(1 − eⁿ)/(1 "
       "− e)), rest "
       "at t0 (1 + e)/(1 − e), t0 = √(2/g). The times of the first twelve (for e = 0.1 three) are read at "
       "steps of 1e-4 "
       "s, the rest at 1/60 s.",
       bounceToRest},
      {"A12", "Two spheres meet obliquely",
       "Spheres of 1 and 3 kg, R = 0.5 and 0.7 m, with spin, meet at 4 m/s; the offset goes from 0 to 0.999 "
       "of the sum "
       "of the radii, e from 0 to 1, μ is 0 or 0.3. Exact: J = (1 + e) m u_n, and friction that stops the "
       "sliding, 2/7 m "
       "u_t, or μ J.",
       obliqueSpheres},
      {"A13", "Newton's cradle",
       "Five elastic balls in a row, touching or with gaps of 1e-9 or 1e-3 m; one or two come at 1 m/s. "
       "Three touching "
       "balls of 1, 1000 and 1 kg. Law: simultaneous impacts are a sequence of impacts between two, so as "
       "many leave as "
       "came.",
       newtonsCradle},
      {"A14", "The billiard that counts π",
       "A ball of 1 kg rests between a wall and one of 100^k kg that comes at 1 m/s, all elastic: wall and "
       "balls meet 3, "
       "31, 314, 3141, 31415, 314159 times (Galperin 2003).",
       billiardOfPi},
      {"A15", "Elastic 666",
       "216 elastic balls without friction (R = 0.1 m, 10 kg) in a cube of gap 0.21 m, each out of line by "
       "up to 1e-3 m, "
       "fall from 1.1 m for 10 s (4 s in the tests) at steps of 0.01 s (scene elastic_666; SimBenchmark's "
       "measure).",
       elastic666},
      {"A16", "Inelastic 666",
       "The same cube without rebound, from 1 mm above the floor (scene balls_666), 10 s (3 s in the tests) "
       "at steps of "
       "0.01 s. Measured: the sum over pairs of the squared overlap, averaged over time (SimBenchmark's "
       "measure).",
       balls666},
      {"A18", "Flat and on its edge",
       "A box falls flat from 1 m with e = 0.5: it leaves at e v, without spin. A rod of 2 m falls on its "
       "edge at "
       "0.2, 0.5 and 1 rad, without friction: J = (1 + e) v/(1/m + x²/I), x its lever.",
       flatAndOnEdge},
      {"A19", "A bouncy stack",
       "Ten cubes of 1 m with e = 0.8, one on the other, dropped together from 0.5 m; 20 s (8 s in the "
       "tests).",
       bouncyStack},
      {"A20", "Gas in a box",
       "500 elastic balls (R = 0.1 m) of about 100 m/s in a closed box of 10 m for 100 s (1.5 s in the "
       "tests) at 60 Hz "
       "(scene gas). Collisions make the velocities normally distributed.",
       gas},
  };
}

}  // namespace rbs::stability
