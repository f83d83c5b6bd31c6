// SPDX-License-Identifier: BSD-3-Clause
// The law of impact against what it must keep, whatever meets and however.
#include "solver/impact_law.h"

#include <gtest/gtest.h>

#include <random>

using namespace rbs;

namespace {

class Bodies2 {
 public:
  explicit Bodies2(unsigned seed) : random_(seed) {
    for (ImpactSide* side : {&a, &b}) {
      side->p_WB = anyVector();
      side->twist = {anyVector(), anyVector()};
      side->inv_mass = std::exp(normal_(random_));
      const Mat3 R =
          Quat(Eigen::Quaterniond(normal_(random_), normal_(random_), normal_(random_), normal_(random_))
                   .normalized())
              .toRotationMatrix();
      const Vec3 size(std::exp(normal_(random_)), std::exp(normal_(random_)), std::exp(normal_(random_)));
      const Vec3 squares = size.cwiseProduct(size);
      const Vec3 moments = (squares.sum() * Vec3::Ones() - squares) / (12.0 * side->inv_mass);
      side->inv_inertia_W = R * moments.cwiseInverse().asDiagonal() * R.transpose();
    }
  }
  Vec3 anyVector() { return {normal_(random_), normal_(random_), normal_(random_)}; }

  double energy() const {
    double sum = 0.0;
    for (const ImpactSide* side : {&a, &b})
      sum += 0.5 * side->twist.v_WB.squaredNorm() / side->inv_mass +
             0.5 * side->twist.w_WB.dot(side->inv_inertia_W.inverse() * side->twist.w_WB);
    return sum;
  }
  Vec3 momentum() const { return a.twist.v_WB / a.inv_mass + b.twist.v_WB / b.inv_mass; }
  Vec3 angularMomentum() const {
    Vec3 sum = Vec3::Zero();
    for (const ImpactSide* side : {&a, &b})
      sum += side->p_WB.cross(side->twist.v_WB) / side->inv_mass +
             side->inv_inertia_W.inverse() * side->twist.w_WB;
    return sum;
  }

  ImpactSide a, b;

