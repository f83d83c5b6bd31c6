// SPDX-License-Identifier: BSD-3-Clause
// Rows of joints in the Coulomb problem: each solver by itself against linear algebra in long double, all states of the
// bounds tried one by one, closed forms, and the law evaluated from its definition.
#include "core/coulomb_problems.h"
#include "coulomb/coulomb_solvers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <vector>

using namespace rbs;
using namespace rbs::coulomb;
using namespace rbs::coulomb_problems;

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
using Long = long double;
using LongX = Eigen::Matrix<Long, Eigen::Dynamic, 1>;
using LongXX = Eigen::Matrix<Long, Eigen::Dynamic, Eigen::Dynamic>;

struct Alone {
  std::string name;
  std::function<Answer(const System&, BodyBlocks&)> solve;
};

Answer cold(const System& system) {
  const Impulses none = system.noImpulses();
  return {none, system.residuals(none)};
}

// As in solveCoulomb(), a few of Newton's steps finish what an interior point finds.
Answer finished(const System& system, BodyBlocks& matrix, const Answer& answer) {
  return answer.within(1e-8) ? answer : newton(system, matrix, answer, 1e3, 1e-8, 20);
}

const std::vector<Alone> kSolvers = {
    {"gauss_seidel", [](const System& s, BodyBlocks&) { return gaussSeidel(s, 1e-8, 20000); }},
    {"newton", [](const System& s, BodyBlocks& m) { return newton(s, m, cold(s), 10.0, 1e-8, 400); }},
    {"interior_point",
     [](const System& s, BodyBlocks& m) { return finished(s, m, interiorPoint(s, m, 1e-6, 80)); }},
    {"interior_point_from_guess",
     [](const System& s, BodyBlocks& m) { return finished(s, m, interiorPoint(s, m, cold(s), 1e-6, 80)); }},
    {"path", [](const System& s, BodyBlocks& m) { return finished(s, m, followPath(s, m, 1e-6, 600)); }},
    {"admm", [](const System& s, BodyBlocks& m) { return admm(s, m, cold(s).r, 1e-8, 20000); }}};

// Each of the solvers on a copy of a problem: whether it converged, and what it makes of the problem.
void forEachSolver(const CoulombProblem& problem, const std::function<void(const CoulombProblem&)>& check) {
  for (const Alone& solver : kSolvers) {
    SCOPED_TRACE(solver.name);
    CoulombProblem solved = problem;
    const System system(solved);
    BodyBlocks matrix(system);
    const Answer answer = solver.solve(system, matrix);
    EXPECT_TRUE(answer.within(1e-8)) << answer.residuals.worst() << " after " << answer.iterations;
    system.store(answer.r, solved);
    check(solved);
  }
}

/// Rows along the columns of `axes`, of the velocity of j against i at a point: a ball joint where they are all there.
BoundedRows translation(const Scene& scene, Index i, Index j, const Vec3& at, const Mat3& axes,
                        const Vec3& lo, const Vec3& hi) {
  BoundedRows rows;
  rows.i = i, rows.j = j;
  rows.J_i.setZero(), rows.J_j.setZero();
  if (i != kNone) rows.J_i << -axes.transpose(), -(crossMatrix(at - scene.p[i]) * axes).transpose();
  if (j != kNone) rows.J_j << axes.transpose(), (crossMatrix(at - scene.p[j]) * axes).transpose();
  rows.lo = lo, rows.hi = hi;
  return rows;
}

BoundedRows ballJoint(const Scene& scene, Index i, Index j, const Vec3& at) {
  return translation(scene, i, j, at, Mat3::Identity(), Vec3::Constant(-kInfinity),
                     Vec3::Constant(kInfinity));
}

/// Rows of turning about the columns of `axes`, times a length.
BoundedRows rotation(Index i, Index j, const Mat3& axes, double length, const Vec3& lo, const Vec3& hi) {
  BoundedRows rows;
  rows.i = i, rows.j = j;
  rows.J_i.setZero(), rows.J_j.setZero();
  rows.J_i.rightCols<3>() = -length * axes.transpose();
  rows.J_j.rightCols<3>() = length * axes.transpose();
  rows.lo = lo, rows.hi = hi;
  return rows;
}

