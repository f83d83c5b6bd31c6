// SPDX-License-Identifier: BSD-3-Clause
// Times of impact against closed forms and against marches in long double that cannot pass a contact.
#include "narrowphase/time_of_impact.h"

#include "core/narrowphase_oracles.h"
#include "free_top_oracle.h"
#include "narrowphase/collide.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <functional>
#include <string>
#include <vector>

namespace rbs {
namespace {

using oracle::Mat;
using oracle::PlacedBox;
using oracle::Random;
using oracle::Real;
using oracle::Vec;

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

Vec placeAt(const Motion& motion, Real t) {
  const Real s = t - motion.t0;
  return motion.pose.p_WB.cast<Real>() + s * motion.twist.v_WB.cast<Real>() +
         0.5L * s * s * motion.a_W.cast<Real>();
}

Mat orientationAt(const Motion& motion, Real t) {
  const Mat R = Eigen::Quaternion<Real>(motion.pose.q_WB.cast<Real>()).normalized().toRotationMatrix();
  const Vec w = motion.twist.w_WB.cast<Real>();
  if (w.isZero(0.0L)) return R;
  return Eigen::AngleAxis<Real>((t - motion.t0) * w.norm(), w.normalized()).toRotationMatrix() * R;
}

PlacedBox boxAt(const Box& box, const Motion& motion, Real t) {
  PlacedBox placed(box, Pose());
  placed.p = placeAt(motion, t), placed.R = orientationAt(motion, t);
  return placed;
}

// No point of a body of this radius moves faster, up to the time `to`.
Real fastest(const Motion& motion, double radius, double to) {
  return motion.twist.v_WB.norm() + to * motion.a_W.norm() + radius * motion.twist.w_WB.norm();
}

// The first time up to `to` at which a gap that never changes faster than `speed` is closed, or -1: steps of
// gap / speed cannot pass it.
Real firstContact(const std::function<Real(Real)>& gap, Real speed, Real to) {
  Real t = 0.0L;
  while (t <= to) {
    const Real now = gap(t);
    if (now <= 1e-16L) return t;
    t += now / speed;
  }
  return -1.0L;
}

// Holds an answer against the truth. `size` is the smaller length of the pair and `reach` the largest
// coordinate, m. An answer may miss by what it takes to close 1e-12 of the size, and the rounding of the
// coordinates. Where they hardly close, hit or miss is decided by rounding, and an answer only has to touch.
// Says whether there was a hit.
bool holds(const std::optional<double>& found, const std::function<Real(Real)>& gap, Real speed, double to,
           double size, double reach, const std::string& where) {
  constexpr Real kMoment = 1e-9L, kGrazing = 1e-4L;
  const Real truth = firstContact(gap, speed, to);
  const Real allowed = 1e-12L * size + 1e-15L * reach;
  if (truth < 0.0L) {
    if (found) {
      EXPECT_LE(gap(*found), allowed) << where;
    }
    return false;
  }
  const Real closing = (gap(truth - kMoment * size / speed) - gap(truth)) / (kMoment * size / speed);
  if (closing > kGrazing * speed) {
    EXPECT_TRUE(found) << where << ", the truth is " << static_cast<double>(truth);
    if (found) {
      EXPECT_LE(std::abs(*found - truth) * closing, allowed) << where;
    }
  } else if (found) {
    EXPECT_LE(std::abs(gap(*found)), allowed) << where;
  }
  return true;
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

// Rounding makes neither an approach of a ball that slides over a box, nor an escape of one that sinks in.
TEST(TimeOfImpact, SphereThatSlidesAndSphereWithinABox) {
  Random random(69);
  const Sphere ball{0.5};
  const Box box{{4, 4, 2}};
  for (int k = 0; k < 300; ++k) {
    const Quat q = random.orientation();
    const auto placed = [&](const Vec3& p, const Vec3& v, const Vec3& a) {
      Motion motion = still(q * p);
      motion.twist.v_WB = q * v, motion.a_W = q * a;
      return motion;
    };
    const Motion ground = still({0, 0, 0}, q);
    const Vec3 along = random.uniform(0.1, 3.0) * Vec3(random.direction().head<2>().norm(), 0.3, 0.0);
    EXPECT_EQ(impact(ball, placed({-0.3, 0.2, 1.5}, along, Vec3::Zero()), box, ground, 5.0), -1.0) << k;
    EXPECT_EQ(impact(ball, placed({-0.3, 0.2, 1.5}, along, {0, 0, -1}), box, ground, 5.0), 0.0) << k;
    // Its centre within the box: deeper at once, or out with 6 m/s from 0.9 m below where it is free.
    EXPECT_EQ(impact(ball, placed({0.1, 0.2, 0.6}, {0, 0, -1}, Vec3::Zero()), box, ground, 5.0), 0.0) << k;
    EXPECT_NEAR(impact(ball, placed({0.1, 0.2, 0.6}, {0, 0, 6}, {0, 0, -kG}), box, ground, 5.0),
                (6.0 + std::sqrt(36.0 - 2.0 * kG * 0.9)) / kG, 1e-12)
        << k;
  }
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

// A rod that turns about the vertical with w meets a peg at the distance D when D sin(angle left) is half its
// width and the radius of the peg.
TEST(TimeOfImpact, SpinningRodMeetsPeg) {
  const double c = 0.02, radius = 0.05, D = 0.8, ahead = 2.5;
  const Box rod{Vec3(2.0, 2.0 * c, 2.0 * c)};
  const Capsule round{c, 1.0 - c};
  const double angle = ahead - std::asin((c + radius) / D);
  const Vec3 place(D * std::cos(ahead), D * std::sin(ahead), 0.0);
  const Quat lying(Eigen::AngleAxisd(EIGEN_PI / 2, Vec3::UnitY()));
  for (const Shape& peg : {Shape(Sphere{radius}), Shape(Capsule{radius, 0.3}), Shape(Cylinder{radius, 0.3})})
    for (const double w : {50.0, 1e3, 1e4}) {
      const Motion turning = moving({0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, w});
      Motion lying_down = turning;
      lying_down.pose.q_WB = lying;
      EXPECT_NEAR(w * impact(rod, turning, peg, still(place), 1.0), angle, 1e-11) << shapeName(peg) << w;
      EXPECT_NEAR(w * impact(round, lying_down, peg, still(place), 1.0), angle, 1e-11) << shapeName(peg) << w;
    }
}

// What passes at 1 + 1e-10 of the distance at which it would touch misses; at 1 - 1e-10 it hits.
TEST(TimeOfImpact, GrazingHitsAndMisses) {
  constexpr double kMiss = 1e-10;
  Random random(67);
  int wrong = 0;
  for (int k = 0; k < 2000; ++k) {
    for (const double sign : {1.0, -1.0}) {
      const auto expect = [&](const Shape& a, const Motion& motion_a, const Shape& b, const Motion& motion_b,
                              const char* what) {
        const auto found = timeOfImpact(a, motion_a, b, motion_b, 0.0, 2.0);
        EXPECT_EQ(found.has_value(), sign < 0.0) << what << " " << k;
        wrong += found.has_value() != (sign < 0.0);
      };
      const double radius = random.uniform(0.05, 1.0), away = radius * (1.0 + sign * kMiss);
      const Vec3 half(random.uniform(0.1, 1.0), random.uniform(0.1, 1.0), random.uniform(0.1, 1.0));
      const Quat q = random.orientation();
      // A path that is nearest to `feature` in the direction n after a second; it bends across n.
      const auto past = [&](const Vec3& feature, const Vec3& n, const Vec3& way) {
        const Vec3 along = way - way.dot(n) * n;
        const double bend = random.below(2) == 0 ? 0.0 : random.uniform(-1.0, 1.0);
        Motion motion = still(q * (feature + away * n + (0.5 * bend - 1.0) * along));
        motion.twist.v_WB = q * ((1.0 - bend) * along);
        motion.a_W = q * (bend * along);
        return motion;
      };
      const Vec3 corner = random.direction().cwiseAbs().cwiseMax(0.05).normalized();
      const Vec3 way = random.uniform(0.5, 2.0) * random.direction();
      expect(Sphere{0.25 * radius}, still({0, 0, 0}), Sphere{0.75 * radius}, past({0, 0, 0}, corner, way),
             "sphere past sphere");
      expect(Sphere{radius}, past(half, corner, way), Box{2.0 * half}, still({0, 0, 0}, q),
             "sphere past corner");
      const Vec3 edge = Vec3(corner.x(), corner.y(), 0.0).normalized();
      const Vec3 steep = Vec3(way.x(), way.y(), 0.1 * half.z() * way.z());
      expect(Sphere{radius}, past({half.x(), half.y(), 0.0}, edge, steep), Box{2.0 * half},
             still({0, 0, 0}, q), "sphere past edge");
      const Vec3 side(1.0, 0.0, 0.0);
      expect(Capsule{0.25 * radius, half.z()}, still({0, 0, 0}, q), Sphere{0.75 * radius},
             past({0, 0, 0}, side, steep), "sphere past capsule");
    }
  }
  EXPECT_EQ(wrong, 0);

  // A rod as high over the floor, or as far from a wall, as its corner is from its centre.
  for (const double sign : {1.0, -1.0})
    for (const double w : {1.0, 50.0, 1e4}) {
      const Box rod{Vec3(2.0, 0.02, 0.02)};
      const double height = std::hypot(1.0, 0.01) * (1.0 + sign * kMiss);
      const Motion turning = moving({0, 0, height}, {0, 0, 0}, {0, 0, 0}, {0, w, 0});
      const double to = 3.0 / w;
      for (const auto& [floor, motion] : {std::pair(Shape(Plane{}), still({0, 0, 0})),
                                          std::pair(Shape(Box{{9, 9, 1}}), still({0, 0, -0.5}))}) {
        EXPECT_EQ(timeOfImpact(rod, turning, floor, motion, 0.0, to).has_value(), sign < 0.0) << w;
        EXPECT_EQ(timeOfImpact(floor, motion, rod, turning, 0.0, to).has_value(), sign < 0.0) << w;
      }
    }
}

// Bodies of every shape at 1000 m/s against a sheet of 1 mm, spinning as fast as does not move their front.
TEST(TimeOfImpact, BulletsOfAllShapesMeetThinSheet) {
  const Quat forward(Eigen::AngleAxisd(EIGEN_PI / 2, Vec3::UnitY()));
  const Box sheet{{0.001, 2.0, 2.0}};
  for (const auto& [shape, front] :
       {std::pair(Shape(Sphere{0.01}), 0.01), std::pair(Shape(Box{{0.02, 0.02, 0.06}}), 0.03),
        std::pair(Shape(Capsule{0.01, 0.02}), 0.03), std::pair(Shape(Cylinder{0.01, 0.03}), 0.03),
        std::pair(Shape(Cone{0.01, 0.04}), 0.03)})
    for (const double w : {0.0, 1e3}) {
      Motion motion = moving({-10.0, 0.1, 0.2}, {1e3, 0, 0}, kGravity, {w, 0, 0});
      motion.pose.q_WB = forward;
      const double truth = (10.0 - front - 0.0005) / 1e3;
      EXPECT_NEAR(impact(shape, motion, sheet, still({0, 0, 0}), 1.0 / 60), truth, 1e-14) << shapeName(shape);
    }
}

// Lengths and speeds in other units give the same times: to the last bit where the units are powers of two.
// Far from the origin, only the rounding of the coordinates is added.
TEST(TimeOfImpact, DoesNotDependOnUnitsOrPlace) {
  const std::uint64_t seed = 68;
  Random random(seed);
  for (int k = 0; k < 500; ++k) {
    const Box a = random.box(), b = random.box();
    Motion motion_a = still({0, 0, 0}, random.orientation()),
           motion_b = still(2.0 * random.direction(), random.orientation());
    motion_b.twist.v_WB = -5.0 * motion_b.pose.p_WB + random.inCube(1.0);
    motion_b.a_W = kGravity;
    const auto answers = [&](double scale, const Vec3& offset) {
      const auto change = [&](Motion motion) {
        motion.pose.p_WB = scale * motion.pose.p_WB + offset;
        motion.twist.v_WB *= scale, motion.a_W *= scale;
        return motion;
      };
      Motion turning_a = change(motion_a), turning_b = change(motion_b);
      turning_a.twist.w_WB = {3, 20, 1}, turning_b.twist.w_WB = {-10, 5, 8};
      return std::array<double, 3>{
          timeOfImpact(Box{scale * a.size}, turning_a, Box{scale * b.size}, turning_b, 0.0, 1.0).value_or(-1),
          timeOfImpact(Box{scale * a.size}, change(motion_a), Sphere{scale * 0.2}, turning_b, 0.0, 1.0)
              .value_or(-1),
          timeOfImpact(Sphere{scale * 0.2}, change(motion_a), Sphere{scale * 0.2}, turning_b, 0.0, 1.0)
              .value_or(-1)};
    };
    const auto here = answers(1.0, Vec3::Zero());
    const std::string where = "seed " + std::to_string(seed) + ", pair " + std::to_string(k);
    EXPECT_EQ(answers(1024.0, Vec3::Zero()), here) << where;
    EXPECT_EQ(answers(1.0 / 1024.0, Vec3::Zero()), here) << where;
    const auto in_other_units = answers(39.37, Vec3::Zero()), far = answers(1.0, {3e3, -5e3, 1e3});
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(in_other_units[i], here[i], 1e-13) << where;
      EXPECT_NEAR(far[i], here[i], 1e-11) << where;
    }
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

Inertia inertiaOf(const Shape& shape) {
  Inertia inertia;
  inertia.inv_mass = 1.0;
  inertia.moments = momentsPerMass(shape);
  inertia.inv_moments = inertia.moments.cwiseInverse();
  inertia.isotropic = false;
  inertia.gyroscopic = true;
  return inertia;
}

// A box that tumbles freely, its angular velocity changing all the time, above a floor. Its orientation is
// that of Euler's equations, in long double.
TEST(TimeOfImpact, TumblingBoxMeetsTheFloor) {
  Random random(70);
  int hits = 0;
  for (int k = 0; k < 60; ++k) {
    const Box box{{random.uniform(0.05, 0.3), random.uniform(0.3, 0.6), random.uniform(0.6, 1.0)}};
    const Inertia inertia = inertiaOf(box);
    Motion motion = moving({0, 0, 1.0}, random.inCube(1.0), kGravity, random.inCube(8.0));
    motion.pose.q_WB = random.orientation();
    motion.top = &inertia;
    const Vec3 l_B = inertia.moments.cwiseProduct(motion.pose.q_WB.conjugate() * motion.twist.w_WB);
    const auto lowest = [&](Real t) -> Real {
      const rbs::oracle::TopState top = rbs::oracle::integrated(l_B, inertia.moments, static_cast<double>(t));
      const Mat R = Eigen::Quaternion<Real>(motion.pose.q_WB.cast<Real>()).normalized().toRotationMatrix() *
                    Eigen::Quaternion<Real>(top[3], top[0], top[1], top[2]).normalized().toRotationMatrix();
      return placeAt(motion, t).z() - R.row(2).cwiseAbs().dot((0.5 * box.size).cast<Real>());
    };
    const double speed =
        fastest(motion, 0.0, 1.0) + 0.5 * box.size.norm() * rbs::oracle::fastest(l_B, inertia.moments);
    const std::string where = "seed 70, box " + std::to_string(k);
    hits += holds(timeOfImpact(box, motion, Plane{}, still({0, 0, 0}), 0.0, 0.6), lowest, speed, 0.6,
                  box.size.minCoeff(), 1.0, where);
  }
  EXPECT_GT(hits, 40);
}

// Of tops of all shapes: where they touch the gap is closed, and at no time before is it.
TEST(TimeOfImpact, TumblingBodiesMeetEachOther) {
  Random random(71);
  const std::vector<Shape> shapes{Box{{0.1, 0.3, 0.5}}, Capsule{0.1, 0.2}, Cylinder{0.15, 0.2},
                                  Cone{0.2, 0.4}};
  int hits = 0;
  for (int k = 0; k < 200; ++k) {
    const Shape &a = shapes[random.below(4)], &b = shapes[random.below(4)];
    const Inertia inertia_a = inertiaOf(a), inertia_b = inertiaOf(b);
    Motion motion_a = moving({0, 0, 0}, random.inCube(0.3), kGravity, random.inCube(20.0));
    Motion motion_b = moving(1.2 * random.direction(), Vec3::Zero(), Vec3::Zero(), random.inCube(20.0));
    motion_b.twist.v_WB = -4.0 * motion_b.pose.p_WB + random.inCube(0.5);
    motion_a.pose.q_WB = random.orientation(), motion_b.pose.q_WB = random.orientation();
    motion_a.top = &inertia_a, motion_b.top = &inertia_b;
    const double found = impact(a, motion_a, b, motion_b, 0.5);
    hits += found >= 0.0;
    const double until = found < 0.0 ? 0.5 : found;
    for (int i = 0; i < 200; ++i) {
      const double t = until * i / 200.0;
      EXPECT_GT(gap(a, motion_a.at(t), b, motion_b.at(t)).distance, -1e-12) << "pair " << k << ", t " << t;
    }
    if (found >= 0.0) {
      EXPECT_NEAR(gap(a, motion_a.at(found), b, motion_b.at(found)).distance, 0.0, 1e-12) << "pair " << k;
    }
  }
  EXPECT_GT(hits, 100);
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

// A sphere thrown at the faces, edges and corners of a box that does not turn, with and without acceleration.
TEST(TimeOfImpact, SphereAndBoxThatDoesNotTurn) {
  const std::uint64_t seed = 63;
  Random random(seed);
  int hits = 0;
  const int pairs = 100000;
  for (int k = 0; k < pairs && !testing::Test::HasFailure(); ++k) {
    const Box box = random.box();
    const Sphere ball{std::pow(10.0, random.uniform(-2.0, 0.0))};
    Motion of_box = still(random.inCube(0.5), random.orientation()), of_ball;
    const double speed = std::pow(10.0, random.uniform(0.0, 3.0)), way = random.uniform(1.0, 5.0),
                 to = way / speed;
    for (Motion* motion : {&of_box, &of_ball}) {
      if (random.below(2) == 0) motion->twist.v_WB = random.uniform(0.0, speed) * random.direction();
      if (random.below(2) == 0) motion->a_W = 10.0 * random.uniform(0.0, speed) * random.direction() / to;
    }
    // The centre is to come by this point of the box, moved out a little: on a face, an edge or a corner.
    Vec3 target = 0.5 * box.size.cwiseProduct(random.inCube(1.0));
    for (const int i : {0, 1, 2})
      if (random.below(2) == 0) target[i] = std::copysign(0.5 * box.size[i], target[i]);
    const double meet = random.uniform(0.2, 1.0) * to;
    const Vec3 there = of_box.at(meet).p_WB + of_box.pose.q_WB * target +
                       random.uniform(0.0, 1.1) * ball.radius * random.direction();
    const Vec3 from = there + (way + 2.0) * random.direction();
    of_ball.pose.p_WB = from;
    of_ball.twist.v_WB = (there - from) / meet - 0.5 * meet * of_ball.a_W;

    const auto gap = [&](Real t) {
      return boxAt(box, of_box, t).distanceTo(placeAt(of_ball, t)) - ball.radius;
    };
    const Real rush =
        (of_ball.twist.v_WB - of_box.twist.v_WB).norm() + to * (of_ball.a_W - of_box.a_W).norm();
    const std::string where = "seed " + std::to_string(seed) + ", pair " + std::to_string(k);
    if (gap(0.0L) <= 0.0L) continue;
    const auto found = timeOfImpact(ball, of_ball, box, of_box, 0.0, to);
    const double size = std::min(2.0 * ball.radius, box.size.minCoeff());
    hits += holds(found, gap, rush, to, size, from.norm() + rush * to, where);
  }
  EXPECT_GT(hits, pairs / 2);
}

// Boxes that tumble at each other: slabs, needles and cubes, a spin of up to 1000 rad/s each.
TEST(TimeOfImpact, BoxesThatTumble) {
  const std::uint64_t seed = 64;
  Random random(seed);
  int hits = 0;
  const int pairs = 20000;
  for (int k = 0; k < pairs && !testing::Test::HasFailure(); ++k) {
    const Box a = random.box(), b = random.box();
    Motion of_a, of_b;
    of_a.pose = random.pose(0.1), of_b.pose = {2.0 * random.direction(), random.orientation()};
    of_a.twist.w_WB = std::pow(10.0, random.uniform(-1.0, 3.0)) * random.direction();
    of_b.twist.w_WB = std::pow(10.0, random.uniform(-1.0, 3.0)) * random.direction();
    of_b.twist.v_WB = -random.uniform(20.0, 300.0) * (of_b.pose.p_WB.normalized() + random.inCube(0.3));
    if (random.below(2) == 0) of_b.a_W = 100.0 * kGravity;
    const double to = 3.0 / of_b.twist.v_WB.norm();
    const auto gap = [&](Real t) { return oracle::farthestSeparation(boxAt(a, of_a, t), boxAt(b, of_b, t)); };
    if (gap(0.0L) <= 0.0L) continue;
    const Real speed = fastest(of_a, boundingRadius(a), to) + fastest(of_b, boundingRadius(b), to);
    const std::string where = "seed " + std::to_string(seed) + ", pair " + std::to_string(k);
    const auto found = timeOfImpact(a, of_a, b, of_b, 0.0, to);
    // Rounding leaves 1e-16 of every radian that they turn.
    const double turned = to * (of_a.twist.w_WB.norm() + of_b.twist.w_WB.norm());
    hits += holds(found, gap, speed, to, std::min(a.size.minCoeff(), b.size.minCoeff()), 4.0 + turned, where);
  }
  EXPECT_GT(hits, pairs / 3);
}

// Capsules, thick and thin, that tumble at each other: the distance of two segments.
TEST(TimeOfImpact, CapsulesThatTumble) {
  const std::uint64_t seed = 65;
  Random random(seed);
  int hits = 0;
  const int pairs = 50000;
  for (int k = 0; k < pairs && !testing::Test::HasFailure(); ++k) {
    const Capsule a{std::pow(10.0, random.uniform(-2.0, -0.5)), random.uniform(0.0, 0.5)},
        b{std::pow(10.0, random.uniform(-2.0, -0.5)), random.uniform(0.0, 0.5)};
    Motion of_a, of_b;
    of_a.pose = random.pose(0.1), of_b.pose = {2.0 * random.direction(), random.orientation()};
    of_a.twist.w_WB = std::pow(10.0, random.uniform(-1.0, 3.0)) * random.direction();
    of_b.twist.w_WB = std::pow(10.0, random.uniform(-1.0, 3.0)) * random.direction();
    of_b.twist.v_WB = -random.uniform(20.0, 300.0) * (of_b.pose.p_WB.normalized() + random.inCube(0.3));
    if (random.below(2) == 0) of_b.a_W = 100.0 * kGravity;
    const double to = 3.0 / of_b.twist.v_WB.norm();
    const auto gap = [&](Real t) {
      const Vec u = 2.0L * a.half_length * orientationAt(of_a, t).col(2),
                v = 2.0L * b.half_length * orientationAt(of_b, t).col(2);
      return oracle::segmentDistance(placeAt(of_a, t) - 0.5L * u, u, placeAt(of_b, t) - 0.5L * v, v) -
             Real(a.radius) - Real(b.radius);
    };
    const Real speed = fastest(of_a, boundingRadius(a), to) + fastest(of_b, boundingRadius(b), to);
    const std::string where = "seed " + std::to_string(seed) + ", pair " + std::to_string(k);
    const auto found = timeOfImpact(a, of_a, b, of_b, 0.0, to);
    const double turned = to * (of_a.twist.w_WB.norm() + of_b.twist.w_WB.norm());
    hits += holds(found, gap, speed, to, 2.0 * std::min(a.radius, b.radius), 4.0 + turned, where);
  }
  EXPECT_GT(hits, pairs / 4);
}

Shape randomShape(Random& random) {
  const auto length = [&] { return std::pow(10.0, random.uniform(-1.5, -0.2)); };
  switch (random.below(6)) {
    case 0:
      return Sphere{length()};
    case 1:
      return random.box();
    case 2:
      return Capsule{length(), length()};
    case 3:
      return Cylinder{length(), length()};
    case 4:
      return Cone{length(), length()};
    default:
      break;
  }
  const Vec3 half(length(), length(), length());
  std::vector<Vec3> points;
  for (int k = 0; k < 20; ++k) points.push_back(half.cwiseProduct(random.direction()));
  return makeHull(points, "hull").hull;
}

// Whatever the shapes and motions: apart before the answer, touching at it, and apart throughout without one.
TEST(TimeOfImpact, IsNeverLate) {
  const std::uint64_t seed = 62;
  Random random(seed);
  int hits = 0, misses = 0;
  for (int k = 0; k < 3000; ++k) {
    const Shape a = randomShape(random), b = randomShape(random);
    const double spin = std::pow(10.0, random.uniform(-1, 4));
    Motion motion_a, motion_b;
    motion_a.pose = random.pose(0.1), motion_b.pose = {2.0 * random.direction(), random.orientation()};
    motion_a.twist.w_WB = spin * random.direction(), motion_b.twist.w_WB = spin * random.direction();
    motion_b.twist.v_WB = -random.uniform(0.5, 20.0) * (motion_b.pose.p_WB.normalized() + random.inCube(0.5));
    motion_b.a_W = random.below(2) == 0 ? Vec3(Vec3::Zero()) : kGravity;
    const double to = 0.3;
    const std::string where = "seed " + std::to_string(seed) + ", pair " + std::to_string(k) + ", " +
                              shapeName(a) + " and " + shapeName(b);
    const auto gapAt = [&](double t) { return gap(a, motion_a.at(t), b, motion_b.at(t)).distance; };
    if (gapAt(0.0) <= 0.0) continue;
    const auto found = timeOfImpact(a, motion_a, b, motion_b, 0.0, to);
    const double last = found.value_or(to);
    for (int i = 0; i < 300; ++i) ASSERT_GT(gapAt(last * i / 300), -1e-12) << where;
    (found ? hits : misses)++;
    if (found) {
      ASSERT_NEAR(gapAt(*found), 0.0, 1e-12) << where;
    }
  }
  EXPECT_GT(hits, 600);
  EXPECT_GT(misses, 600);
}

// How often the nearest points are searched for. Measured: half of the hits take 8 at most, all take 39 at
// most, and pairs that touch and part take 5 at most.
TEST(TimeOfImpact, TakesFewLooks) {
  Random random(66);
  std::vector<int> looks;
  for (int k = 0; k < 5000; ++k) {
    const Shape a = randomShape(random), b = randomShape(random);
    const double spin = std::pow(10.0, random.uniform(0.0, 2.0));
    Motion motion_a = still(Vec3::Zero(), random.orientation()),
           motion_b = still(2.0 * random.direction(), random.orientation());
    motion_a.twist.w_WB = spin * random.direction(), motion_b.twist.w_WB = spin * random.direction();
    motion_b.twist.v_WB = -random.uniform(1.0, 20.0) * (motion_b.pose.p_WB.normalized() + random.inCube(0.3));
    int count = 0;
    if (timeOfImpact(a, motion_a, b, motion_b, 0.0, 0.3, &count) && count > 0) looks.push_back(count);
  }
  ASSERT_GT(looks.size(), 1000u);
  std::sort(looks.begin(), looks.end());
  EXPECT_LE(looks[looks.size() / 2], 10);
  EXPECT_LE(looks[looks.size() * 9 / 10], 14);
  EXPECT_LE(looks.back(), 60);

  // A box whose lowest corner leaves the floor at no speed, a low one or a high one.
  const Box box{{1.0, 0.6, 0.3}}, floor{{100.0, 100.0, 1.0}};
  for (int k = 0; k < 500; ++k) {
    const Quat q = random.orientation();
    const Mat3 R = q.toRotationMatrix();
    const Vec3 w = std::pow(10.0, random.uniform(-2.0, 2.0)) * random.direction();
    Vec3 corner;
    for (int i = 0; i < 3; ++i) corner[i] = -std::copysign(0.5 * box.size[i], R(2, i));
    const double up = k % 3 == 0 ? 0.0 : std::pow(10.0, random.uniform(-9.0, 0.0));
    Motion motion = still({0.0, 0.0, 0.5 - (R * corner).z()}, q);
    motion.twist = {Vec3(0.0, 0.0, up) - w.cross(R * corner), w};
    int count = 0;
    timeOfImpact(box, motion, floor, still({0, 0, 0}), 0.0, 1.0 / 60, &count);
    EXPECT_LE(count, 10) << k;
  }
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

// A wheel looks the same as it turns about its axis, and a body that spins in its place keeps to a ball.
TEST(TimeOfImpact, SpinThatMovesNoSurfaceCostsNothing) {
  const Motion floor = still({0, 0, 0});
  for (const double w : {0.0, 1e4, 1e8}) {
    for (const Shape& wheel : {Shape(Capsule{0.1, 0.4}), Shape(Cylinder{0.5, 0.1}), Shape(Cone{0.4, 0.6})}) {
      Motion motion = moving({0, 0, 2}, {1, 0, -5}, kGravity);
      motion.pose.q_WB = Quat(Eigen::AngleAxisd(0.7, Vec3::UnitX()));
      motion.twist.w_WB = motion.pose.q_WB * Vec3(0.0, 0.0, w);
      int looks = 0;
      EXPECT_TRUE(timeOfImpact(wheel, motion, Box{{9, 9, 1}}, floor, 0.0, 1.0, &looks))
          << shapeName(wheel) << w;
      EXPECT_LE(looks, 8) << shapeName(wheel) << w;
    }
    const Motion tumbling = moving({0, 0, 2}, {1, 0, -5}, kGravity, {w, w, w});
    for (const Shape& body :
         {Shape(Box{{1, 0.2, 0.3}}), Shape(Capsule{0.1, 0.4}), Shape(Cylinder{0.3, 0.4})}) {
      int looks = 0;
      EXPECT_FALSE(timeOfImpact(body, tumbling, Box{{9, 9, 1}}, floor, 0.0, 0.12, &looks)) << shapeName(body);
      EXPECT_LE(looks, 3) << shapeName(body) << w;
    }
  }
}

// A ball in a closed room of boxes, on a path that fills it (hard case A58). Its place is known by unfolding
// the room: along each axis a triangle wave.
TEST(TimeOfImpact, TenThousandBouncesInAClosedRoom) {
  const Sphere ball{0.1};
  const Box slab{{2.4, 2.4, 0.2}};
  std::vector<Motion> walls;
  for (const Vec3& axis : {Vec3(Vec3::UnitX()), Vec3(Vec3::UnitY()), Vec3(Vec3::UnitZ())})
    for (const double side : {-1.0, 1.0})
      walls.push_back(still(1.1 * side * axis, Quat::FromTwoVectors(Vec3::UnitZ(), axis)));
  const Vec3 v0 = 1e3 * Vec3(1.0, std::sqrt(2.0), std::sqrt(5.0)).normalized();
  Motion motion = moving({0, 0, 0}, v0);
  Real passed = 0.0L;
  for (int bounce = 0; bounce < 10000; ++bounce) {
    double flight = 1.0;
    int met = -1;
    for (int k = 0; k < 6; ++k)
      if (const auto t = timeOfImpact(ball, motion, slab, walls[k], 0.0, flight); t && *t < flight)
        flight = *t, met = k;
    ASSERT_GE(met, 0) << bounce;
    passed += flight;
    motion.pose = motion.at(flight);
    motion.twist.v_WB[met / 2] *= -1.0;
  }
  for (int k = 0; k < 3; ++k) {
    Real place = std::fmod(Real(v0[k]) * passed + 0.9L, 3.6L);
    if (place > 1.8L) place = 3.6L - place;
    EXPECT_NEAR(motion.pose.p_WB[k], static_cast<double>(place - 0.9L), 1e-10) << k;
  }
}

}  // namespace
}  // namespace rbs
