// SPDX-License-Identifier: BSD-3-Clause
// Convex hulls: faces against brute force over all triples of points, mass against quadrature over the
// tetrahedra of another apex and against closed forms, the frame, and what is refused.
#include "rigid_body_sim/file_access.h"
#include "rigid_body_sim/scene.h"
#include "rigid_body_sim/shape.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <set>

namespace rbs {
namespace {

constexpr double kPi = 3.14159265358979323846;
using Points = std::vector<Vec3>;
using LongVec3 = Eigen::Matrix<long double, 3, 1>;
using LongMat3 = Eigen::Matrix<long double, 3, 3>;

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double number() { return std::uniform_real_distribution<double>(-1.0, 1.0)(engine_); }
  int below(int n) { return static_cast<int>(engine_() % static_cast<unsigned>(n)); }
  Vec3 vector() {
    const double x = number(), y = number();
    return Vec3(x, y, number());
  }
  Pose pose(double far) {
    const Vec3 v = vector();
    return {far * vector(), Quat(number(), v.x(), v.y(), v.z()).normalized()};
  }
  Points points(int n, const Vec3& size) {
    Points points;
    for (int i = 0; i < n; ++i) points.push_back(vector().cwiseProduct(size));
    return points;
  }

 private:
  std::mt19937_64 engine_;
};

Points moved(const Pose& pose, Points points) {
  for (Vec3& p : points) p = pose.p_WB + pose.q_WB * p;
  return points;
}

Points boxCorners(const Vec3& size) {
  Points points;
  for (int i = 0; i < 8; ++i) {
    points.push_back(0.5 * size.cwiseProduct(Vec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1)));
  }
  return points;
}

bool isFrameOfPoints(const Pose& X_PB) {
  return X_PB.p_WB.isZero(0.0) && X_PB.q_WB.coeffs() == Quat::Identity().coeffs();
}

bool samePoints(const Points& a, const Points& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec3)) == 0;
}

void expectSameSolid(const Polyhedron& a, const Polyhedron& b) {
  EXPECT_TRUE(samePoints(a.vertices, b.vertices));
  ASSERT_EQ(a.faces.size(), b.faces.size());
  for (std::size_t i = 0; i < a.faces.size(); ++i) {
    EXPECT_EQ(a.faces[i].corners, b.faces[i].corners);
    EXPECT_EQ(a.faces[i].normal, b.faces[i].normal);
    EXPECT_EQ(a.faces[i].offset, b.faces[i].offset);
  }
  EXPECT_EQ(a.neighbours, b.neighbours);
  EXPECT_EQ(a.volume, b.volume);
  EXPECT_EQ(a.area, b.area);
  EXPECT_EQ(a.moments_per_mass, b.moments_per_mass);
  EXPECT_EQ(a.fingerprint, b.fingerprint);
}

/// Every face is a plane polygon with all of the solid behind it, anticlockwise from outside; the edges of
/// the faces are the neighbours; and the corners, edges and faces are those of a ball (Euler).
void expectSoundTopology(const Polyhedron& solid) {
  const Vec3 size = solid.bounds.hi - solid.bounds.lo;
  std::set<std::pair<int, int>> edges;
  for (const Polyhedron::Face& face : solid.faces) {
    ASSERT_GE(face.corners.size(), 3u);
    EXPECT_NEAR(face.normal.norm(), 1.0, 1e-14);
    const double flat = 3e-6 * face.normal.cwiseProduct(size).norm();
    for (const Vec3& v : solid.vertices) EXPECT_LE(face.normal.dot(v), face.offset);
    for (std::size_t k = 0; k < face.corners.size(); ++k) {
      const int from = face.corners[k], to = face.corners[(k + 1) % face.corners.size()];
      EXPECT_GE(face.normal.dot(solid.vertices[from]), face.offset - flat);
      EXPECT_TRUE(edges.emplace(from, to).second) << "an edge of two faces in the same sense";
    }
  }
  std::set<std::pair<int, int>> told;
  for (std::size_t v = 0; v < solid.neighbours.size(); ++v) {
    EXPECT_GE(solid.neighbours[v].size(), 3u);
    for (const int w : solid.neighbours[v]) told.emplace(static_cast<int>(v), w);
  }
  EXPECT_EQ(told, edges);
  for (const auto& [from, to] : edges) EXPECT_TRUE(edges.count({to, from}));
  EXPECT_EQ(solid.vertices.size() + solid.faces.size(), edges.size() / 2 + 2);
}

