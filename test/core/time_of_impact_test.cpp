// Times of impact against closed forms, and never late where there is none.
#include "narrowphase/time_of_impact.h"

#include "core/narrowphase_oracles.h"
#include "narrowphase/collide.h"

#include <gtest/gtest.h>

namespace rbs {
namespace {

using oracle::Random;

constexpr double kG = 9.81;
const Vec3 kGravity(0.0, 0.0, -kG);

Motion still(const Vec3& p, const Quat& q = Quat::Identity()) {
  Motion motion;
  motion.pose = {p, q};
  return motion;
}

Motion moving(const Vec3& p, const Vec3& v, const Vec3& a = Vec3::Zero(), const Vec3& w = Vec3::Zero()) {
  Motion motion = still(p);
  motion.twist = {v, w};
  motion.a_W = a;
  return motion;
}

// Both orders must agree; the answer, or -1 for none.
double impact(const Shape& a, const Motion& motion_a, const Shape& b, const Motion& motion_b, double to,
              double from = 0.0) {
  const double ab = timeOfImpact(a, motion_a, b, motion_b, from, to).value_or(-1.0);
  const double ba = timeOfImpact(b, motion_b, a, motion_a, from, to).value_or(-1.0);
  EXPECT_NEAR(ab, ba, 1e-12 * std::max(1.0, to));
  return ab;
}

// Hard case A54: a bullet that passes 16 m in a step, against a wall of 1 mm.
TEST(TimeOfImpact, BulletMeetsThinWall) {
  const Sphere bullet{0.01};
  const Motion flight = moving({-10.0, 0.1, 0.2}, {1e3, 0, 0}),
               falling = moving({-10.0, 0.1, 0.2}, {1e3, 0, 0}, kGravity);
  const double truth = (10.0 - 0.01 - 0.0005) / 1e3;
  for (const Motion& motion : {flight, falling}) {
    EXPECT_NEAR(impact(bullet, motion, Box{{0.001, 2, 2}}, still({0, 0, 0}), 1.0 / 60), truth, 1e-15);
    const Quat facing(Eigen::AngleAxisd(-EIGEN_PI / 2, Vec3::UnitY()));
    EXPECT_NEAR(impact(bullet, motion, Plane{}, still({-0.0005, 0, 0}, facing), 1.0 / 60), truth, 1e-15);
  }
  EXPECT_EQ(
      impact(bullet, moving({-10, 1.0101, 0}, {1e3, 0, 0}), Box{{0.001, 2, 2}}, still({0, 0, 0}), 1.0 / 60),
      -1.0);
  EXPECT_GT(
      impact(bullet, moving({-10, 1.0099, 0}, {1e3, 0, 0}), Box{{0.001, 2, 2}}, still({0, 0, 0}), 1.0 / 60),
      0.0);
}

TEST(TimeOfImpact, SpheresOnALine) {
  const Sphere ball{0.5};
  EXPECT_DOUBLE_EQ(impact(ball, moving({0, 0, 0}, {3, 0, 0}), ball, moving({5, 0, 0}, {-1, 0, 0}), 2.0), 1.0);
  EXPECT_EQ(impact(ball, moving({0, 0, 0}, {3, 0, 0}), ball, moving({5, 0, 0}, {-1, 0, 0}), 0.99), -1.0);
  // Falling together changes nothing.
  EXPECT_DOUBLE_EQ(impact(ball, moving({0, 0, 9}, {3, 0, 0}, kGravity), ball,
                          moving({5, 0, 9}, {-1, 0, 0}, kGravity), 2.0),
                   1.0);
  // Off centre by 0.6 of the sum of the radii: contact at a distance of 0.8.
  EXPECT_DOUBLE_EQ(impact(ball, moving({0, 0.6, 0}, {1, 0, 0}), ball, still({5, 0, 0}), 9.0), 4.2);
  EXPECT_EQ(impact(ball, moving({0, 1.001, 0}, {1, 0, 0}), ball, still({5, 0, 0}), 9.0), -1.0);
  EXPECT_EQ(impact(ball, moving({0, 0, 0}, {-1, 0, 0}), ball, still({5, 0, 0}), 9.0), -1.0);
}

TEST(TimeOfImpact, TouchingPairs) {
  const Sphere ball{0.5};
  const Box box{Vec3::Ones()};
  const Motion floor = still({0, 0, 0}), block = still({0, 0, -0.5});
  for (const double gap : {0.0, 1e-13, -1e-13, -1e-3, -0.2}) {
    const Vec3 p(0.1, 0.2, 0.5 + gap);
    for (const Shape& body : {Shape(ball), Shape(box)})
      for (const auto& [ground, motion] :
           {std::pair(Shape(Plane{}), floor), std::pair(Shape(Box{{9, 9, 1}}), block)}) {
        EXPECT_EQ(impact(body, moving(p, {1, 0, -1}), ground, motion, 1.0), 0.0) << gap;
        EXPECT_EQ(impact(body, moving(p, {1, 0, 1}), ground, motion, 1.0), -1.0) << gap;
        EXPECT_EQ(impact(body, moving(p, {1, 0, 0}), ground, motion, 1.0), -1.0) << gap;
        EXPECT_EQ(impact(body, moving(p, {1, 0, 0}, kGravity), ground, motion, 1.0), 0.0) << gap;
      }
  }
  EXPECT_EQ(impact(ball, moving({0, 0, 0}, {1, 0, 0}), ball, still({1, 0, 0}), 1.0), 0.0);
  EXPECT_EQ(impact(ball, moving({0, 0, 0}, {-1, 0, 0}), ball, still({1, 0, 0}), 1.0), -1.0);
}

// Thrown up from where it touches, a body is back after 2 v / g; thrown from within, when it has fallen to
// the surface again, or turns round at v / g when it never gets free.
TEST(TimeOfImpact, ThrownUpComesBack) {
  const Sphere ball{0.5};
  const Box box{Vec3::Ones()};
  const double v = 3.0, deep = 0.2;
  for (const auto& [ground, motion] :
       {std::pair(Shape(Plane{}), still({0, 0, 0})), std::pair(Shape(Box{{9, 9, 1}}), still({0, 0, -0.5}))})
    for (const Shape& body : {Shape(ball), Shape(box)}) {
      const Vec3 touch(0.1, 0.2, 0.5), within(0.1, 0.2, 0.5 - deep);
      EXPECT_NEAR(impact(body, moving(touch, {1, 0, v}, kGravity), ground, motion, 2.0), 2 * v / kG, 1e-11);
      EXPECT_NEAR(impact(body, moving(within, {1, 0, v}, kGravity), ground, motion, 2.0),
                  (v + std::sqrt(v * v - 2 * kG * deep)) / kG, 1e-11);
      EXPECT_NEAR(impact(body, moving(within, {1, 0, 0.1}, kGravity), ground, motion, 2.0), 0.1 / kG, 1e-3);
      EXPECT_EQ(impact(body, moving(touch, {1, 0, v}, kGravity), ground, motion, 0.6), -1.0);
    }
  EXPECT_NEAR(impact(ball, moving({0, 0, 1}, {0, 0, v}, kGravity), ball, still({0, 0, 0}), 2.0), 2 * v / kG,
              1e-11);
}

// Hard case A55: a rod turning above a floor. Its lower corner is at L sin(wt) + c cos(wt) below its centre.
TEST(TimeOfImpact, SpinningRod) {
  const double half = 1.0, c = 0.01, height = 0.3;
  const Box rod{Vec3(2 * half, 2 * c, 2 * c)};
  const double angle = std::asin(height / std::hypot(half, c)) - std::atan2(c, half);
  for (const double w : {1.0, 50.0, 1e3, 1e4}) {
    const Motion motion = moving({0, 0, height}, {0, 0, 0}, {0, 0, 0}, {0, w, 0});
    EXPECT_NEAR(w * impact(rod, motion, Plane{}, still({0, 0, 0}), 10.0), angle, 1e-11) << w;
    EXPECT_NEAR(w * impact(rod, motion, Box{{9, 9, 1}}, still({0, 0, -0.5}), 10.0), angle, 1e-11) << w;
  }
}

// Turning parallel to the floor, it meets the floor when it has come down, not before.
TEST(TimeOfImpact, SpinningRodComesDown) {
  const Box rod{Vec3(2, 0.02, 0.02)};
  const Motion motion = moving({0, 0, 0.5}, {0, 0, -40}, {0, 0, 0}, {0, 0, 1e4});
  EXPECT_NEAR(impact(rod, motion, Plane{}, still({0, 0, 0}), 1.0 / 60), 0.49 / 40, 1e-13);
  EXPECT_NEAR(impact(rod, motion, Box{{9, 9, 1}}, still({0, 0, -0.5}), 1.0 / 60), 0.49 / 40, 1e-13);
}

// A plane that turns about x with w reaches a ball at (0, y, z) when z cos(wt) - y sin(wt) = R.
TEST(TimeOfImpact, TurningPlane) {
  const double w = 2.0, y = 1.5, z = 1.0, radius = 0.25;
  const double truth = (std::acos(radius / std::hypot(y, z)) - std::atan2(y, z)) / w;
  const Motion plane = moving({0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {w, 0, 0});
  EXPECT_NEAR(impact(Sphere{radius}, still({0.4, y, z}), Plane{}, plane, 1.0), truth, 1e-12);
  EXPECT_EQ(impact(Sphere{radius}, still({0.4, y, z}), Plane{}, plane, 0.99 * truth), -1.0);
}

TEST(TimeOfImpact, CountsFromAnyTime) {
  Motion early = moving({0, 0, 0}, {1, 0, 0}), late = still({5, 0, 0});
  early.t0 = -2.0, late.t0 = 1.0;
  EXPECT_DOUBLE_EQ(impact(Sphere{0.5}, early, Sphere{0.5}, late, 9.0, 1.5), 2.0);
  EXPECT_NEAR(impact(Box{Vec3::Ones()}, early, Box{Vec3::Ones()}, late, 9.0, 1.5), 2.0, 1e-13);
  EXPECT_FALSE(timeOfImpact(Sphere{0.5}, early, Sphere{0.5}, late, 3.0, 2.0));
  EXPECT_FALSE(timeOfImpact(Plane{}, early, Plane{}, late, 0.0, 9.0));
}

// Hard case A49: a cube of 1 mm falls on a floor of 1 km, far from its middle.
TEST(TimeOfImpact, SmallOnHuge) {
  const Motion motion = moving({300.0, -200.0, 0.1}, {1, 2, 0}, kGravity, {3, 2, 1});
  const Box cube{Vec3::Constant(1e-3)};
  const double on_box = impact(cube, motion, Box{{1e3, 1e3, 1}}, still({0, 0, -0.5}), 1.0);
  const double on_plane = impact(cube, motion, Plane{}, still({0, 0, 0}), 1.0);
  EXPECT_NEAR(on_box, on_plane, 1e-12);
  EXPECT_NEAR(gap(cube, motion.at(on_plane), Plane{}, Pose()).distance, 0.0, 1e-15);
}

// Two spheres of which one falls: bisection on the distance, in long double, after a scan for the bracket.
TEST(TimeOfImpact, FallingOnAFixedSphere) {
  const std::uint64_t seed = 61;
  Random random(seed);
  int hits = 0;
  for (int k = 0; k < 3000; ++k) {
    const double r = random.uniform(0.05, 0.6);
    const Vec3 p = 2.0 * random.direction();
    const Motion a = moving(p, random.inCube(3.0) - random.uniform(0.0, 3.0) * p, kGravity),
                 b = still({0, 0, 0});
    const auto apart = [&](long double s) {
      return (a.pose.p_WB.cast<long double>() + s * a.twist.v_WB.cast<long double>() +
              0.5L * s * s * a.a_W.cast<long double>())
                 .norm() -
             2.0L * static_cast<long double>(r);
    };
    long double low = 0.0L, high = -1.0L;
    for (int i = 1; i <= 4000 && high < 0.0L; ++i)
      if (apart(i * 0.00025L) < 0.0L) high = i * 0.00025L, low = high - 0.00025L;
    const std::string where = "seed " + std::to_string(seed) + ", pair " + std::to_string(k);
    const auto found = timeOfImpact(Sphere{r}, a, Sphere{r}, b, 0.0, 1.0);
    if (high < 0.0L) {
      if (found) {  // grazed between two samples
        ASSERT_LE(apart(*found), 1e-12L) << where;
      }
      continue;
    }
    ++hits;
    for (int i = 0; i < 80; ++i) (apart((low + high) / 2) < 0.0L ? high : low) = (low + high) / 2;
    const double slope = static_cast<double>((apart(high + 1e-9L) - apart(high - 1e-9L)) / 2e-9L);
    ASSERT_TRUE(found) << where;
    ASSERT_NEAR(*found, static_cast<double>(high), 1e-13 / std::min(1.0, -slope)) << where;
  }
  EXPECT_GT(hits, 500);
}

// Whatever the shapes and motions: apart before the answer, touching at it, and apart throughout without one.
TEST(TimeOfImpact, IsNeverLate) {
  const std::uint64_t seed = 62;
  Random random(seed);
  int hits = 0, misses = 0;
  for (int k = 0; k < 1500; ++k) {
    const Shape a = random.below(4) == 0 ? Shape(Sphere{0.3}) : Shape(random.box());
    const Shape b = random.below(4) == 0 ? Shape(Sphere{0.3}) : Shape(random.box());
    const double spin = std::pow(10.0, random.uniform(-1, 4));
    Motion motion_a, motion_b;
    motion_a.pose = random.pose(0.1), motion_b.pose = {2.0 * random.direction(), random.attitude()};
    motion_a.twist.w_WB = spin * random.direction(), motion_b.twist.w_WB = spin * random.direction();
    motion_b.twist.v_WB = -random.uniform(0.5, 20.0) * (motion_b.pose.p_WB.normalized() + random.inCube(0.5));
    motion_b.a_W = random.below(2) == 0 ? Vec3(Vec3::Zero()) : kGravity;
    const double to = 0.3;
    const std::string where = "seed " + std::to_string(seed) + ", pair " + std::to_string(k);
    const auto gapAt = [&](double t) { return gap(a, motion_a.at(t), b, motion_b.at(t)).distance; };
    const auto found = timeOfImpact(a, motion_a, b, motion_b, 0.0, to);
    const double last = found.value_or(to);
    for (int i = 0; i < 300; ++i) ASSERT_GT(gapAt(last * i / 300), -1e-12) << where;
    (found ? hits : misses)++;
    if (found) {
      ASSERT_NEAR(gapAt(*found), 0.0, 1e-12) << where;
    }
  }
  EXPECT_GT(hits, 500);
  EXPECT_GT(misses, 100);
}

// Bodies that bounce without end: each impact is found anew from the place of the last. Between two walls a
// ball runs a triangle wave (hard case A58); the walls are at +-1 and its centre turns at +-0.9. Each flight
// has its own clock, as far from the origin of time the clock would count in coarser ticks.
TEST(TimeOfImpact, TenThousandBounces) {
  const Sphere ball{0.1};
  const Motion left = still({-1, 0, 0}, Quat(Eigen::AngleAxisd(EIGEN_PI / 2, Vec3::UnitY())));
  const Motion right = still({1, 0, 0}, Quat(Eigen::AngleAxisd(-EIGEN_PI / 2, Vec3::UnitY())));
  const double speed = 1000.0 / std::sqrt(2.0);
  Motion motion = moving({0, 0, 0}, {speed, 0, 0});
  long double path = 0.0L;
  for (int bounce = 0; bounce <= 10000; ++bounce) {
    const double at_left = timeOfImpact(ball, motion, Plane{}, left, 0.0, 1.0).value_or(9.0);
    const double at_right = timeOfImpact(ball, motion, Plane{}, right, 0.0, 1.0).value_or(9.0);
    ASSERT_EQ(at_left < at_right, bounce % 2 == 1) << bounce;
    const double flight = std::min(at_left, at_right);
    path += flight * static_cast<long double>(speed);
    motion.pose = motion.at(flight);
    motion.twist.v_WB = -motion.twist.v_WB;
  }
  EXPECT_NEAR(static_cast<double>(path - (10000 * 1.8L + 0.9L)), 0.0, 1e-11);
}

}  // namespace
}  // namespace rbs
