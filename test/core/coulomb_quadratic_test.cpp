// SPDX-License-Identifier: BSD-3-Clause
// Problems without friction: the convex solver alone against all sets of pushing points tried one by one, and against the law
// summed in long double. The law is also enough, since the problem is convex.
#include "core/coulomb_problems.h"
#include "coulomb/coulomb_solvers.h"

#include <gtest/gtest.h>
#include <Eigen/QR>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

using namespace rbs;
using namespace rbs::coulomb;
using namespace rbs::coulomb_problems;

namespace {

using Long = long double;
using LongX = Eigen::Matrix<Long, Eigen::Dynamic, 1>;
using LongXX = Eigen::Matrix<Long, Eigen::Dynamic, Eigen::Dynamic>;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

class Numbers {
 public:
  explicit Numbers(unsigned seed) : random_(seed) {}
  double operator()(double from, double to) {
    return std::uniform_real_distribution<double>(from, to)(random_);
  }
  int whole(int from, int to) { return std::uniform_int_distribution<int>(from, to)(random_); }
  Vec3 vector(double size) { return {(*this)(-size, size), (*this)(-size, size), (*this)(-size, size)}; }

 private:
  std::mt19937 random_;
};

// Bodies anywhere that touch each other and the world anywhere: most problems have redundant points, some of them on one spot.
Scene tangle(unsigned seed, int bodies, int points, double most_ratio) {
  Numbers number(seed);
  Scene scene;
  for (int k = 0; k < bodies; ++k) {
    const double mass = std::pow(10.0, number(0.0, std::log10(most_ratio)));
    const Vec3 v = number.vector(2.0), w = number.vector(2.0);
    if (number.whole(0, 1) == 0)
      scene.ball(mass, 0.5, number.vector(2.0), v, w);
    else
      scene.box(mass, {1.0, number(0.1, 1.0), number(0.1, 1.0)}, number.vector(2.0), v, w);
  }
  for (int k = 0; k < points; ++k) {
    const Index j = static_cast<Index>(number.whole(0, bodies - 1)),
                i = static_cast<Index>(number.whole(0, bodies));
    const Vec3 n = i == static_cast<Index>(bodies) || i == j ? Vec3(number.vector(0.3) + Vec3::UnitZ())
                                                             : Vec3(scene.p[j] - scene.p[i]);
    const bool again = k > 0 && number.whole(0, 4) == 0;
    if (again) {
      scene.problem.points.push_back(scene.problem.points.back());
    } else {
      scene.touch(i == static_cast<Index>(bodies) || i == j ? kNone : i, j, scene.p[j] - 0.5 * n.normalized(),
                  n.normalized(), 0.0);
    }
    CoulombPoint& point = scene.problem.points.back();
    point.bias[2] = number.whole(0, 2) == 0 ? number(0.0, 0.5) : 0.0;
    if (point.i == kNone) point.give = number.whole(0, 3) == 0 ? number(0.0, 1.0) : 0.0;
  }
  return scene;
}

Answer solved(const System& system, int cap = 200) {
  BodyBlocks matrix(system);
  const Impulses zero = system.noImpulses();
  return quadratic(system, matrix, {zero, system.residuals(zero)}, 1e-10, cap);
}

struct Dense {
  LongXX J;  // rows of the normals, then those of joints
  LongX free, lo, hi;
};

Dense denseOf(const System& system) {
  const auto points = static_cast<Eigen::Index>(system.points().size());
  const auto joints = static_cast<Eigen::Index>(system.joints().size());
  const Eigen::Index bodies = system.free().cols(), rows = points + 3 * joints;
  Dense dense{LongXX::Zero(rows, 6 * bodies), LongX::Zero(rows), LongX::Zero(rows),
              LongX::Constant(rows, kInfinity)};
  const Eigen::VectorXd y = Eigen::Map<const Eigen::VectorXd>(system.free().data(), 6 * bodies);
  const auto take = [&](Eigen::Index row, const Rows& of, int c) {
    if (of.i != kNone) dense.J.row(row).segment<6>(6 * of.i) += of.J_i.row(c).cast<Long>();
    if (of.j != kNone) dense.J.row(row).segment<6>(6 * of.j) += of.J_j.row(c).cast<Long>();
    dense.free[row] = of.bias[c] + dense.J.row(row).dot(y.cast<Long>());
  };
  for (Eigen::Index k = 0; k < points; ++k) take(k, system.points()[k], 2);
  for (Eigen::Index k = 0; k < joints; ++k)
    for (int c = 0; c < 3; ++c) {
      const Eigen::Index row = points + 3 * k + c;
      take(row, system.joints()[k], c);
      dense.lo[row] = system.joints()[k].box.lo[c], dense.hi[row] = system.joints()[k].box.hi[c];
    }
  return dense;
}

LongX impulsesOf(const System& system, const Impulses& r) {
  const auto points = static_cast<Eigen::Index>(system.points().size());
  LongX all(points + 3 * static_cast<Eigen::Index>(system.joints().size()));
  for (Eigen::Index k = 0; k < points; ++k) all[k] = r(2, k);
  for (std::size_t k = 0; k < system.joints().size(); ++k)
    all.segment<3>(points + 3 * static_cast<Eigen::Index>(k)) = r.col(system.firstJoint() + k).cast<Long>();
  return all;
}

// How far impulses are from the law, in units of speed: an impulse x of a row is worth the speed that it makes there.
double errorOf(const Dense& dense, const LongX& r) {
  const LongX u = dense.free + dense.J * (dense.J.transpose() * r);
  Long worst = 0.0L;
  for (Eigen::Index k = 0; k < r.size(); ++k) {
    const Long response = dense.J.row(k).squaredNorm();
    if (response == 0.0L) continue;
    const Long next = std::clamp(r[k] - u[k] / response, dense.lo[k], dense.hi[k]);
    worst = std::max(worst, response * std::abs(next - r[k]));
  }
  return static_cast<double>(worst);
}

// The change of y, by trying each set of points that push.
LongX bySets(const Dense& dense) {
  const auto n = static_cast<int>(dense.free.size());
  LongX best;
  Long least = kInfinity;
  for (unsigned set = 0; set < 1u << n; ++set) {
    std::vector<int> pushing;
    for (int k = 0; k < n; ++k)
      if (set & 1u << k) pushing.push_back(k);
    LongX r = LongX::Zero(n);
    if (!pushing.empty()) {
      LongXX J(pushing.size(), dense.J.cols());
      LongX right(pushing.size());
      for (std::size_t k = 0; k < pushing.size(); ++k) {
        J.row(static_cast<Eigen::Index>(k)) = dense.J.row(pushing[k]);
        right[static_cast<Eigen::Index>(k)] = -dense.free[pushing[k]];
      }
      const LongX some = (J * J.transpose()).completeOrthogonalDecomposition().solve(right);
      for (std::size_t k = 0; k < pushing.size(); ++k) r[pushing[k]] = some[static_cast<Eigen::Index>(k)];
    }
    const LongX u = dense.free + dense.J * (dense.J.transpose() * r);
    Long error = std::max(-u.minCoeff(), -r.minCoeff());
    for (const int k : pushing) error = std::max(error, std::abs(u[k]));
    if (error < least) least = error, best = dense.J.transpose() * r;
  }
  EXPECT_LT(static_cast<double>(least), 1e-12);
  return best;
}

TEST(CoulombQuadratic, FindsWhatTryingEverySetOfPointsFinds) {
  for (unsigned seed = 0; seed < 150; ++seed) {
    SCOPED_TRACE(seed);
    const Scene scene = tangle(seed, 1 + static_cast<int>(seed % 4), 2 + static_cast<int>(seed % 9), 100.0);
    const System system(scene.problem);
    const Answer answer = solved(system);
    const Dense dense = denseOf(system);
    const LongX change = dense.J.transpose() * impulsesOf(system, answer.r);
    EXPECT_NEAR(static_cast<double>((change - bySets(dense)).norm()), 0.0,
                1e-8 * (1.0 + static_cast<double>(change.norm())));
  }
}

TEST(CoulombQuadratic, KeepsTheLawInHeapsOfAnyMasses) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(seed);
    const double ratio = std::pow(10.0, seed % 7);
    const int bodies = 3 + static_cast<int>(seed) % 40;
    const Scene scene = tangle(seed, bodies, 4 * bodies, ratio);
    const System system(scene.problem);
    const Answer answer = solved(system);
    EXPECT_TRUE(answer.within(1e-10)) << answer.residuals.beyond_rounding;
    const Dense dense = denseOf(system);
    const LongX r = impulsesOf(system, answer.r);
    const LongX lengths = dense.J.rowwise().norm();
    const Long rounding = 4.0L * std::numeric_limits<double>::epsilon() * lengths.maxCoeff() * lengths.dot(r);
    EXPECT_LT(errorOf(dense, r), 2e-10 + static_cast<double>(rounding));
  }
}