struct Mass {
  long double volume = 0.0L;
  LongVec3 centre = LongVec3::Zero();
  LongMat3 second = LongMat3::Zero();  // of x x^T about the centre, over the volume
};

// All triples of points with every other point on one side are the faces of points in general position. Over
// the tetrahedron of each with an apex outside, quadrature at four points, exact for quadratics.
Mass bruteForceMass(const Points& points) {
  const LongVec3 origin = points[0].cast<long double>(),
                 apex(0.2L, -0.3L, 0.4L);  // seen from the first point
  const long double near = (5.0L - std::sqrt(5.0L)) / 20.0L, far = 1.0L - 3.0L * near;
  Mass mass;
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = i + 1; j < points.size(); ++j) {
      for (std::size_t k = j + 1; k < points.size(); ++k) {
        const auto seen = [&](std::size_t l) -> LongVec3 { return points[l].cast<long double>() - origin; };
        LongVec3 a = seen(i), b = seen(j);
        const LongVec3 c = seen(k);
        const LongVec3 n = (b - a).cross(c - a);
        bool above = false, below = false;
        for (std::size_t l = 0; l < points.size(); ++l) {
          if (l == i || l == j || l == k) continue;
          (n.dot(seen(l) - a) > 0.0L ? above : below) = true;
        }
        if (above && below) continue;
        if (above) std::swap(a, b);
        const long double volume = (a - apex).dot((b - apex).cross(c - apex)) / 6.0L;
        mass.volume += volume;
        const LongVec3 sum = a + b + c + apex;
        for (const LongVec3& corner : {a, b, c, apex}) {
          const LongVec3 x = near * sum + (far - near) * corner;
          mass.centre += 0.25L * volume * x;
          mass.second += 0.25L * volume * x * x.transpose();
        }
      }
    }
  }
  mass.centre /= mass.volume;
  mass.second = LongMat3(mass.second / mass.volume - mass.centre * mass.centre.transpose());
  mass.centre += origin;
  return mass;
}

TEST(Polyhedron, hullOfABoxIsTheBox) {
  const Vec3 size(0.4, 1.0, 0.7);
  Points points = boxCorners(size);
  Random random(1);
  for (int i = 0; i < 50; ++i) {
    const Vec3 inside = 0.5 * random.vector().cwiseProduct(size);
    points.push_back(inside);
    points.push_back(points[random.below(8)]);  // again
    Vec3 on_face = inside;
    const int axis = random.below(3);
    on_face[axis] = 0.5 * size[axis];
    points.push_back(on_face);
    Vec3 on_edge = on_face;
    on_edge[(axis + 1) % 3] = -0.5 * size[(axis + 1) % 3];
    points.push_back(on_edge);
  }
  const PlacedHull made = makeHull(points, "hull");
  EXPECT_TRUE(isFrameOfPoints(made.X_PB));
  const Shape hull = made.hull, box = Box{size};
  EXPECT_TRUE(samePoints(made.hull.polyhedron->vertices, boxCorners(size)));
  EXPECT_EQ(made.hull.polyhedron->faces.size(), 6u);
  expectSoundTopology(*made.hull.polyhedron);
  EXPECT_DOUBLE_EQ(volume(hull), volume(box));
  EXPECT_DOUBLE_EQ(surfaceArea(hull), surfaceArea(box));
  EXPECT_TRUE(momentsPerMass(hull).isApprox(momentsPerMass(box), 1e-15));
  EXPECT_EQ(fullExtents(hull), size);
  EXPECT_DOUBLE_EQ(boundingRadius(hull), boundingRadius(box));
  EXPECT_DOUBLE_EQ(innerRadius(hull), innerRadius(box));
}

