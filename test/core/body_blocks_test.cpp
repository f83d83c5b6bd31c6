// SPDX-License-Identifier: BSD-3-Clause
// The block matrix of an island against Eigen's dense one.
#include "coulomb/body_blocks.h"

#include "core/coulomb_problems.h"

#include <gtest/gtest.h>
#include <Eigen/LU>

#include <limits>
#include <random>
#include <vector>

using namespace rbs;
using namespace rbs::coulomb;
using namespace rbs::coulomb_problems;

namespace {

using Dense = Eigen::MatrixXd;

class Numbers {
 public:
  double operator()() { return unit_(random_); }
  template <class Matrix>
  Matrix matrix() {
    return Matrix::NullaryExpr([this] { return (*this)(); });
  }

 private:
  std::mt19937 random_{3};
  std::uniform_real_distribution<double> unit_{-1.0, 1.0};
};

// The rows of J of a point or torque, six columns a body.
Dense rowsOf(const Rows& rows, Eigen::Index bodies) {
  Dense J = Dense::Zero(3, 6 * bodies);
  if (rows.i != kNone) J.middleCols<6>(6 * rows.i) = rows.J_i;
  if (rows.j != kNone) J.middleCols<6>(6 * rows.j) = rows.J_j;
  return J;
}

// 1 + J^T D J, by its definition: a torque has a column g by the sum of the normal rows of its points, weighed with theirs.
Dense denseOf(const System& system, const std::vector<Mat3>& D, const std::vector<Vec3>& g) {
  const Eigen::Index bodies = system.free().cols();
  Dense A = Dense::Identity(6 * bodies, 6 * bodies);
  for (std::size_t k = 0; k < system.columns(); ++k) {
    const Dense J = rowsOf(system.rows(k), bodies);
    A += J.transpose() * D[k] * J;
    if (k < system.points().size()) continue;
    const TorqueRows& torque = system.torques()[k - system.points().size()];
    for (std::size_t p = torque.first; p < torque.first + torque.size; ++p)
      A += J.transpose() * g[k - system.points().size()] * D[p](2, 2) *
           rowsOf(system.points()[p], bodies).row(2);
  }
  return A;
}

// D of an iteration: positive, and not symmetric where points slide.
void expectDense(const Scene& scene, double skew) {
  Numbers number;
  const System system(scene.problem);
  std::vector<Mat3> D;
  for (std::size_t k = 0; k < system.columns(); ++k) {
    const Mat3 root = number.matrix<Mat3>();
    D.push_back(root * root.transpose() + Mat3::Identity() + skew * number.matrix<Mat3>());
  }
  std::vector<Vec3> g;
  for (std::size_t k = 0; k < system.torques().size(); ++k) g.push_back(0.2 * number.matrix<Vec3>());
  BodyBlocks blocks(system);
  ASSERT_TRUE(blocks.factor(D, g));
  const Velocities y = Velocities::NullaryExpr(6, system.free().cols(), [&] { return number(); });
  const Eigen::VectorXd right = Eigen::Map<const Eigen::VectorXd>(y.data(), y.size());
  const Eigen::VectorXd exact = denseOf(system, D, g).partialPivLu().solve(right);
  const Velocities x = blocks.solve(y);
  EXPECT_LE((Eigen::Map<const Eigen::VectorXd>(x.data(), x.size()) - exact).norm(), 1e-11 * exact.norm());
}

Scene heap(int bodies) {
  Scene scene;
  Numbers number;
  for (int k = 0; k < bodies; ++k)
    scene.box(1.0 + number(), {0.3 + 0.1 * number(), 0.4, 0.5}, number.matrix<Vec3>());
  for (int k = 0; k < 3 * bodies; ++k) {
    const Index i = static_cast<Index>((number() + 1.0) * 0.499 * bodies), j = static_cast<Index>(k % bodies);
    scene.touch(i == j ? kNone : i, j, number.matrix<Vec3>(), number.matrix<Vec3>().normalized(), 0.5);
  }
  return scene;
}

TEST(BodyBlocks, SolveAsADenseMatrixDoes) {
  for (const int bodies : {1, 2, 3, 7, 20, 40})
    for (const double skew : {0.0, 0.3}) expectDense(heap(bodies), skew);
  expectDense(wall(6, 4), 0.3);
  expectDense(cardHouse(3), 0.3);
}

// What one factorisation takes of a budget.
std::int64_t workOf(Scene scene) {
  SolveBudget budget{1'000'000'000};
  scene.problem.budget = &budget;
  const System system(scene.problem);
  BodyBlocks(system).factor(std::vector<Mat3>(system.columns(), Mat3::Identity()), {});
  return 1'000'000'000 - budget.left;
}

TEST(BodyBlocks, AreSmallerWhereNothingTurns) {
  Scene turning = heap(40), still = turning;
  for (CoulombBody& body : still.problem.bodies) body.turns = false;
  EXPECT_LT(2 * workOf(still), workOf(turning));
  for (const int bodies : {1, 2, 7, 40}) {
    Scene scene = heap(bodies);
    for (CoulombBody& body : scene.problem.bodies) body.turns = false;
    EXPECT_FALSE(System(scene.problem).turns());
    for (const double skew : {0.0, 0.3}) expectDense(scene, skew);
    if (bodies == 1) continue;
    scene.problem.bodies.front().turns = true;
    EXPECT_TRUE(System(scene.problem).turns());
    expectDense(scene, 0.3);
  }
}

TEST(BodyBlocks, HaveTheBlocksOfTorques) {
  Scene scene = heap(8);
  for (std::size_t k = 0; k < scene.problem.points.size(); k += 2) {
    const CoulombPoint& point = scene.problem.points[k];
    TorqueConstraint torque;
    torque.i = point.i, torque.j = point.j;
    torque.frame = point.frame;
    torque.first = static_cast<Index>(k), torque.size = 1;
    torque.radius = 0.1, torque.roll = 0.2, torque.spin = 0.3;
    scene.problem.torques.push_back(torque);
  }
  expectDense(scene, 0.3);
}

TEST(BodyBlocks, RefuseWhatIsNotFinite) {
  const Scene scene = wall(2, 2);
  const System system(scene.problem);
  std::vector<Mat3> D(system.columns(), Mat3::Identity());
  D[3](1, 1) = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(BodyBlocks(system).factor(D, {}));
}

}  // namespace
