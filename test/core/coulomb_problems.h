// SPDX-License-Identifier: BSD-3-Clause
// Coulomb problems whose difficulty is known, by formula: shared by the tests of the solvers and their
// benchmark.
#pragma once

#include "base/algebra.h"
#include "coulomb/coulomb.h"

#include <array>
#include <cmath>
#include <random>
#include <vector>

namespace rbs::coulomb_problems {

constexpr double kGravity = 9.81, kStep = 1.0 / 60.0;  // m/s^2, s

/// A problem under construction: bodies at places, points between them. z is up.
struct Scene {
  CoulombProblem problem;
  std::vector<Vec3> p;  // centres, m

  Scene() { problem.speed_unit = kGravity * kStep; }

  /// A box of edges `size`, moving with (v, w), before gravity.
  Index box(double mass, const Vec3& size, const Vec3& centre, const Vec3& v = Vec3::Zero(),
            const Vec3& w = Vec3::Zero(), const Mat3& R_WB = Mat3::Identity()) {
    const Vec3 s = size.cwiseProduct(size);
    const Vec3 moments = mass / 12.0 * Vec3(s.y() + s.z(), s.x() + s.z(), s.x() + s.y());
    problem.bodies.push_back(
        {mass, R_WB * moments.asDiagonal() * R_WB.transpose(), v - Vec3(0, 0, kGravity * kStep), w});
    p.push_back(centre);
    return static_cast<Index>(p.size() - 1);
  }
  Index ball(double mass, double radius, const Vec3& centre, const Vec3& v = Vec3::Zero(),
             const Vec3& w = Vec3::Zero()) {
    problem.bodies.push_back(
        {mass, 0.4 * mass * radius * radius * Mat3::Identity(), v - Vec3(0, 0, kGravity * kStep), w});
    p.push_back(centre);
    return static_cast<Index>(p.size() - 1);
  }
  /// A point at `at`, n from i to j.
  CoulombPoint& touch(Index i, Index j, const Vec3& at, const Vec3& n, double mu) {
    const auto [t1, t2] = tangents(n);
    CoulombPoint point;
    point.i = i, point.j = j;
    point.r_i = i == kNone ? Vec3::Zero() : Vec3(at - p[i]);
    point.r_j = j == kNone ? Vec3::Zero() : Vec3(at - p[j]);
    point.frame << t1, t2, n;
    point.mu = mu;
    problem.points.push_back(point);
    return problem.points.back();
  }
  /// The corners of a rectangle about `at`, with half edges a and b.
  void patch(Index i, Index j, const Vec3& at, const Vec3& n, const Vec3& a, const Vec3& b, double mu) {
    for (const double x : {-1.0, 1.0})
      for (const double y : {-1.0, 1.0}) touch(i, j, at + x * a + y * b, n, mu);
  }
};

/// Unit boxes on each other on the ground, the lowest first.
inline Scene stack(const std::vector<double>& masses, double mu = 0.5) {
  Scene scene;
  Index below = kNone;
  for (std::size_t k = 0; k < masses.size(); ++k) {
    const Index body = scene.box(masses[k], Vec3::Ones(), {0, 0, k + 0.5});
    scene.patch(below, body, {0, 0, static_cast<double>(k)}, Vec3::UnitZ(), {0.5, 0, 0}, {0, 0.5, 0}, mu);
    below = body;
  }
  return scene;
}

/// A box on the ground under gravity that leans by atan(slope) towards x, moving with (v, w).
inline Scene slope(double slope, double mu, const Vec3& v = Vec3::Zero(), const Vec3& w = Vec3::Zero()) {
  Scene scene;
  const Index body = scene.box(2.0, {1.0, 1.0, 0.2}, {0, 0, 0.1});
  const double angle = std::atan(slope);
  scene.problem.bodies[body].v = v + kGravity * kStep * Vec3(std::sin(angle), 0, -std::cos(angle));
  scene.problem.bodies[body].w = w;
  scene.patch(kNone, body, {0, 0, 0}, Vec3::UnitZ(), {0.5, 0, 0}, {0, 0.5, 0}, mu);
  return scene;
}

/// A ball pushed down between two walls that lean by `angle` from upright.
inline Scene wedge(double angle, double mu, double speed) {
  Scene scene;
  const Index body = scene.ball(1.0, 0.5, Vec3::Zero(), {0, 0, -speed});
  for (const double side : {-1.0, 1.0}) {
    const Vec3 n(-side * std::cos(angle), 0, std::sin(angle));
    scene.touch(kNone, body, -0.5 * n, n, mu);
  }
  return scene;
}

/// A box on a grid of side x side points.
inline Scene grid(int side, double mu = 0.5) {
  Scene scene;
  const Index body = scene.box(1.0, Vec3::Ones(), {0, 0, 0.5});
  for (int x = 0; x < side; ++x)
    for (int y = 0; y < side; ++y)
      scene.touch(kNone, body, {x / (side - 1.0) - 0.5, y / (side - 1.0) - 0.5, 0}, Vec3::UnitZ(), mu);
  return scene;
}

/// Painleve's rod: it stands on its lower end at `angle` from the ground and that end slides along x.
inline Scene painleve(double angle, double mu, double speed) {
  Scene scene;
  const Vec3 half(0.5 * std::cos(angle), 0, 0.5 * std::sin(angle));
  const Mat3 R = Eigen::AngleAxisd(-angle, Vec3::UnitY()).toRotationMatrix();
  const Index body = scene.box(1.0, {1.0, 0.02, 0.02}, half, {speed, 0, 0}, Vec3::Zero(), R);
  scene.touch(kNone, body, Vec3::Zero(), Vec3::UnitZ(), mu);
  return scene;
}

/// A wall of bricks, `bricks` of them in the first row; each lies on two halves. Every second row begins and
/// ends with half a brick.
inline Scene wall(int rows, int bricks, double mu = 0.6) {
  Scene scene;
  const double length = 0.4, width = 0.2, height = 0.1;
  const auto below = [&](int row, int half) {  // the brick of a row that covers this half brick
    const int in_row = row % 2 ? (half + 1) / 2 : half / 2;
    const int before = (row / 2) * (2 * bricks + 1) + (row % 2 ? bricks : 0);
    return static_cast<Index>(before + in_row);
  };
  for (int row = 0; row < rows; ++row) {
    for (int half = 0; half < 2 * bricks;) {
      const bool is_short = row % 2 && (half == 0 || half == 2 * bricks - 1);
      const int halves = is_short ? 1 : 2;
      const Index body = scene.box(0.5 * halves, {0.5 * halves * length, width, height},
                                   {0.5 * length * (half + 0.5 * halves), 0, (row + 0.5) * height});
      for (int end = half + halves; half < end; ++half) {
        scene.patch(row == 0 ? kNone : below(row - 1, half), body,
                    {0.5 * length * (half + 0.5), 0, row * height}, Vec3::UnitZ(), {0.25 * length, 0, 0},
                    {0, 0.5 * width, 0}, mu);
      }
    }
  }
  return scene;
}

/// Cards of 1.7 g that lean against each other, on floors of lying cards.
inline Scene cardHouse(int floors, double mu = 0.6) {
  Scene scene;
  const double length = 0.1, width = 0.07, thick = 0.003, lean = 0.35;  // from upright, rad
  const double half_base = 0.5 * length * std::sin(lean), height = length * std::cos(lean);
  std::vector<Index> deck;
  for (int floor = 0; floor < floors; ++floor) {
    const int pairs = floors - floor;
    const double z = floor * (height + thick), x_0 = floor * 2.0 * half_base;
    std::vector<std::array<Index, 2>> leaning;
    for (int k = 0; k < pairs; ++k) {
      const double x = x_0 + 4.0 * half_base * k;
      std::array<Index, 2> cards;
      for (const int side : {-1, 1}) {
        const Mat3 R = Eigen::AngleAxisd(-side * lean, Vec3::UnitY()).toRotationMatrix();
        cards[side > 0] =
            scene.box(0.0017, {thick, width, length}, {x + side * half_base, 0, z + 0.5 * height},
                      Vec3::Zero(), Vec3::Zero(), R);
      }
      leaning.push_back(cards);
      for (const double y : {-0.5 * width, 0.5 * width}) {
        scene.touch(cards[0], cards[1], {x, y, z + height}, Vec3::UnitX(), mu);
        for (const int side : {-1, 1}) {
          const double foot = x + side * 2.0 * half_base;
          Index under = kNone;
          if (floor > 0) under = deck[static_cast<std::size_t>(k)];
          scene.touch(under, cards[side > 0], {foot, y, z}, Vec3::UnitZ(), mu);
        }
      }
    }
    deck.clear();
    // A card lies on each two neighbouring peaks.
    for (int k = 0; k + 1 < pairs; ++k) {
      const double x = x_0 + 4.0 * half_base * k;
      const Index card = scene.box(0.0017, {4.4 * half_base, width, thick},
                                   {x + 2.0 * half_base, 0, z + height + 0.5 * thick});
      for (const double y : {-0.5 * width, 0.5 * width}) {
        scene.touch(leaning[k][1], card, {x, y, z + height}, Vec3::UnitZ(), mu);
        scene.touch(leaning[k + 1][0], card, {x + 4.0 * half_base, y, z + height}, Vec3::UnitZ(), mu);
      }
      deck.push_back(card);
    }
  }
  return scene;
}

/// side^3 boxes thrown together: at jittered places of a grid, with contacts of 1 to 4 points in disturbed
/// directions between neighbours and on the ground.
/// @param ratio of the heaviest mass to the lightest, evenly spread by its logarithm
/// @param speed of each body at random, m/s; 0: at rest
inline Scene rubble(int side, double mu, double ratio, double speed, unsigned seed) {
  Scene scene;
  std::mt19937 random(seed);
  const auto uniform = [&] { return random() / 4294967296.0; };
  const auto direction = [&] {
    Vec3 d;
    do d = Vec3(2 * uniform() - 1, 2 * uniform() - 1, 2 * uniform() - 1);
    while (d.squaredNorm() > 1.0 || d.squaredNorm() < 1e-4);
    return Vec3(d.normalized());
  };
  for (int z = 0; z < side; ++z)
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        const double mass = std::pow(ratio, uniform());
        const Vec3 size(0.6 + 0.6 * uniform(), 0.6 + 0.6 * uniform(), 0.6 + 0.6 * uniform());
        const Mat3 R = Eigen::AngleAxisd(3 * uniform(), direction()).toRotationMatrix();
        const Vec3 v = speed * uniform() * direction(), w = 2 * speed * uniform() * direction();
        scene.box(mass, size, Vec3(x, y, z + 0.5) + 0.15 * uniform() * direction(), v, w, R);
      }
  const auto connect = [&](Index i, Index j, const Vec3& middle, const Vec3& along) {
    const Vec3 n = (along + 0.35 * direction()).normalized();
    const auto [a, b] = tangents(n);
    const int count = 1 + static_cast<int>(4 * uniform());
    for (int k = 0; k < count; ++k)
      scene.touch(i, j, middle + 0.35 * ((2 * uniform() - 1) * a + (2 * uniform() - 1) * b), n, mu);
  };
  const auto at = [&](int x, int y, int z) { return static_cast<Index>((z * side + y) * side + x); };
  for (int z = 0; z < side; ++z)
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        const Index body = at(x, y, z);
        const Vec3 p = scene.p[body];
        if (z == 0) connect(kNone, body, p - Vec3(0, 0, 0.5), Vec3::UnitZ());
        const int next[3][3] = {{x + 1, y, z}, {x, y + 1, z}, {x, y, z + 1}};
        for (const auto& c : next) {
          if (std::max(c[0], std::max(c[1], c[2])) >= side || uniform() < 0.15) continue;
          const Index other = at(c[0], c[1], c[2]);
          connect(body, other, 0.5 * (p + scene.p[other]), (scene.p[other] - p).normalized());
        }
      }
  return scene;
}

/// A torque for each pair: all neighbouring points of the same two sides.
/// @param radius R, m
inline void resistTurning(Scene& scene, double roll, double spin, double radius) {
  const std::vector<CoulombPoint>& points = scene.problem.points;
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (k > 0 && points[k].i == points[k - 1].i && points[k].j == points[k - 1].j) {
      ++scene.problem.torques.back().size;
      continue;
    }
    TorqueConstraint torque;
    torque.i = points[k].i, torque.j = points[k].j;
    torque.first = static_cast<Index>(k), torque.size = 1;
    torque.frame = points[k].frame;
    torque.radius = radius;
    torque.roll = roll, torque.spin = spin;
    scene.problem.torques.push_back(torque);
  }
}

}  // namespace rbs::coulomb_problems