/// All velocities of bodies, (v, w) each, and the rows of all joints by them: u = J y + bias.
struct Dense {
  LongX y, bias, lo, hi;
  LongXX J, inverse_mass;

  explicit Dense(const CoulombProblem& problem) {
    const auto bodies = static_cast<Eigen::Index>(problem.bodies.size());
    const auto rows = 3 * static_cast<Eigen::Index>(problem.joints.size());
    y.resize(6 * bodies), inverse_mass.setZero(6 * bodies, 6 * bodies);
    for (Eigen::Index k = 0; k < bodies; ++k) {
      const CoulombBody& body = problem.bodies[static_cast<std::size_t>(k)];
      y.segment<3>(6 * k) = body.v.cast<Long>(), y.segment<3>(6 * k + 3) = body.w.cast<Long>();
      inverse_mass.block<3, 3>(6 * k, 6 * k).diagonal().setConstant(1.0L / body.mass);
      if (body.turns) inverse_mass.block<3, 3>(6 * k + 3, 6 * k + 3) = body.inertia_W.cast<Long>().inverse();
    }
    J.setZero(rows, 6 * bodies), bias.resize(rows), lo.resize(rows), hi.resize(rows);
    for (Eigen::Index k = 0; 3 * k < rows; ++k) {
      const BoundedRows& joint = problem.joints[static_cast<std::size_t>(k)];
      if (joint.i != kNone) J.block<3, 6>(3 * k, 6 * joint.i) += joint.J_i.cast<Long>();
      if (joint.j != kNone) J.block<3, 6>(3 * k, 6 * joint.j) += joint.J_j.cast<Long>();
      bias.segment<3>(3 * k) = joint.bias.cast<Long>();
      lo.segment<3>(3 * k) = joint.lo.cast<Long>(), hi.segment<3>(3 * k) = joint.hi.cast<Long>();
    }
  }
  LongX velocities(const LongX& r) const { return y + inverse_mass * J.transpose() * r; }
  LongX relative(const LongX& r) const { return J * velocities(r) + bias; }
};

LongX velocitiesOf(const CoulombProblem& problem) {
  return Dense(problem).y;
}

/// The velocities with bilateral rows: J y = -bias in the least change of kinetic energy, by a decomposition that knows rank.
LongX bilateral(const CoulombProblem& problem) {
  const Dense dense(problem);
  const LongXX W = dense.J * dense.inverse_mass * dense.J.transpose();
  const LongX r = W.completeOrthogonalDecomposition().solve(-(dense.J * dense.y + dense.bias));
  return dense.velocities(r);
}

/// A chain of boxes that hang on each other and on the world, thrown about.
Scene chain(int links, double ratio, unsigned seed, bool closed = false) {
  std::mt19937 random(seed);
  const auto uniform = [&](double lo, double hi) { return lo + (hi - lo) * (random() / 4294967296.0); };
  const auto vector = [&](double size) {
    return Vec3(uniform(-size, size), uniform(-size, size), uniform(-size, size));
  };
  Scene scene;
  Vec3 at = Vec3::Zero();
  Index before = kNone;
  for (int k = 0; k < links; ++k) {
    const Vec3 next = at + Vec3(uniform(-0.5, 0.5), uniform(-0.5, 0.5), -0.5);
    const Index link = scene.box(std::pow(ratio, uniform(0.0, 1.0)), {0.1, 0.2, (next - at).norm()},
                                 0.5 * (at + next), vector(1.0), vector(3.0));
    scene.problem.joints.push_back(ballJoint(scene, before, link, at));
    before = link, at = next;
  }
  if (closed) scene.problem.joints.push_back(ballJoint(scene, before, kNone, at));
  return scene;
}

TEST(CoulombJoints, EverySolverHangsChainsAsLinearAlgebraDoes) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE(seed);
    const CoulombProblem problem = chain(1 + static_cast<int>(seed), 3.0, seed, seed % 2).problem;
    const LongX expected = bilateral(problem);
    forEachSolver(problem, [&](const CoulombProblem& solved) {
      EXPECT_LE((velocitiesOf(solved) - expected).norm(), 1e-6L * (1.0L + expected.norm()));
    });
  }
}