TEST(Polyhedron, regularTetrahedronHasItsClosedForm) {
  Points points{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  const double edge = std::sqrt(8.0);
  for (Vec3& p : points) p += Vec3(3.0, 4.0, -5.0);
  const PlacedHull made = makeHull(points, "hull");
  const Polyhedron& solid = *made.hull.polyhedron;
  EXPECT_TRUE(made.X_PB.p_WB.isApprox(Vec3(3.0, 4.0, -5.0), 1e-15));
  EXPECT_DOUBLE_EQ(solid.volume, edge * edge * edge / (6.0 * std::sqrt(2.0)));
  EXPECT_DOUBLE_EQ(solid.area, std::sqrt(3.0) * edge * edge);
  EXPECT_TRUE(solid.moments_per_mass.isApprox(Vec3::Constant(edge * edge / 20.0), 1e-15));
  EXPECT_DOUBLE_EQ(solid.inner_radius, edge / std::sqrt(24.0));
  EXPECT_DOUBLE_EQ(solid.bounding_radius, std::sqrt(3.0));
}

TEST(Polyhedron, hullOfManyPointsOnABallTendsToTheBall) {
  double error_before = 1.0;
  for (const int n : {60, 240, 960, 3840}) {
    Points points;
    for (int k = 0; k < n; ++k) {  // along a spiral, evenly
      const double z = 1.0 - 2.0 * (k + 0.5) / n, r = std::sqrt(1.0 - z * z), angle = 2.399963229728653 * k;
      points.push_back({r * std::cos(angle), r * std::sin(angle), z});
    }
    const Polyhedron solid = *makeHull(points, "hull").hull.polyhedron;
    EXPECT_EQ(solid.vertices.size(), points.size());
    const double error = 1.0 - solid.volume / (4.0 / 3.0 * kPi);
    EXPECT_GT(error, 0.0);
    EXPECT_NEAR(error / error_before, n == 60 ? error : 0.25, n == 60 ? 0.1 : 0.02);  // it falls like 1/n
    EXPECT_TRUE(solid.moments_per_mass.isApprox(Vec3::Constant(0.4), 1.2 * error));
    error_before = error;
  }
}

TEST(Polyhedron, massMatchesQuadratureOverBruteForceFaces) {
  Random random(2);
  for (int round = 0; round < 60; ++round) {
    const Vec3 size(1.0, std::pow(10.0, random.number() - 1.0), std::pow(10.0, random.number() - 1.0));
    const Points points = moved(random.pose(3.0), random.points(4 + random.below(14), size));
    const Mass truth = bruteForceMass(points);
    const PlacedHull made = makeHull(points, "hull");
    const Polyhedron& solid = *made.hull.polyhedron;
    expectSoundTopology(solid);
    const double volume = static_cast<double>(truth.volume);
    EXPECT_NEAR(solid.volume, volume, 1e-12 * volume) << round;
    EXPECT_TRUE(made.X_PB.p_WB.isApprox(truth.centre.cast<double>(), 1e-14)) << round;
    const LongMat3 R = made.X_PB.q_WB.toRotationMatrix().cast<long double>();
    const Mat3 second_B = (R.transpose() * truth.second * R).cast<double>();
    const Vec3 moments = Vec3::Constant(second_B.trace()) - second_B.diagonal();
    EXPECT_TRUE(solid.moments_per_mass.isApprox(moments, 1e-12)) << round;
    const Mat3 products = second_B - Mat3(second_B.diagonal().asDiagonal());
    EXPECT_LT(products.cwiseAbs().maxCoeff(), 1e-12 * second_B.trace()) << round;
  }
}

TEST(Polyhedron, verticesArePointsThatWereGiven) {
  Random random(3);
  for (int round = 0; round < 50; ++round) {
    const Points points = random.points(30, Vec3(1.0, 0.3, 0.2));
    const PlacedHull made = makeHull(points, "hull");
    for (const Vec3& v : made.hull.polyhedron->vertices) {
      const Vec3 v_P = made.X_PB.p_WB + made.X_PB.q_WB * v;
      const auto apart = [&](const Vec3& a, const Vec3& b) { return (a - v_P).norm() < (b - v_P).norm(); };
      EXPECT_LT((*std::min_element(points.begin(), points.end(), apart) - v_P).norm(), 1e-15);
    }
    // and every point is behind every face
    for (const Vec3& p : points) {
      const Vec3 p_B = made.X_PB.q_WB.conjugate() * (p - made.X_PB.p_WB);
      for (const Polyhedron::Face& face : made.hull.polyhedron->faces) {
        EXPECT_LT(face.normal.dot(p_B) - face.offset, 1e-14);
      }
    }
  }
}

TEST(Polyhedron, farthestVertexIsFoundByClimbingAlongEdges) {
  Random random(4);
  for (int round = 0; round < 30; ++round) {
    const Points points = moved(random.pose(1.0), random.points(60, Vec3(1.0, 0.5, 0.1)));
    const ConvexHull hull = makeHull(points, "hull").hull;
    const Points& vertices = hull.polyhedron->vertices;
    for (int k = 0; k < 50; ++k) {
      const Vec3 d = random.vector();
      int at = random.below(static_cast<int>(vertices.size()));
      for (bool higher = true; higher;) {
        higher = false;
        for (const int v : hull.polyhedron->neighbours[at]) {
          if (d.dot(vertices[v]) > d.dot(vertices[at])) at = v, higher = true;
        }
      }
      EXPECT_EQ(d.dot(vertices[at]), reach(hull, d));
    }
  }
}

TEST(Polyhedron, verticesOfAHullMakeTheSameHullBitForBit) {
  Random random(5);
  for (int round = 0; round < 200; ++round) {
    Points points;
    if (round % 2 == 0) {
      const Vec3 size(1.0, std::pow(10.0, 2.0 * random.number() - 2.0), 0.5);
      points = moved(random.pose(100.0), random.points(4 + random.below(60), size));
    } else {  // many coplanar ones, off their planes by rounding of either precision
      Points lattice = boxCorners(Vec3(2.0, 4.0, 6.0));
      for (int i = 0; i < 40; ++i) {
        lattice.push_back(Vec3(random.below(3) - 1, random.below(5) - 2, random.below(7) - 3));
      }
      points = moved(random.pose(1.0), lattice);
      if (round % 4 == 1) {
        for (Vec3& p : points) p = p.cast<float>().cast<double>();
      }
    }
    const ConvexHull hull = makeHull(points, "hull").hull;
    const PlacedHull again = makeHull(hull.polyhedron->vertices, "hull");
    EXPECT_TRUE(isFrameOfPoints(again.X_PB)) << round;
    expectSameSolid(*again.hull.polyhedron, *hull.polyhedron);
    if (round % 2 == 1) {
      EXPECT_EQ(hull.polyhedron->faces.size(), 6u) << round;
    }
  }
}

TEST(Polyhedron, axesAreNamedAsThoseOfThePointsThatTheyAreNearest) {
  const Points box = boxCorners(Vec3(1.0, 2.0, 3.0));
  for (const double degrees : {20.0, 80.0, 130.0, 200.0}) {
    const Quat turn(Eigen::AngleAxisd(degrees * kPi / 180.0, Vec3::UnitZ()));
    const PlacedHull made = makeHull(moved({Vec3(5, 6, 7), turn}, box), "hull");
    const double turned = Eigen::AngleAxisd(made.X_PB.q_WB.toRotationMatrix()).angle() * 180.0 / kPi;
    EXPECT_NEAR(turned, std::abs(std::remainder(degrees, 90.0)), 1e-6) << degrees;
    const Vec3 size = fullExtents(made.hull);
    EXPECT_TRUE(size.isApprox(std::lround(degrees / 90.0) % 2 == 0 ? Vec3(1, 2, 3) : Vec3(2, 1, 3), 1e-14));
  }
}

TEST(Polyhedron, symmetricSolidKeepsTheAxesOfItsPoints) {
  const Quat turn(Eigen::AngleAxisd(0.5, Vec3(1, 2, 3).normalized()));
  const PlacedHull made = makeHull(moved({Vec3::Zero(), turn}, boxCorners(Vec3::Ones())), "hull");
  EXPECT_EQ(made.X_PB.q_WB.coeffs(), Quat::Identity().coeffs());
  EXPECT_TRUE(made.hull.polyhedron->moments_per_mass.isApprox(Vec3::Constant(1.0 / 6.0), 1e-14));
}

TEST(Polyhedron, facesAreOneUpToAMillionthOfTheExtents) {
  const auto facesWithTop = [](double z) {
    Points points = boxCorners(Vec3(2.0, 2.0, 2.0));
    points.push_back({0.0, 0.0, z});
    return makeHull(points, "hull").hull.polyhedron->faces.size();
  };
  EXPECT_EQ(facesWithTop(1.0 + 0.4e-6), 6u);
  EXPECT_EQ(facesWithTop(1.0 + 1.1e-6), 9u);
  EXPECT_EQ(facesWithTop(1.0 - 0.1), 6u);

  Points prism;
  for (int k = 0; k < 64; ++k) {
    for (const float z : {-1.0f, 1.0f}) {
      const auto x = static_cast<float>(std::cos(k * kPi / 32)),
                 y = static_cast<float>(std::sin(k * kPi / 32));
      prism.push_back(Vec3(x, y, z));
    }
  }
  EXPECT_EQ(makeHull(prism, "hull").hull.polyhedron->faces.size(), 66u);
  const Pose tilted{Vec3::Zero(), Quat(0.9, 0.3, -0.2, 0.1).normalized()};
  Points single = moved(tilted, prism);
  for (Vec3& p : single) p = p.cast<float>().cast<double>();
  EXPECT_EQ(makeHull(single, "hull").hull.polyhedron->faces.size(), 66u);
}

TEST(Polyhedron, aThinPlateIsAHullAndSoIsANeedle) {
  for (const Vec3& size : {Vec3(1.0, 0.7, 2e-6), Vec3(1.0, 2e-6, 3e-6)}) {
    for (const Pose& pose : {Pose{}, Pose{Vec3(0.1, 0.2, 0.3), Quat(0.9, 0.3, -0.2, 0.1).normalized()}}) {
      const Shape hull = makeHull(moved(pose, boxCorners(size)), "hull").hull;
      // A turned plate has the rounding of its length in its thickness.
      EXPECT_TRUE(fullExtents(hull).isApprox(size, 1e-9));
      EXPECT_NEAR(volume(hull) / volume(Box{size}), 1.0, 1e-9);
      EXPECT_EQ(std::get<ConvexHull>(hull).polyhedron->faces.size(), 6u);
    }
  }
}

TEST(Polyhedron, stretchedHullHasTheExtentsThatAreAsked) {
  Random random(6);
  for (int round = 0; round < 20; ++round) {
    const Shape hull = makeHull(moved(random.pose(2.0), random.points(20, Vec3(1.0, 0.5, 0.4))), "hull").hull;
    const Vec3 old = fullExtents(hull), wanted(2.0 * old.x(), 0.0, 0.3 * old.z());
    const Shape other = resized(hull, wanted, "body");
    EXPECT_TRUE(fullExtents(other).isApprox(Vec3(wanted.x(), old.y(), wanted.z()), 1e-15));
    EXPECT_NEAR(volume(other), 0.6 * volume(hull), 1e-14 * volume(hull));
    EXPECT_EQ(std::get<ConvexHull>(other).polyhedron->faces.size(),
              std::get<ConvexHull>(hull).polyhedron->faces.size());
    const Shape large = scaled(hull, 1024.0);  // a power of two: all the same bits
    EXPECT_EQ(volume(large), std::ldexp(volume(hull), 30));
    EXPECT_EQ(momentsPerMass(large), std::ldexp(1.0, 20) * momentsPerMass(hull));
    EXPECT_EQ(innerRadius(large), 1024.0 * innerRadius(hull));
  }
}

struct Refusal {
  const char* what;
  Points points;
  const char* path;
  const char* value;
};

TEST(Polyhedron, pointsOfNoSolidAreRefusedWithTheReason) {
  const double nan = std::nan(""), infinity = std::numeric_limits<double>::infinity();
  Points flat, line, plate = boxCorners(Vec3(1.0, 1.0, 0.5e-6)), ball;
  for (int i = 0; i < 9; ++i) flat.push_back(Vec3(i % 3, i / 3, 0.1 * (i % 3) + 0.2 * (i / 3)));
  for (int i = 0; i < 9; ++i) line.push_back(i * Vec3(0.1, 0.2, 0.3) + Vec3::Ones());
  for (int i = 0; i < 5000; ++i) {
    const double z = 1.0 - 2.0 * (i + 0.5) / 5000, r = std::sqrt(1.0 - z * z);
    ball.push_back({r * std::cos(2.4 * i), r * std::sin(2.4 * i), z});
  }
  const std::vector<Refusal> refusals{
      {"none", {}, "h", "0 points"},
      {"three", {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, "h", "3 points"},
      {"all the same", Points(5, Vec3(1, 2, 3)), "h", "5 points at the same place"},
      {"collinear", line, "h", "points on a line"},
      {"coplanar", flat, "h", "points in a plane"},
      {"thinner than a millionth", plate, "h", "points in a plane"},
      {"not a number", {{0, 0, 0}, {1, nan, 0}, {0, 1, 0}, {0, 0, 1}}, "h[1]", "[1, nan, 0]"},
      {"infinite", {{0, 0, 0}, {1, 0, 0}, {0, infinity, 0}, {0, 0, 1}}, "h[2]", "[0, inf, 0]"},
      {"too far", {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 2e9}}, "h[3]", "[0, 0, 2000000000]"},
      {"too many vertices", ball, "h", "5000 points on the hull"},
  };
  for (const Refusal& refusal : refusals) {
    try {
      makeHull(refusal.points, "h");
      ADD_FAILURE() << refusal.what;
    } catch (const InvalidInput& error) {
      const Problem& problem = error.problems().at(0);
      EXPECT_EQ(problem.path, refusal.path) << refusal.what;
      EXPECT_EQ(problem.value.find(refusal.value), 0u) << refusal.what << ": " << problem.value;
      EXPECT_FALSE(problem.allowed.empty()) << refusal.what;
    }
  }
}

// Many points are taken in parts; their hull is that of all of them.
TEST(Polyhedron, hullOfManyPointsHoldsThemAllAndHasItsVerticesAmongThem) {
  Random random(11);
  Points points = random.points(60'000, Vec3(3.0, 2.0, 1.0));
  for (Vec3& p : points) p = Vec3(0.3, 0.2, 0.1) + p.cwiseProduct(p.cwiseAbs());  // denser in the middle
  const PlacedHull hull = makeHull(points, "h");
  const Polyhedron& solid = *hull.hull.polyhedron;
  const auto inB = [&](const Vec3& p) -> Vec3 { return hull.X_PB.q_WB.conjugate() * (p - hull.X_PB.p_WB); };
  std::vector<char> found(solid.vertices.size(), 0);
  for (const Vec3& p : points) {
    const Vec3 p_B = inB(p);
    for (const Polyhedron::Face& face : solid.faces) ASSERT_LE(face.normal.dot(p_B), face.offset + 1e-5);
    for (std::size_t v = 0; v < solid.vertices.size(); ++v)
      found[v] |= (solid.vertices[v] - p_B).norm() < 1e-12;
  }
  EXPECT_EQ(std::count(found.begin(), found.end(), 1), static_cast<std::ptrdiff_t>(found.size()));
  std::reverse(points.begin(), points.end());
  EXPECT_EQ(makeHull(points, "h").hull.polyhedron->vertices.size(), solid.vertices.size());
  EXPECT_NEAR(makeHull(points, "h").hull.polyhedron->volume, solid.volume, 1e-12 * solid.volume);
}

TEST(Polyhedron, aHullOfManyFlatPointsFirstIsMade) {
  Points points(20'000, Vec3(1, 0, 0));
  for (std::size_t k = 0; k < points.size(); ++k) points[k] = Vec3(k % 2, k % 3, 0);
  points.push_back(Vec3(0, 0, 1));
  EXPECT_NEAR(makeHull(points, "h").hull.polyhedron->volume, 2.0 / 3.0, 1e-12);
}

// Spread over a ball all points are on the hull. That is known after three parts of them, and told then.
TEST(Polyhedron, tooManyVerticesAreToldBeforeAllPointsAreTaken) {
  Random random(12);
  Points ball;
  for (int k = 0; k < 200'000; ++k) ball.push_back(random.vector().normalized());
  int parts = 0;
  interruptReadingBy([&] { return ++parts, false; });
  try {
    makeHull(ball, "h");
    ADD_FAILURE();
  } catch (const InvalidInput& refusal) {
    EXPECT_EQ(refusal.problems().front().value, "more than 16384 points on the hull");
    EXPECT_NE(refusal.problems().front().allowed.find("4096"), std::string::npos);
  }
  EXPECT_LE(parts, 3);
  interruptReadingBy([&] { return ++parts > 4; });
  EXPECT_THROW(makeHull(random.points(60'000, Vec3::Ones()), "h"), InvalidInput);
  interruptReadingBy(nullptr);
}

}  // namespace
}  // namespace rbs
