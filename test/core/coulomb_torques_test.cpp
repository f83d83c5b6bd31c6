// SPDX-License-Identifier: BSD-3-Clause
// Rolling and torsional resistance in the Coulomb problem: each solver by itself against closed forms, a slow
// method in long double, and the law evaluated from its definition.
#include "core/coulomb_problems.h"
#include "coulomb/coulomb_solvers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <vector>

using namespace rbs;
using namespace rbs::coulomb;
using namespace rbs::coulomb_problems;

namespace {

// Each to 1e-6 from a cold start. The interior point and its path are finished as solveCoulomb() does it, by
// a few of Newton's steps, which get nowhere from a cold start.
struct Alone {
  std::string name;
  std::function<Answer(const System&, BodyBlocks&)> solve;
};

Answer cold(const System& system) {
  const Impulses zero = Impulses::Zero(3, static_cast<Eigen::Index>(system.columns()));
  return {zero, system.residuals(zero)};
}

Answer finished(const System& system, BodyBlocks& matrix, const Answer& answer) {
  return answer.within(1e-6) ? answer : newton(system, matrix, answer, 1e3, 1e-6, 20);
}

const std::vector<Alone> kSolvers = {
    {"gauss_seidel", [](const System& s, BodyBlocks&) { return gaussSeidel(s, 1e-6, 20000); }},
    {"newton", [](const System& s, BodyBlocks& m) { return newton(s, m, cold(s), 10.0, 1e-6, 400); }},
    {"interior_point",
     [](const System& s, BodyBlocks& m) { return finished(s, m, interiorPoint(s, m, 1e-6, 80)); }},
    {"interior_point_from_guess",
     [](const System& s, BodyBlocks& m) {
       const Answer guess = newton(s, m, cold(s), 10.0, 1e-2, 20);
       return finished(s, m, interiorPoint(s, m, guess, 1e-6, 80));
     }},
    {"path", [](const System& s, BodyBlocks& m) { return finished(s, m, followPath(s, m, 1e-6, 600)); }},
    {"admm", [](const System& s, BodyBlocks& m) { return admm(s, m, cold(s).r, 1e-6, 5000); }}};

/// The velocity of each column of impulses, points then torques, by definition.
std::vector<Vec3> velocities(const CoulombProblem& problem) {
  const auto at = [&](Index body, const Vec3& arm) -> Vec3 {
    if (body == kNone) return Vec3::Zero();
    return problem.bodies[body].v + problem.bodies[body].w.cross(arm);
  };
  const auto turning = [&](Index body) -> Vec3 {
    return body == kNone ? Vec3(Vec3::Zero()) : problem.bodies[body].w;
  };
  std::vector<Vec3> u;
  for (const CoulombPoint& point : problem.points)
    u.push_back(point.frame.transpose() * (at(point.j, point.r_j) - at(point.i, point.r_i)) + point.bias);
  for (const TorqueConstraint& torque : problem.torques)
    u.push_back(torque.radius * (torque.frame.transpose() * (turning(torque.j) - turning(torque.i))) +
                torque.bias);
  return u;
}

/// How far one friction is from its law under its bound, as a speed: an impulse beyond the bound, slip that
/// it does not oppose, and slip under less than the bound, all of it no more than the bound can do. `mass`
/// turns impulses into speeds.
template <class Vec>
double frictionError(const Vec& r, const Vec& u, double bound, double mass) {
  const double size = r.norm(), slack = (bound - size) / mass;
  const Vec opposed = size > 0.0 ? Vec(std::max(-u.dot(r) / size, 0.0) / size * -r) : Vec(Vec::Zero());
  return std::max(-slack, std::min({u.norm(), bound / mass, std::max((u - opposed).norm(), slack)}));
}

/// The largest violation of the laws, as a fraction of the unit of speed.
double violation(const CoulombProblem& problem) {
  const std::vector<Vec3> u = velocities(problem);
  double worst = 0.0;
  const auto mass = [&](Index i, Index j) {
    double least = 1e300;
    for (const Index body : {i, j})
      if (body != kNone) least = std::min(least, problem.bodies[body].mass);
    return least;
  };
  for (std::size_t k = 0; k < problem.points.size(); ++k) {
    const CoulombPoint& point = problem.points[k];
    const Vec3& r = point.impulse;
    const double m = mass(point.i, point.j);
    worst = std::max(worst, std::abs(std::min(u[k][2], r[2] / m)));
    worst = std::max(worst, frictionError<Eigen::Vector2d>(r.head<2>(), u[k].head<2>(), point.mu * r[2], m));
  }
  for (std::size_t k = 0; k < problem.torques.size(); ++k) {
    const TorqueConstraint& torque = problem.torques[k];
    const Vec3 &r = torque.impulse, &turn = u[problem.points.size() + k];
    const double m = mass(torque.i, torque.j);
    double n = 0.0;
    for (Index p = torque.first; p < torque.first + torque.size; ++p) n += problem.points[p].impulse[2];
    worst = std::max(worst, frictionError<Eigen::Vector2d>(r.head<2>(), turn.head<2>(), torque.roll * n, m));
    using Vec1 = Eigen::Matrix<double, 1, 1>;
    worst = std::max(worst, frictionError<Vec1>(r.tail<1>(), turn.tail<1>(), torque.spin * n, m));
  }
  return worst / problem.speed_unit;
}

/// What a solver makes of a problem: whether it converged, with its impulses and velocities in the problem.
bool solveAlone(const Alone& solver, CoulombProblem& problem) {
  const System system(problem);
  BodyBlocks matrix(system);
  const Answer answer = solver.solve(system, matrix);
  system.store(answer.r, problem);
  return answer.within(1e-6);
}

/// A marble under gravity that leans by atan(slope), at rest.
Scene marbleOnSlope(double slope, double roll, double spin) {
  Scene scene;
  const double radius = 0.1, angle = std::atan(slope);
  const Index ball = scene.ball(2.0, radius, {0, 0, radius});
  scene.problem.bodies[ball].v = kGravity * kStep * Vec3(std::sin(angle), 0, -std::cos(angle));
  scene.touch(kNone, ball, Vec3::Zero(), Vec3::UnitZ(), 0.5);
  resistTurning(scene, roll, spin, radius);
  return scene;
}

TEST(CoulombTorques, EverySolverHoldsAMarbleOnASlopeUpToItsResistance) {
  for (const Alone& solver : kSolvers) {
    SCOPED_TRACE(solver.name);
    const double c = 0.05;
    for (const double slope : {0.5 * c, 0.99 * c, 1.01 * c, 4.0 * c}) {
      Scene scene = marbleOnSlope(slope, c, 0.02);
      EXPECT_TRUE(solveAlone(solver, scene.problem)) << slope;
      // It rolls with 5/7 of what its resistance leaves.
      const double angle = std::atan(slope);
      const double free = kGravity * kStep * (std::sin(angle) - c * std::cos(angle));
      EXPECT_NEAR(scene.problem.bodies[0].v.x(), 5.0 / 7.0 * std::max(free, 0.0), 1e-6) << slope;
    }
  }
}

TEST(CoulombTorques, EverySolverSlowsASpinningMarbleByItsTorsion) {
  for (const Alone& solver : kSolvers) {
    SCOPED_TRACE(solver.name);
    const double s = 0.02, lost = 2.5 * s * kGravity * kStep / 0.1;
    for (const double w : {0.5 * lost, -3.0 * lost}) {
      Scene scene = marbleOnSlope(0.0, 0.03, s);
      scene.problem.bodies[0].w.z() = w;
      EXPECT_TRUE(solveAlone(solver, scene.problem)) << w;
      EXPECT_NEAR(scene.problem.bodies[0].w.z(), std::copysign(std::max(std::abs(w) - lost, 0.0), w), 1e-5)
          << w;
    }
  }
}

TEST(CoulombTorques, EverySolverKeepsPrescribedDirections) {
  for (const Alone& solver : kSolvers) {
    SCOPED_TRACE(solver.name);
    // At rest on the flat it would stay: told that it rolls about x and spins, torques act at their limits.
    Scene scene = marbleOnSlope(0.0, 0.03, 0.02);
    TorqueConstraint& torque = scene.problem.torques[0];
    torque.rolls = torque.frame.leftCols<2>().transpose() * Vec3::UnitX();
    torque.spins = -1.0;
    EXPECT_TRUE(solveAlone(solver, scene.problem));
    const double push = kGravity * kStep / 0.1;
    EXPECT_NEAR(scene.problem.bodies[0].w.x(), -5.0 / 7.0 * 0.03 * push, 1e-5);
    EXPECT_NEAR(scene.problem.bodies[0].w.z(), 2.5 * 0.02 * push, 1e-5);
  }
}

// Eight bodies with contacts of 1 to 4 points.
TEST(CoulombTorques, EverySolverSolvesRandomHeaps) {
  for (const Alone& solver : kSolvers) {
    SCOPED_TRACE(solver.name);
    for (unsigned seed = 1; seed <= 24; ++seed) {
      const double share = seed / 24.0;
      Scene scene = rubble(2, 0.6 * share, 3.0, seed % 2, seed);
      resistTurning(scene, 0.2 * (seed % 3) / 2.0, 0.2 * (seed % 4) / 3.0, 0.4);
      EXPECT_TRUE(solveAlone(solver, scene.problem)) << seed;
      EXPECT_LT(violation(scene.problem), 1e-5) << seed;
    }
  }
}

TEST(CoulombTorques, HeapsOfUnevenMassesAreSolved) {
  for (const int side : {2, 3})
    for (unsigned seed = 1; seed <= 12; ++seed) {
      SCOPED_TRACE(seed);
      Scene scene = rubble(side, 0.5, 1e3, seed % 2, 100 + seed);
      resistTurning(scene, 0.02 * (1 + seed % 5), 0.01 * (seed % 4), 0.4);
      const CoulombResult result = solveCoulomb(scene.problem, 1e-6, 1e-9);
      EXPECT_TRUE(result.converged);
      EXPECT_LT(violation(scene.problem), 1e-5);
    }
}

// --- a slow method in long double

using LongX = Eigen::Matrix<long double, Eigen::Dynamic, 1>;
using LongXX = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;

/// The velocities of all columns as a linear function of their impulses, u = W r + q, from unit impulses.
void delassus(const CoulombProblem& problem, LongXX& W, LongX& q) {
  const auto flat = [](const std::vector<Vec3>& u) {
    LongX all(3 * static_cast<Eigen::Index>(u.size()));
    for (std::size_t k = 0; k < u.size(); ++k)
      all.segment<3>(3 * static_cast<Eigen::Index>(k)) = u[k].cast<long double>();
    return all;
  };
  CoulombProblem still = problem;
  for (CoulombBody& body : still.bodies) body.v.setZero(), body.w.setZero();
  q = flat(velocities(problem));
  W.resize(q.size(), q.size());
  for (Eigen::Index c = 0; c < q.size(); ++c) {
    CoulombProblem pushed = still;
    const auto push = [&](Index body, const Vec3& linear, const Vec3& angular) {
      if (body == kNone) return;
      pushed.bodies[body].v += linear / problem.bodies[body].mass;
      pushed.bodies[body].w += problem.bodies[body].inertia_W.inverse() * angular;
    };
    const std::size_t k = static_cast<std::size_t>(c / 3), points = problem.points.size();
    if (k < points) {
      const CoulombPoint& point = problem.points[k];
      const Vec3 r_W = point.frame.col(c % 3);
      push(point.i, -r_W, -point.r_i.cross(r_W));
      push(point.j, r_W, point.r_j.cross(r_W));
    } else {
      const TorqueConstraint& torque = problem.torques[k - points];
      const Vec3 torque_W = torque.radius * torque.frame.col(c % 3);
      push(torque.i, Vec3::Zero(), -torque_W);
      push(torque.j, Vec3::Zero(), torque_W);
    }
    for (CoulombPoint& point : pushed.points) point.bias.setZero();
    for (TorqueConstraint& torque : pushed.torques) torque.bias.setZero();
    W.col(c) = flat(velocities(pushed));
  }
}

/// Projected steps r_n = (r_n - rho u_n)_+, friction onto its ball, one row group after the other, until
/// nothing moves.
struct Slow {
  LongX r, u;
  bool settled = false;
};

Slow projectedSteps(const CoulombProblem& problem) {
  LongXX W;
  LongX q;
  delassus(problem, W, q);
  Slow slow{LongX::Zero(q.size()), q};
  LongX &r = slow.r, &u = slow.u;
  const Eigen::Index points = static_cast<Eigen::Index>(problem.points.size());
  const auto ball = [](auto x, long double bound) {
    const long double length = x.norm();
    if (length > bound) x *= bound / length;
    return x;
  };
  for (int sweep = 0; sweep < 20000 && !slow.settled; ++sweep) {
    long double moved = 0.0L;
    for (Eigen::Index c = 0; c < q.size(); c += 3) {
      const Eigen::Index k = c / 3;
      const long double rho = 1.0L / W.diagonal().segment<3>(c).sum();
      Eigen::Matrix<long double, 3, 1> x = r.segment<3>(c) - rho * u.segment<3>(c);
      if (k < points) {
        x[2] = std::max(x[2], 0.0L);
        x.head<2>() = ball(x.head<2>().eval(), problem.points[k].mu * x[2]);
      } else {
        const TorqueConstraint& torque = problem.torques[k - points];
        long double n = 0.0L;
        for (Index p = torque.first; p < torque.first + torque.size; ++p) n += r[3 * p + 2];
        x.head<2>() = ball(x.head<2>().eval(), torque.roll * n);
        x.tail<1>() = ball(x.tail<1>().eval(), torque.spin * n);
      }
      const Eigen::Matrix<long double, 3, 1> d = x - r.segment<3>(c);
      moved = std::max(moved, d.cwiseAbs().maxCoeff() / rho);
      r.segment<3>(c) = x;
      u += W.middleCols<3>(c) * d;
    }
    slow.settled = moved < 1e-15L;
  }
  return slow;
}

/// Balls in a row, each on the one before, thrown at random.
Scene row(unsigned seed) {
  std::mt19937 random(seed);
  const auto uniform = [&](double lo, double hi) { return lo + (hi - lo) * (random() / 4294967296.0); };
  const auto vector = [&](double size) {
    return Vec3(uniform(-size, size), uniform(-size, size), uniform(-size, size));
  };
  Scene scene;
  for (int k = 0; k < 4; ++k) {
    const Index ball =
        scene.ball(std::pow(10.0, uniform(-1.5, 1.5)), 0.5, {0, 0, k + 0.5}, vector(0.5), vector(1.0));
    const Vec3 n_W = (Vec3::UnitZ() + vector(0.2)).normalized();
    scene.touch(k == 0 ? kNone : ball - 1, ball, {0, 0, 1.0 * k}, n_W, uniform(0.0, 0.4));
  }
  resistTurning(scene, uniform(0.0, 0.2), uniform(0.0, 0.2), 0.25);
  return scene;
}

/// Solves a problem, and expects that the impulses of the slow method pass as a guess. Returns how far the
/// velocities of the two are apart, m/s.
double expectBothLawful(CoulombProblem problem, const Slow& slow) {
  CoulombProblem guessed = problem;
  const std::size_t points = guessed.points.size();
  for (std::size_t k = 0; k < points + guessed.torques.size(); ++k) {
    const Vec3 r = slow.r.segment<3>(3 * static_cast<Eigen::Index>(k)).cast<double>();
    (k < points ? guessed.points[k].impulse : guessed.torques[k - points].impulse) = r;
  }
  EXPECT_EQ(solveCoulomb(guessed, 1e-11).iterations, 0);
  EXPECT_LT(violation(guessed), 1e-11);
  EXPECT_TRUE(solveCoulomb(problem, 1e-12).converged);
  EXPECT_LT(violation(problem), 1e-11);
  const std::vector<Vec3> u = velocities(problem), other = velocities(guessed);
  double apart = 0.0;
  for (std::size_t k = 0; k < u.size(); ++k) apart = std::max(apart, (u[k] - other[k]).norm());
  return apart;
}

TEST(CoulombTorques, AgreesWithProjectedStepsRunToTheirEnd) {
  int settled = 0;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(seed);
    const Scene scene = row(seed);
    const Slow slow = projectedSteps(scene.problem);
    if (!slow.settled) continue;
    ++settled;
    EXPECT_LT(expectBothLawful(scene.problem, slow), 1e-9);
  }
  EXPECT_GE(settled, 30);
}

// In a heap solutions are not unique: that of the slow method need only be one.
TEST(CoulombTorques, TheLawIsThatOfProjectedStepsInHeaps) {
  int settled = 0;
  for (unsigned seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE(seed);
    Scene scene = rubble(2, seed % 2 ? 0.1 : 0.3, 3.0, seed % 4 < 2, seed);
    resistTurning(scene, seed % 2 ? 0.02 : 0.1, 0.02 * (seed % 3), 0.4);
    const Slow slow = projectedSteps(scene.problem);
    if (!slow.settled) continue;
    ++settled;
    expectBothLawful(scene.problem, slow);
  }
  EXPECT_GE(settled, 3);
}

}  // namespace