// A joint that is there twice has no unique impulses; the motion is the same.
TEST(CoulombJoints, EverySolverTakesRedundantRows) {
  CoulombProblem problem = chain(3, 10.0, 7).problem;
  const LongX expected = bilateral(problem);
  problem.joints.push_back(problem.joints[1]);
  forEachSolver(problem, [&](const CoulombProblem& solved) {
    EXPECT_LE((velocitiesOf(solved) - expected).norm(), 1e-6L * expected.norm());
  });
}

TEST(CoulombJoints, LongChainsOfUnevenMassesAreExact) {
  for (const double ratio : {1.0, 1e3})
    for (const int links : {1, 10, 60})
      for (const bool closed : {false, true}) {
        CoulombProblem problem = chain(links, ratio, 3, closed).problem;
        const LongX expected = bilateral(problem);
        const CoulombResult result = solveCoulomb(problem, 1e-9, 1e-12);
        EXPECT_TRUE(result.converged) << links << " links, " << ratio << ": " << result.signorini;
        EXPECT_LE((velocitiesOf(problem) - expected).norm(), 1e-8L * (1.0L + expected.norm()))
            << links << " links, " << ratio;
      }
}

TEST(CoulombJoints, ASolutionAsGuessTakesNoIterationAndOneThatIsNoNumberDoesNoHarm) {
  CoulombProblem problem = chain(5, 10.0, 4).problem;
  const CoulombProblem before = problem;
  ASSERT_TRUE(solveCoulomb(problem, 1e-9, 1e-12).converged);
  CoulombProblem again = before, spoilt = before;
  for (std::size_t k = 0; k < again.joints.size(); ++k) {
    again.joints[k].impulse = problem.joints[k].impulse;
    spoilt.joints[k].impulse = Vec3(0.0, std::nan(""), kInfinity);
  }
  EXPECT_EQ(solveCoulomb(again, 1e-9, 1e-12).iterations, 0);
  EXPECT_LE((velocitiesOf(again) - velocitiesOf(problem)).norm(), 1e-9L);
  EXPECT_TRUE(solveCoulomb(spoilt, 1e-9, 1e-12).converged);
  EXPECT_LE((velocitiesOf(spoilt) - velocitiesOf(problem)).norm(), 1e-9L);
}

/// Whether a state is possible: of each row within its bounds, at the lower, or at the upper one.
bool isSolution(const Dense& dense, const std::vector<int>& state, LongX& r) {
  std::vector<Eigen::Index> within;
  r = LongX::Zero(dense.bias.size());
  for (Eigen::Index c = 0; c < r.size(); ++c) {
    const int at = state[static_cast<std::size_t>(c)];
    if (at == 0) within.push_back(c);
    if (at != 0) r[c] = at < 0 ? dense.lo[c] : dense.hi[c];
    if (at != 0 && !std::isfinite(static_cast<double>(r[c]))) return false;
  }
  const LongXX W = dense.J * dense.inverse_mass * dense.J.transpose();
  const LongX u = dense.relative(r);
  LongXX part(within.size(), within.size());
  LongX right(within.size());
  for (std::size_t a = 0; a < within.size(); ++a) {
    right[static_cast<Eigen::Index>(a)] = -u[within[a]];
    for (std::size_t b = 0; b < within.size(); ++b)
      part(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b)) = W(within[a], within[b]);
  }
  const LongX solved = within.empty() ? right : LongX(part.fullPivLu().solve(right));
  for (std::size_t a = 0; a < within.size(); ++a) r[within[a]] = solved[static_cast<Eigen::Index>(a)];
  const LongX now = dense.relative(r);
  for (Eigen::Index c = 0; c < r.size(); ++c) {
    const int at = state[static_cast<std::size_t>(c)];
    if (at == 0 && (r[c] < dense.lo[c] || r[c] > dense.hi[c])) return false;
    if ((at < 0 && now[c] < 0.0L) || (at > 0 && now[c] > 0.0L)) return false;
  }
  return true;
}