TEST(CoulombQuadratic, KnowsTheBoundsOfJoints) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(seed);
    const int bodies = 2 + static_cast<int>(seed) % 12;
    Scene scene = tangle(seed, bodies, 2 * bodies, 10.0);
    Numbers number(seed + 1000);
    const double unit = scene.problem.speed_unit;
    for (int k = 0; k + 1 < bodies; ++k) {
      BoundedRows rows;
      rows.i = static_cast<Index>(k), rows.j = static_cast<Index>(k + 1);
      const Vec3 at = 0.5 * (scene.p[k] + scene.p[k + 1]);
      rows.J_i << -Mat3::Identity(), crossMatrix(at - scene.p[k]);
      rows.J_j << Mat3::Identity(), -crossMatrix(at - scene.p[k + 1]);
      for (int c = 0; c < 3; ++c) {
        const double lo = number(-2.0, 1.0) * unit, bounds[][2] = {{-kInfinity, kInfinity},
                                                                   {0.0, kInfinity},
                                                                   {lo, lo + number(0.0, 2.0) * unit},
                                                                   {lo, lo}};
        const auto& [from, to] = bounds[number.whole(0, 3)];
        rows.lo[c] = from, rows.hi[c] = to;
      }
      scene.problem.joints.push_back(rows);
    }
    const System system(scene.problem);
    const Answer answer = solved(system);
    EXPECT_TRUE(answer.within(1e-10)) << answer.residuals.beyond_rounding;
    EXPECT_LT(errorOf(denseOf(system), impulsesOf(system, answer.r)), 1e-8);
  }
}

