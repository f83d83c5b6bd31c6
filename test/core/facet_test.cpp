// SPDX-License-Identifier: BSD-3-Clause
// The facet of a hull that faces a direction holds what the hull stands on: its farthest corner, or both ends of its farthest
// edge, by brute force over all corners.
#include "narrowphase/facet.h"
#include "make_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace rbs {
namespace {

std::vector<Vec3> prism(int sides, double half_length) {
  std::vector<Vec3> corners;
  for (int k = 0; k < sides; ++k)
    for (const double y : {-half_length, half_length})
      corners.emplace_back(std::sin(2.0 * kPi * k / sides), y, std::cos(2.0 * kPi * k / sides));
  return corners;
}

// Whether the facet towards d holds the corners that are farthest along it, of which there are one or two.
void expectStandsOnItsFacet(const ConvexHull& hull, const Vec3& d) {
  const Polyhedron& solid = *hull.polyhedron;
  std::vector<std::uint32_t> farthest;
  double reach = -1e300;
  for (const Vec3& vertex : solid.vertices) reach = std::max(reach, vertex.dot(d));
  for (std::uint32_t k = 0; k < solid.vertices.size(); ++k)
    if (solid.vertices[k].dot(d) > reach - 1e-9 * solid.bounding_radius) farthest.push_back(k);
  if (farthest.size() > 2) return;
  const Facet facet = facetTowards(hull, d);
  const auto end = facet.ids.begin() + facet.size;
  for (const std::uint32_t corner : farthest)
    EXPECT_NE(std::find(facet.ids.begin(), end, corner), end)
        << "corner " << corner << " of " << solid.vertices.size() << ", d " << d.transpose();
  for (int k = 0; k < facet.size; ++k) {
    EXPECT_EQ(facet.corners[k], solid.vertices[facet.ids[k]]);
    EXPECT_EQ(std::count(facet.ids.begin(), end, facet.ids[k]), 1);
  }
}

// Directions at random, and those in which an edge is farthest: between the normals of two faces that share it.
void expectStandsOnAllFacets(const ConvexHull& hull, std::mt19937_64& random) {
  std::normal_distribution<> normal;
  std::uniform_real_distribution<> share(0.02, 0.98);
  for (int k = 0; k < 50; ++k)
    expectStandsOnItsFacet(hull, Vec3(normal(random), normal(random), normal(random)).normalized());
  const std::vector<Polyhedron::Face>& faces = hull.polyhedron->faces;
  for (std::size_t a = 0; a < faces.size(); ++a)
    for (std::size_t b = a + 1; b < faces.size(); ++b) {
      const auto isOfBoth = [&](int corner) {
        return std::count(faces[b].corners.begin(), faces[b].corners.end(), corner) > 0;
      };
      if (std::count_if(faces[a].corners.begin(), faces[a].corners.end(), isOfBoth) < 2) continue;
      const double t = share(random);
      expectStandsOnItsFacet(hull, (t * faces[a].normal + (1.0 - t) * faces[b].normal).normalized());
    }
}

TEST(Facet, OfPrismsAndCoinsHoldsWhatTheyStandOn) {
  std::mt19937_64 random(1);
  for (int sides = 3; sides <= 50; ++sides)
    for (const double half_length : {0.05, 0.3, 2.0})
      expectStandsOnAllFacets(makeHull(prism(sides, half_length), "prism").hull, random);
}

TEST(Facet, OfRandomHullsHoldsWhatTheyStandOn) {
  std::mt19937_64 random(2);
  std::normal_distribution<> normal;
  for (int k = 0; k < 40; ++k) {
    std::vector<Vec3> points;
    for (int n = 5 + k; n > 0; --n) points.emplace_back(normal(random), normal(random), 0.3 * normal(random));
    expectStandsOnAllFacets(makeHull(points, "points").hull, random);
  }
}

// A prism of 19 sides whose cap is tilted stands on an edge of the cap, whichever of its sides that is of.
TEST(Facet, APrismInACornerMovesAsFastAsItIsSaidTo) {
  int resting = 0;
  for (const int sides : {12, 17, 19, 24, 40})
    for (const double turn : {0.1, 0.4, 0.9}) {
      SceneDef scene = test::onFloor(1.0 / 60.0, 1.0);
      scene.fidelity = Fidelity::Accurate;
      BodyDef wall = test::body("wall", Plane{}, Vec3(-1.0, 0.0, 0.0));
      wall.pose.q_WB = Quat::FromTwoVectors(Vec3::UnitZ(), Vec3(1.0, 0.2, 0.0));
      wall.kind = BodyKind::Static;
      wall.material.friction = 1.0;
      const PlacedHull hull = makeHull(prism(sides, 0.25), "prism");
      BodyDef coin = test::body("coin", hull.hull, Vec3::Zero());
      coin.pose = hull.poseOfB(
          {Vec3(0.0, 0.0, 1.2), Quat(Eigen::AngleAxisd(turn, Vec3(1.0, 0.3, 0.2).normalized()))});
      coin.twist.v_WB = {-0.5, 0.0, 0.0};
      coin.material.friction = 1.0;
      scene.bodies.push_back(wall);
      scene.bodies.push_back(coin);
      World world(scene);
      test::advance(world, 8.0);
      const BodyState before = test::stateOf(world, "coin");
      test::advance(world, 0.2);
      const BodyState after = test::stateOf(world, "coin");
      const double speed = before.twist.v_WB.norm() + before.twist.w_WB.norm();
      const double moved =
          (after.pose.p_WB - before.pose.p_WB).norm() + after.pose.q_WB.angularDistance(before.pose.q_WB);
      EXPECT_TRUE(speed < 1e-6 || moved > 0.01 * speed)
          << sides << " sides, turned by " << turn << ": " << speed << " m/s, " << moved << " m";
      resting += speed < 1e-6;
    }
  EXPECT_GE(resting, 5);
}

}  // namespace
}  // namespace rbs