// Two bodies with a limited joint between them and one to the world: 3^6 states, of which one is possible.
TEST(CoulombJoints, EverySolverFindsTheOnePossibleStateOfBounds) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const auto uniform = [&](double lo, double hi) { return lo + (hi - lo) * (random() / 4294967296.0); };
    Scene scene = chain(2, 5.0, 50 + seed);
    for (BoundedRows& joint : scene.problem.joints)
      for (int c = 0; c < 3; ++c) {
        const unsigned kind = random() % 4;  // both bounds, one, the other, none
        joint.lo[c] = kind == 1 || kind == 3 ? -kInfinity : -uniform(0.0, 1.0);
        joint.hi[c] = kind == 2 || kind == 3 ? kInfinity : uniform(0.0, 1.0);
        joint.bias[c] = uniform(-0.5, 0.5);
      }
    const Dense dense(scene.problem);
    std::vector<int> state(6);
    LongX expected, r;
    int solutions = 0;
    for (int code = 0; code < 729; ++code) {
      for (int c = 0, rest = code; c < 6; ++c, rest /= 3) state[static_cast<std::size_t>(c)] = rest % 3 - 1;
      if (isSolution(dense, state, r)) ++solutions, expected = r;
    }
    ASSERT_EQ(solutions, 1);
    forEachSolver(scene.problem, [&](const CoulombProblem& solved) {
      for (Eigen::Index c = 0; c < 6; ++c)
        EXPECT_NEAR(solved.joints[static_cast<std::size_t>(c / 3)].impulse[c % 3],
                    static_cast<double>(expected[c]), 1e-6);
    });
  }
}

// One row without friction is a contact point: 0 and infinity for its bounds.
TEST(CoulombJoints, AUnilateralRowIsAContactWithoutFriction) {
  Scene contact = slope(0.3, 0.0, Vec3::Zero(), Vec3(0.4, -0.2, 0.1)), limit = contact;
  for (const CoulombPoint& point : contact.problem.points) {
    const Vec3 at = limit.p[point.j] + point.r_j;
    Mat3 axes = Mat3::Zero();
    axes.col(0) = point.frame.col(2);
    limit.problem.joints.push_back(
        translation(limit, point.i, point.j, at, axes, Vec3::Zero(), Vec3(kInfinity, 0.0, 0.0)));
  }
  limit.problem.points.clear();
  ASSERT_TRUE(solveCoulomb(contact.problem, 1e-9, 1e-12).converged);
  forEachSolver(limit.problem, [&](const CoulombProblem& solved) {
    EXPECT_LE((velocitiesOf(solved) - velocitiesOf(contact.problem)).norm(), 1e-7L);
    for (const BoundedRows& joint : solved.joints)
      EXPECT_EQ(joint.impulse.tail<2>(), Eigen::Vector2d::Zero());
  });
}

// A wheel on an axle, driven to turn at 2 rad/s by at most 0.3 N m: I dw = T h until it has the speed.
TEST(CoulombJoints, AMotorTurnsAWheelByNoMoreThanItCan) {
  for (const double most : {0.3, 300.0}) {
    Scene scene;
    const Index wheel = scene.ball(2.0, 0.25, Vec3::Zero());
    const double inertia = 0.4 * 2.0 * 0.25 * 0.25, length = 0.25;
    scene.problem.joints.push_back(ballJoint(scene, kNone, wheel, Vec3::Zero()));
    const double limit = most * kStep / length;  // of L/length
    BoundedRows motor = rotation(kNone, wheel, Mat3::Identity(), length, Vec3(-kInfinity, -limit, -kInfinity),
                                 Vec3(kInfinity, limit, kInfinity));
    motor.bias.y() = -2.0 * length;
    scene.problem.joints.push_back(motor);
    const double expected = std::min(2.0, most * kStep / inertia);
    forEachSolver(scene.problem, [&](const CoulombProblem& solved) {
      EXPECT_NEAR(solved.bodies[0].w.y(), expected, 1e-6);
      EXPECT_LE(solved.bodies[0].v.norm(), 1e-7);
      EXPECT_LE(Eigen::Vector2d(solved.bodies[0].w.x(), solved.bodies[0].w.z()).norm(), 1e-7);
    });
  }
}