// Six by six by six balls that fall on each other: most of them are solved in one round.
Scene lattice(bool turn) {
  Scene scene;
  Numbers number(7);
  const auto at = [](int x, int y, int z) { return static_cast<Index>(36 * x + 6 * y + z); };
  for (int x = 0; x < 6; ++x)
    for (int y = 0; y < 6; ++y)
      for (int z = 0; z < 6; ++z) {
        const Index k = scene.ball(1.0, 0.5, Vec3(x, y, z) + number.vector(0.02), number.vector(0.2));
        scene.problem.bodies[k].turns = turn;
        const auto meet = [&](Index other) {
          const Vec3 n = (scene.p[k] - scene.p[other]).normalized();
          scene.touch(other, k, scene.p[k] - 0.5 * n, n, 0.0);
        };
        if (x > 0) meet(at(x - 1, y, z));
        if (y > 0) meet(at(x, y - 1, z));
        z > 0 ? meet(at(x, y, z - 1))
              : void(scene.touch(kNone, k, scene.p[k] - 0.5 * Vec3::UnitZ(), Vec3::UnitZ(), 0.0));
      }
  return scene;
}

TEST(CoulombQuadratic, BallsThatNothingTurnsMoveAsThoseThatMayTurn) {
  Scene still = lattice(false), turning = lattice(true);
  const Vec3 spin(1.0, -2.0, 3.0);
  for (Scene* scene : {&still, &turning})
    for (CoulombBody& body : scene->problem.bodies) body.w = spin;
  EXPECT_TRUE(solveCoulomb(still.problem, 1e-10).converged);
  EXPECT_TRUE(solveCoulomb(turning.problem, 1e-10).converged);
  for (std::size_t k = 0; k < still.problem.bodies.size(); ++k) {
    const CoulombBody &a = still.problem.bodies[k], &b = turning.problem.bodies[k];
    EXPECT_NEAR((a.v - b.v).norm(), 0.0, 1e-9) << k;
    EXPECT_EQ(a.w, spin) << k;
    EXPECT_NEAR((b.w - spin).norm(), 0.0, 1e-9) << k;
  }
}

