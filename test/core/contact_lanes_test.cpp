// SPDX-License-Identifier: BSD-3-Clause
// Four pairs at a time against one after the other: the law of soft_step.cpp, written here for one point and
// gone through in the pairs' own order, with responses from whole matrices.
#include "solver/contact_lanes.h"

#include "base/algebra.h"
#include "make_scene.h"
#include "solver_scene.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <random>

namespace rbs::test {
namespace {

constexpr double kStep = 1.0 / 60.0, kSubStep = kStep / 8.0;
const Softness kSoft{12.0, 0.9, 0.1};

// A heap of balls and boxes that overlap, over a plane, with a box that does not move among them.
class Heap {
 public:
  Heap(unsigned seed, double friction) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> place(-1.2, 1.2), speed(-2.0, 2.0), size(0.3, 0.8);
    scene_.store.settings.step = kStep;
    const auto vector = [&](auto& from) { return Vec3(from(random), from(random), from(random)); };
    for (int k = 0; k < 60; ++k) {
      const std::string name = "body_" + std::to_string(k);
      BodyDef def =
          k % 2 ? ball(name, 0.5 * size(random), vector(place)) : box(name, vector(size), vector(place));
      if (k == 0) def = floor_();
      if (k == 1) def.kind = BodyKind::Static;
      if (k > 0) def.pose.q_WB = rotationBy(vector(speed));
      def.material.friction = k % 5 == 0 ? 0.0 : friction;
      if (k > 1) def.twist = {vector(speed), vector(speed)};
      scene_.store.bodies.append({static_cast<std::uint64_t>(k + 1)}, def);
    }
    scene_.begin(kStep);
    for (Index i = 0; i < scene_.store.bodies.size(); ++i)
      for (Index j = i + 1; j < scene_.store.bodies.size(); ++j) scene_.touch(i, j);
  }

  Context& context() { return scene_.context; }
  const Subgraph& batch() const { return scene_.batch; }

 private:
  static BodyDef floor_() {
    BodyDef def = body("floor", Plane{}, Vec3(0.0, 0.0, -1.0));
    def.kind = BodyKind::Static;
    return def;
  }

  SolverScene scene_;
};

void push(SolverContacts& contacts, const SolverBlock& block, const SolverPoint& point,
          const Vec3& impulse_W) {
  SolverBody &i = contacts.bodies[block.i], &j = contacts.bodies[block.j];
  i.v -= i.inv_mass * impulse_W;
  i.w -= i.inv_inertia_W * point.r_i.cross(impulse_W);
  j.v += j.inv_mass * impulse_W;
  j.w += j.inv_inertia_W * point.r_j.cross(impulse_W);
}

// What an impulse at a point does to the velocity there.
Mat3 responseAt(const SolverContacts& contacts, const SolverBlock& block, const SolverPoint& point) {
  const SolverBody &i = contacts.bodies[block.i], &j = contacts.bodies[block.j];
  const Mat3 r_i = crossMatrix(point.r_i), r_j = crossMatrix(point.r_j);
  return (i.inv_mass + j.inv_mass) * Mat3::Identity() - r_i * i.inv_inertia_W * r_i -
         r_j * j.inv_inertia_W * r_j;
}

// Velocity of j against i at a point.
Vec3 velocityAt(const SolverContacts& contacts, const SolverBlock& block, const SolverPoint& point) {
  const SolverBody &i = contacts.bodies[block.i], &j = contacts.bodies[block.j];
  return j.v + j.w.cross(point.r_j) - i.v - i.w.cross(point.r_i);
}

// How far the points of a block are from the law of contact, in units of 1 m/s.
BlockResiduals residualsOf(const SolverContacts& contacts, const SolverBlock& block) {
  BlockResiduals worst;
  for (int k = block.first; k < block.first + block.size; ++k) {
    const SolverPoint& point = contacts.points[k];
    const Vec3 u = velocityAt(contacts, block, point);
    const double u_n = block.n.dot(u), limit = block.pair.mu * point.l_n, friction = point.l_t.norm();
    const double off = point.l_n != 0.0 ? std::abs(u_n) : point.open <= 0.0 ? -u_n : 0.0;
    worst.signorini = std::max(worst.signorini, off);
    if (limit == 0.0) continue;
    const Eigen::Vector2d u_t(block.t1.dot(u), block.t2.dot(u));
    const bool sticks = friction < limit * (1.0 - 1e-9);
    const Eigen::Vector2d against = sticks ? u_t : Eigen::Vector2d(u_t + u_t.norm() / friction * point.l_t);
    worst.dissipation = std::max(worst.dissipation, against.norm());
    const double mass = 1.0 / block.n.dot(responseAt(contacts, block, point) * block.n);
    worst.coulomb = std::max(worst.coulomb, (friction - limit) / mass);
  }
  return worst;
}

// The friction of a block: of all points, or again of those that slide, which are written down in `slides`.
void solveFriction(SolverContacts& contacts, const SolverBlock& block, bool again,
                   std::vector<bool>& slides) {
  Eigen::Matrix<double, 3, 2> T;
  T << block.t1, block.t2;
  for (int k = block.first; k < block.first + block.size; ++k) {
    SolverPoint& point = contacts.points[k];
    if (again && !slides[k]) continue;
    const Eigen::Matrix2d S = T.transpose() * responseAt(contacts, block, point) * T;
    const Eigen::Vector2d slip = T.transpose() * velocityAt(contacts, block, point);
    const double limit = block.pair.mu * point.l_n;
    Eigen::Vector2d l_t = point.l_t - S.inverse() * slip;
    slides[k] = l_t.norm() > limit;
    if (slides[k]) {
      l_t = point.l_t - slip / Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(S).eigenvalues()[1];
      if (l_t.norm() > limit) l_t *= limit / l_t.norm();
    }
    push(contacts, block, point, T * (l_t - point.l_t));
    point.l_t = l_t;
  }
}

void passInOrder(SolverContacts& contacts, bool soft) {
  std::vector<bool> slides(contacts.points.size());
  for (const SolverBlock& block : contacts.blocks) {
    if (block.has_friction) solveFriction(contacts, block, false, slides);
    for (int k = block.first; k < block.first + block.size; ++k) {
      SolverPoint& point = contacts.points[k];
      if (!soft && point.l_n == 0.0) continue;
      const double mass = 1.0 / block.n.dot(responseAt(contacts, block, point) * block.n);
      const double u_n = block.n.dot(velocityAt(contacts, block, point));
      double l_n = point.l_n - mass * u_n;
      if (point.open > 0.0)
        l_n = point.l_n - mass * (u_n + point.open / kSubStep);
      else if (soft)
        l_n = (1.0 - kSoft.impulse) * point.l_n -
              kSoft.mass * mass * (u_n + std::max(kSoft.bias * point.open, -block.pair.push));
      l_n = std::max(l_n, 0.0);
      push(contacts, block, point, (l_n - point.l_n) * block.n);
      point.l_n = l_n;
    }
    if (block.has_friction && !soft) solveFriction(contacts, block, true, slides);
  }
}

class ContactLanesOf : public testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Friction, ContactLanesOf, testing::Values(0.0, 0.5));