 private:
  std::mt19937 random_;
  std::normal_distribution<double> normal_;
};

Manifold pointAt(const Vec3& p_W, const Vec3& n_W) {
  Manifold manifold;
  manifold.n_W = n_W;
  manifold.size = 1;
  manifold.points[0].p_W = p_W;
  return manifold;
}

TEST(ImpactLaw, KeepsMomentumGainsNoEnergyAndEndsTheApproach) {
  int impacts = 0, full = 0;
  for (unsigned seed = 1; seed <= 5000; ++seed) {
    Bodies2 pair(seed);
    const Manifold manifold = pointAt(pair.anyVector(), pair.anyVector().normalized());
    const double e = (seed % 5) / 4.0, mu = (seed % 3) * 0.4;
    const double approach = closingSpeed(pair.a, pair.b, manifold);
    if (approach <= 0.0) continue;
    ++impacts;
    const double energy = pair.energy();
    const Vec3 momentum = pair.momentum(), angular = pair.angularMomentum();
    ImpactLaw law{mu, e};
    if (seed % 7 < 3)
      law.radius = 0.05 * (1 + seed % 4), law.roll = 0.1 * (seed % 7), law.spin = 0.3 * (seed % 2);
    collideBodies(pair.a, pair.b, manifold, law);
    EXPECT_LE(pair.energy(), energy * (1.0 + 1e-11)) << seed;
    EXPECT_LE((pair.momentum() - momentum).norm(), 1e-12 * (1.0 + momentum.norm())) << seed;
    EXPECT_LE((pair.angularMomentum() - angular).norm(), 1e-11 * (1.0 + angular.norm())) << seed;
    const Vec3& p = manifold.points[0].p_W;
    const double leaving = manifold.n_W.dot(pair.b.twist.v_WB + pair.b.twist.w_WB.cross(p - pair.b.p_WB) -
                                            pair.a.twist.v_WB - pair.a.twist.w_WB.cross(p - pair.a.p_WB));
    EXPECT_GE(leaving, -1e-11 * approach) << seed;
    EXPECT_LE(leaving, e * approach * (1.0 + 1e-11) + 1e-11 * approach) << seed;
    full += std::abs(leaving - e * approach) <= 1e-10 * approach;
    if (mu == 0.0 && law.radius == 0.0) {
      EXPECT_NEAR(leaving, e * approach, 1e-11 * approach) << seed;
    }
  }
  EXPECT_GT(impacts, 2000);
  // The rebound is lowered where it would create energy, and only there.
  EXPECT_GT(full, impacts * 9 / 10);
  EXPECT_LT(full, impacts);
}

// A body meets the face of one that nothing stops and that moves: what happens is what happens as seen from that one. Four points
// at once, with friction, often take the solve of all together.
TEST(ImpactLaw, OnAFaceThatMovesIsThatOnOneAtRestInItsFrame) {
  // Where four points slide, Coulomb's law met to 1e-13 leaves some velocities to 1e-5 (three of a thousand): 1.2e-5 measured.
  constexpr double kNear = 1e-4;
  int impacts = 0;
  for (unsigned seed = 1; seed <= 1000; ++seed)
    for (const bool of_a : {true, false}) {
      Bodies2 still(seed);
      ImpactSide& face = of_a ? still.a : still.b;
      face.inv_mass = 0.0, face.inv_inertia_W.setZero();
      face.twist = {};
      const Vec3 n_W = still.anyVector().normalized(), t_W = n_W.unitOrthogonal(), p_W = still.anyVector(),
                 v_W = still.anyVector();
      Manifold manifold = pointAt(p_W, n_W);
      for (const Vec3& corner :
           {Vec3(p_W + t_W), Vec3(p_W + n_W.cross(t_W)), Vec3(p_W + t_W + n_W.cross(t_W))})
        manifold.points[manifold.size++].p_W = corner;
      if (closingSpeed(still.a, still.b, manifold) <= 0.0) continue;
      ++impacts;
      Bodies2 moving = still;
      moving.a.twist.v_WB += v_W, moving.b.twist.v_WB += v_W;
      // With both, the search for a restitution that gains no energy may end on either side of a jump.
      const double mu = (seed % 3) * 0.4;
      const ImpactLaw law{mu, mu > 0.0 ? 0.0 : (seed % 5) / 4.0};
      collideBodies(still.a, still.b, manifold, law);
      collideBodies(moving.a, moving.b, manifold, law);
      const Twist &seen = of_a ? still.b.twist : still.a.twist,
                  &found = of_a ? moving.b.twist : moving.a.twist;
      EXPECT_LE((found.v_WB - v_W - seen.v_WB).norm(), kNear * (1.0 + seen.v_WB.norm()))
          << seed << ' ' << of_a;
      EXPECT_LE((found.w_WB - seen.w_WB).norm(), kNear * (1.0 + seen.w_WB.norm())) << seed << ' ' << of_a;
    }
  EXPECT_GT(impacts, 1000);
}

// What lies far behind a plane meets it at a point far along the normal. What that point feels along the normal is then
// the difference of large numbers.
TEST(ImpactLaw, EndsAtPointsFarAlongTheNormal) {
  for (unsigned seed = 1; seed <= 300; ++seed)
    for (const double far : {1e2, 1e4, 1e6, 1e8, 1e9}) {
      Bodies2 pair(seed);
      pair.a.inv_mass = 0.0, pair.a.inv_inertia_W.setZero();
      pair.a.twist = {};
      const Vec3 n_W = pair.anyVector().normalized();
      const Manifold manifold = pointAt(pair.b.p_WB + far * n_W, n_W);
      const ImpactSide before = pair.b;
      collideBodies(pair.a, pair.b, manifold, {(seed % 3) * 0.4, (seed % 5) / 4.0});
      const auto energy = [](const ImpactSide& side) {
        return 0.5 * side.twist.v_WB.squaredNorm() / side.inv_mass +
               0.5 * side.twist.w_WB.dot(side.inv_inertia_W.inverse() * side.twist.w_WB);
      };
      EXPECT_LE(energy(pair.b), energy(before) * (1.0 + 1e-6)) << seed << ", " << far << " m";
      EXPECT_GE(n_W.dot(pair.b.twist.v_WB), std::min(n_W.dot(before.twist.v_WB), 0.0) - 1e-6)
          << seed << ", " << far << " m";
    }
}

// A ball that spins and rolls lands on a floor. The normal impulse is m (1 + e) v. Torsional resistance takes up to s R of it
// from the spin about the normal. Rolling resistance takes up to c R of it from the spin across, and friction that stops
// the slip adds: with J the friction impulse, L that of rolling, i = 2/5 m R²,
//   v' = v_x - J/m = R w',   i w' = i w_y + R J - L.
TEST(ImpactLaw, TakesTurningAwayUpToItsShareOfTheImpulse) {
  const double m = 2.0, R = 0.1, inertia = 0.4 * m * R * R, fall = 3.0;
  for (const double e : {0.0, 0.5, 1.0})
    for (const double s : {0.0, 0.02, 10.0})
      for (const double c : {0.0, 0.02, 10.0}) {
        ImpactSide floor, ball;
        floor.p_WB.setZero(), floor.inv_mass = 0.0, floor.inv_inertia_W.setZero();
        ball.p_WB = {0.0, 0.0, R}, ball.inv_mass = 1.0 / m;
        ball.inv_inertia_W = Mat3::Identity() / inertia;
        const double v_x = 1.0, w_y = 30.0, w_z = 50.0, P = m * (1.0 + e) * fall;
        ball.twist = {Vec3(v_x, 0.0, -fall), Vec3(0.0, w_y, w_z)};
        collideBodies(floor, ball, pointAt({0.0, 0.0, 0.0}, Vec3::UnitZ()), {100.0, e, R, c, s});
        const double spun = std::max(w_z - s * R * P / inertia, 0.0);
        const double stops =
            m * v_x * R + inertia * w_y;  // angular momentum about the contact: L stops it, friction does not
        const double rolls = std::max(stops - c * R * P, 0.0) / (m * R * R + inertia);
        EXPECT_NEAR(ball.twist.v_WB.z(), e * fall, 1e-9) << e << ", " << s << ", " << c;
        EXPECT_NEAR(ball.twist.w_WB.z(), spun, 1e-8) << e << ", " << s << ", " << c;
        EXPECT_NEAR(ball.twist.w_WB.y(), rolls, 1e-8) << e << ", " << s << ", " << c;
        EXPECT_NEAR(ball.twist.v_WB.x(), R * rolls, 1e-9) << e << ", " << s << ", " << c;
      }
}

// A plate lands on one edge of its lower face while the other one rises, more slowly than the blow would make it fall.
// No point may be left closing, and what bears no impulse gets no rebound. With P1 and P2 the impulses at edges that are
// 2 a apart, W = 1/m + a²/I and V = 1/m - a²/I:  u1' = u1 + W P1 + V P2,  u2' = u2 + V P1 + W P2.
TEST(ImpactLaw, AnEdgeThatRisesIsHeldButDoesNotRebound) {
  const double m = 2.0, a = 0.5, inertia = m * a * a / 3.0;
  for (const double e : {0.0, 0.3, 0.6, 0.8})  // with 1 the edge that is held would give energy
    for (const double rises : {0.0, 0.1, 0.4, 0.9, 3.0}) {
      ImpactSide ground, plate;
      ground.p_WB = Vec3::Zero();
      ground.inv_mass = 0.0, ground.inv_inertia_W.setZero();
      plate.p_WB.setZero();
      plate.inv_mass = 1.0 / m;
      plate.inv_inertia_W = Vec3(1.0 / inertia, 1.0 / inertia, 1.0 / inertia).asDiagonal();
      const double u1 = -1.0, u2 = rises;
      plate.twist = {Vec3(0.0, 0.0, 0.5 * (u1 + u2)), Vec3(0.0, 0.5 * (u2 - u1) / a, 0.0)};
      Manifold manifold = pointAt({a, 0.0, 0.0}, Vec3::UnitZ());
      manifold.size = 2;
      manifold.points[1].p_W = {-a, 0.0, 0.0};
      const auto speedAt = [&](double x) { return plate.twist.v_WB.z() - x * plate.twist.w_WB.y(); };
      ASSERT_NEAR(speedAt(-a), u2, 1e-12);
      ASSERT_NEAR(speedAt(a), u1, 1e-12);
      const double W = 1.0 / m + a * a / inertia, V = 1.0 / m - a * a / inertia;
      double P1 = -(1.0 + e) * u1 / W, P2 = 0.0;
      if (u2 + V * P1 < 0.0) {  // both bear: u1' = -e u1, u2' = 0
        const double determinant = W * W - V * V, b1 = -(1.0 + e) * u1, b2 = -u2;
        P1 = (W * b1 - V * b2) / determinant, P2 = (W * b2 - V * b1) / determinant;
      }
      collideBodies(ground, plate, manifold, {0.0, e});
      EXPECT_NEAR(speedAt(a), u1 + W * P1 + V * P2, 1e-10) << "e = " << e << ", rises at " << rises;
      EXPECT_NEAR(speedAt(-a), u2 + V * P1 + W * P2, 1e-10) << "e = " << e << ", rises at " << rises;
    }
}

}  // namespace