TEST(CoulombQuadratic, IsForWhatHasNeitherFrictionNorTorques) {
  Scene scene = tangle(3, 5, 12, 2.0);
  EXPECT_TRUE(isFrictionless(System(scene.problem)));
  Scene rough = scene;
  rough.problem.points[7].mu = 1e-9;
  EXPECT_FALSE(isFrictionless(System(rough.problem)));
  Scene resisting = scene;
  resistTurning(resisting, 0.1, 0.0, 0.1);
  EXPECT_FALSE(isFrictionless(System(resisting.problem)));
}

TEST(CoulombQuadratic, EndsWhereThereIsNoAnswer) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double value : {kInfinity, -kInfinity, nan})
    for (int part = 0; part < 6; ++part) {
      Scene scene = tangle(5, 4, 10, 2.0);
      CoulombBody& body = scene.problem.bodies[2];
      (part < 3 ? body.v[part] : body.w[part - 3]) = value;
      EXPECT_FALSE(solveCoulomb(scene.problem, 1e-10).converged) << value << " " << part;
    }
  // A ball that flies up for ever is far from the floor.
  Scene ball;
  ball.ball(1.0, 0.5, 0.5 * Vec3::UnitZ());
  ball.problem.bodies[0].turns = false, ball.problem.bodies[0].v.z() = kInfinity;
  ball.touch(kNone, 0, Vec3::Zero(), Vec3::UnitZ(), 0.0);
  ball.touch(kNone, 0, Vec3::Zero(), Vec3::UnitZ(), 0.0);
  EXPECT_FALSE(solveCoulomb(ball.problem, 1e-10).converged);
  // Two rows that ask for two speeds of one body, and one that nothing obeys.
  for (const bool moves : {true, false}) {
    Scene scene;
    scene.ball(1.0, 0.5, Vec3::Zero());
    for (const double speed : {1.0, 2.0}) {
      BoundedRows rows;
      rows.i = kNone, rows.j = 0;
      rows.J_i.setZero(), rows.J_j.setZero();
      if (moves) rows.J_j.leftCols<3>().setIdentity();
      rows.bias = Vec3(speed, 0.0, 0.0);
      rows.lo = Vec3::Constant(-kInfinity), rows.hi = Vec3::Constant(kInfinity);
      scene.problem.joints.push_back(rows);
    }
    EXPECT_FALSE(solveCoulomb(scene.problem, 1e-10).converged);
  }
  CoulombProblem nothing;
  nothing.speed_unit = 1.0;
  EXPECT_TRUE(solved(System(nothing)).within(1e-10));
}

TEST(CoulombQuadratic, TakesFewIterations) {
  Scene scene = lattice(false);
  const System system(scene.problem);
  const Answer cold = solved(system);
  EXPECT_TRUE(cold.within(1e-10));
  EXPECT_LE(cold.iterations, 8);
  // Other velocities: what pushed goes on, but for some.
  Numbers number(8);
  for (CoulombBody& body : scene.problem.bodies) body.v += number.vector(0.01);
  const System next(scene.problem);
  BodyBlocks matrix(next);
  const Answer warm = quadratic(next, matrix, {cold.r, next.residuals(cold.r)}, 1e-10, 200);
  EXPECT_TRUE(warm.within(1e-10));
  EXPECT_LE(warm.iterations, 8);
  // The same once more needs none but the one that finds so.
  const Answer same = quadratic(next, matrix, warm, 1e-10, 200);
  EXPECT_LE(same.iterations, 1);
}

}  // namespace