TEST_P(ContactLanesOf, FourPairsAtATimeAreThePairsInTheirOrder) {
  for (const unsigned seed : {1u, 2u, 3u}) {
    Heap heap(seed, GetParam()), same(seed, GetParam());
    SolverContacts::Stores stores, other_stores;
    SolverContacts contacts(heap.context(), heap.batch(), stores),
        one_by_one(same.context(), same.batch(), other_stores);
    contacts.find(0.0, kStep, kSubStep);
    one_by_one.find(0.0, kStep, kSubStep);
    std::size_t points = 0, slides = 0;
    double signorini = 0.0, dissipation = 0.0;
    for (const SolverBlock& block : contacts.blocks) points += static_cast<std::size_t>(block.size);
    ASSERT_GT(points, 200u);
    ContactLanes::Stores lane_stores;
    Workers workers;
    ContactLanes lanes(contacts, lane_stores, workers);
    lanes.take();
    for (const bool soft : {true, false, true, false}) {
      lanes.solve(soft ? Pass::Soft : Pass::Relax, kSoft, kSubStep);
      passInOrder(one_by_one, soft);
    }
    lanes.writePoints();
    lanes.measure(1.0);
    for (const SolverBlock& block : contacts.blocks) {
      const BlockResiduals expected = residualsOf(contacts, block), &measured = block.residuals;
      EXPECT_NEAR(measured.signorini, expected.signorini, 1e-12);
      EXPECT_NEAR(measured.coulomb, expected.coulomb, 1e-12);
      EXPECT_NEAR(measured.dissipation, expected.dissipation, 1e-12);
      signorini = std::max(signorini, measured.signorini),
      dissipation = std::max(dissipation, measured.dissipation);
    }
    for (std::size_t k = 0; k < contacts.bodies.size(); ++k) {
      EXPECT_LT((contacts.bodies[k].v - one_by_one.bodies[k].v).norm(), 1e-11) << k;
      EXPECT_LT((contacts.bodies[k].w - one_by_one.bodies[k].w).norm(), 1e-10) << k;
    }
    for (const SolverBlock& block : contacts.blocks)
      for (int k = block.first; k < block.first + block.size; ++k) {
        const SolverPoint &a = contacts.points[k], &b = one_by_one.points[k];
        EXPECT_NEAR(a.l_n, b.l_n, 1e-9) << k;
        EXPECT_LT((a.l_t - b.l_t).norm(), 1e-9) << k;
        slides += a.l_t.norm() > 0.999 * block.pair.mu * a.l_n && a.l_n > 0.0 && block.pair.mu > 0.0;
      }
    EXPECT_GT(signorini, 1e-3) << "there is something to measure";
    if (GetParam() > 0.0) EXPECT_GT(dissipation, 1e-3);
    if (GetParam() > 0.0) EXPECT_GT(slides, 20u) << "both branches of friction are to be taken";
  }
}

}  // namespace
}  // namespace rbs::test