TEST(CoulombJoints, EqualBoundsPrescribeAnImpulse) {
  Scene scene;
  const Index ball = scene.ball(2.0, 0.1, Vec3::Zero(), Vec3(1.0, 0.0, 0.0));
  const Vec3 impulse(0.3, -0.2, 0.5);
  scene.problem.joints.push_back(
      translation(scene, kNone, ball, Vec3::Zero(), Mat3::Identity(), impulse, impulse));
  const Vec3 expected = scene.problem.bodies[0].v + impulse / 2.0;
  forEachSolver(scene.problem, [&](const CoulombProblem& solved) {
    EXPECT_LE((solved.bodies[0].v - expected).norm(), 1e-14);
  });
}

TEST(CoulombJoints, ABodyThatDoesNotTurnIsHeldAllTheSame) {
  Scene scene;
  const Index box = scene.box(2.0, Vec3::Ones(), Vec3::Zero(), Vec3::Zero(), Vec3(0.0, 0.0, 2.0));
  scene.problem.bodies[box].turns = false;
  scene.problem.joints.push_back(ballJoint(scene, kNone, box, Vec3(0.5, 0.0, 0.0)));
  forEachSolver(scene.problem, [&](const CoulombProblem& solved) {
    EXPECT_EQ(solved.bodies[0].w, Vec3(0.0, 0.0, 2.0));
    EXPECT_LE((solved.bodies[0].v - Vec3(0.0, -1.0, 0.0)).norm(), 1e-7) << "its corner does not move";
  });
}

// --- beside contacts

/// How far a solved problem is from its laws, as a fraction of the unit of speed, from their definitions.
double violation(const CoulombProblem& problem) {
  double worst = 0.0;
  const auto massOf = [&](Index i, Index j) {
    return std::min(i == kNone ? kInfinity : problem.bodies[i].mass,
                    j == kNone ? kInfinity : problem.bodies[j].mass);
  };
  const auto at = [&](Index body, const Vec3& arm) -> Vec3 {
    return body == kNone ? Vec3(Vec3::Zero()) : problem.bodies[body].v + problem.bodies[body].w.cross(arm);
  };
  for (const CoulombPoint& point : problem.points) {
    const Vec3 u = point.frame.transpose() * (at(point.j, point.r_j) - at(point.i, point.r_i)) + point.bias,
               &r = point.impulse;
    const double mass = massOf(point.i, point.j), size = r.head<2>().norm(),
                 slack = (point.mu * r[2] - size) / mass;
    worst = std::max(worst, std::abs(std::min(u[2], r[2] / mass)));
    const Eigen::Vector2d t = u.head<2>();
    const Eigen::Vector2d opposed =
        size > 0.0 ? Eigen::Vector2d(-std::max(-t.dot(r.head<2>()) / size, 0.0) / size * r.head<2>())
                   : Eigen::Vector2d::Zero();
    const double bound = point.mu * r[2] / mass;
    worst = std::max({worst, -slack, std::min({t.norm(), bound, std::max((t - opposed).norm(), slack)})});
  }
  const LongX u = Dense(problem).relative(LongX::Zero(3 * static_cast<Eigen::Index>(problem.joints.size())));
  for (std::size_t k = 0; k < problem.joints.size(); ++k) {
    const BoundedRows& joint = problem.joints[k];
    const double mass = massOf(joint.i, joint.j);
    for (int c = 0; c < 3; ++c) {
      const double speed = static_cast<double>(u[3 * static_cast<Eigen::Index>(k) + c]), r = joint.impulse[c];
      worst = std::max({worst, (joint.lo[c] - r) / mass, (r - joint.hi[c]) / mass});
      if (speed > 0.0) worst = std::max(worst, std::min(speed, (r - joint.lo[c]) / mass));
      if (speed < 0.0) worst = std::max(worst, std::min(-speed, (joint.hi[c] - r) / mass));
    }
  }
  return worst / problem.speed_unit;
}

/// A heap of which some neighbours are joined, some by what gives way.
Scene joinedHeap(int side, double mu, double ratio, double speed, unsigned seed) {
  Scene scene = rubble(side, mu, ratio, speed, seed);
  std::mt19937 random(1000 + seed);
  const auto uniform = [&](double lo, double hi) { return lo + (hi - lo) * (random() / 4294967296.0); };
  for (Index j = 1; j < scene.p.size(); j += 2) {
    const Vec3 at = 0.5 * (scene.p[j - 1] + scene.p[j]);
    BoundedRows joint = ballJoint(scene, j - 1, j, at);
    if (random() % 2)
      joint.lo = Vec3::Constant(-uniform(0.01, 0.3)), joint.hi = Vec3::Constant(uniform(0.01, 0.3));
    scene.problem.joints.push_back(joint);
  }
  scene.problem.joints.push_back(ballJoint(scene, kNone, 0, scene.p[0] + Vec3(0.0, 0.3, 0.1)));
  return scene;
}

// Methods of first order may go round for ever where friction holds a heap.
TEST(CoulombJoints, HeapsWithJointsAreSolvedByEveryMethod) {
  constexpr unsigned kHeaps = 24;
  for (const Alone& solver : kSolvers) {
    SCOPED_TRACE(solver.name);
    const bool first_order = solver.name == "gauss_seidel" || solver.name == "admm";
    unsigned solved = 0;
    for (unsigned seed = 1; seed <= kHeaps; ++seed) {
      SCOPED_TRACE(seed);
      CoulombProblem problem = joinedHeap(2, 0.1 * (seed % 5), 3.0, seed % 2, seed).problem;
      const System system(problem);
      BodyBlocks matrix(system);
      const Answer answer = solver.solve(system, matrix);
      if (first_order && !answer.within(1e-8)) continue;
      ++solved;
      EXPECT_TRUE(answer.within(1e-8)) << answer.residuals.worst();
      system.store(answer.r, problem);
      EXPECT_LT(violation(problem), 1e-6);
    }
    EXPECT_GE(solved, kHeaps - 4);
  }
}

TEST(CoulombJoints, LargeHeapsWithJointsAreExact) {
  for (const int side : {2, 3, 4})
    for (unsigned seed = 1; seed <= 8; ++seed) {
      SCOPED_TRACE(seed);
      Scene scene = joinedHeap(side, 0.5, 100.0, seed % 2, 100 + seed);
      const CoulombResult result = solveCoulomb(scene.problem, 1e-6, 1e-9);
      EXPECT_TRUE(result.converged) << side << ": " << result.signorini << ' ' << result.coulomb << ' '
                                    << result.dissipation;
      EXPECT_LT(violation(scene.problem), 1e-5);
    }
}

TEST(CoulombJoints, UnitsDoNotMatter) {
  Scene scene = joinedHeap(2, 0.4, 3.0, 1.0, 5);
  CoulombProblem scaled = scene.problem;  // lengths a thousandfold, masses a hundredth, the same time
  const double length = 1e3, mass = 1e-2;
  scaled.speed_unit *= length;
  for (CoulombBody& body : scaled.bodies)
    body.mass *= mass, body.inertia_W *= mass * length * length, body.v *= length;
  for (CoulombPoint& point : scaled.points) point.r_i *= length, point.r_j *= length, point.bias *= length;
  for (BoundedRows& joint : scaled.joints) {
    joint.J_i.rightCols<3>() *= length, joint.J_j.rightCols<3>() *= length, joint.bias *= length;
    joint.lo *= mass * length, joint.hi *= mass * length;
  }
  ASSERT_TRUE(solveCoulomb(scene.problem, 1e-9, 1e-12).converged);
  ASSERT_TRUE(solveCoulomb(scaled, 1e-9, 1e-12).converged);
  for (std::size_t k = 0; k < scaled.bodies.size(); ++k)
    EXPECT_LE((scaled.bodies[k].v / length - scene.problem.bodies[k].v).norm(), 1e-8);
}

}  // namespace
