// Manifolds and gaps of boxes against enumeration in long double, and the pairs that broke other engines.
#include "narrowphase/collide.h"

#include "core/narrowphase_oracles.h"

#include <gtest/gtest.h>

#include <set>

namespace rbs {
namespace {

using oracle::PlacedBox;
using oracle::Random;

Pose at(const Vec3& p, const Quat& q = Quat::Identity()) {
  return {p, q};
}

Quat turned(double angle, const Vec3& axis) {
  return Quat(Eigen::AngleAxisd(angle, axis.normalized()));
}

double toBox(const PlacedBox& box, const Vec3& p) {
  return static_cast<double>(box.distanceTo(p.cast<oracle::Real>()));
}

double deepest(const Manifold& manifold) {
  double least = std::numeric_limits<double>::infinity();
  for (int k = 0; k < manifold.size; ++k) least = std::min(least, manifold.points[k].separation);
  return least;
}

void expectSound(const Manifold& manifold, const Box& a, const Pose& X_WA, const Box& b, const Pose& X_WB,
                 double margin, const std::string& where) {
  const PlacedBox box_a(a, X_WA), box_b(b, X_WB);
  ASSERT_NEAR(manifold.n_W.norm(), 1.0, 1e-13) << where;
  ASSERT_LE(manifold.size, 8) << where;
  std::set<std::uint32_t> features;
  for (int k = 0; k < manifold.size; ++k) {
    const ManifoldPoint& point = manifold.points[k];
    ASSERT_LE(point.separation, margin) << where;
    features.insert(point.feature);
    // The point is midway: half of the gap to each surface along the normal. A corner may overhang by 1e-5,
    // and by the lean of the normal off the reference face, at most 2.6 degrees.
    const Vec3 half = 0.5 * point.separation * manifold.n_W;
    const double overhang = 2e-5 + 0.046 * std::abs(point.separation);
    ASSERT_LE(toBox(box_a, point.p_W - half), overhang) << where;
    ASSERT_LE(toBox(box_b, point.p_W + half), overhang) << where;
  }
  ASSERT_EQ(static_cast<int>(features.size()), manifold.size) << where;
}

TEST(BoxBox, GapMatchesEnumeration) {
  const std::uint64_t seed = 31;
  Random random(seed);
  int apart = 0;
  for (int k = 0; k < 20000; ++k) {
    const Box a = random.box(), b = random.box();
    const Pose X_WA = random.pose(0.5), X_WB = random.pose(0.5);
    const PlacedBox box_a(a, X_WA), box_b(b, X_WB);
    const double truth = static_cast<double>(oracle::boxGap(box_a, box_b));
    const Gap found = gap(a, X_WA, b, X_WB);
    const std::string where = "seed " + std::to_string(seed) + ", pair " + std::to_string(k);
    if (truth > 0.0) ++apart;
    ASSERT_NEAR(found.distance, truth, truth > 0.0 ? 1e-14 + 1e-12 * truth : 1e-12) << where;
    // The normal proves the gap.
    const double along =
        static_cast<double>(oracle::separationAlong(box_a, box_b, found.n_W.cast<oracle::Real>()));
    ASSERT_NEAR(along, truth, 1e-8) << where;
  }
  EXPECT_GT(apart, 5000);
  EXPECT_LT(apart, 15000);
}

TEST(BoxBox, ManifoldsAreSound) {
  const std::uint64_t seed = 32;
  Random random(seed);
  int touching = 0, with_edges = 0;
  for (int k = 0; k < 20000; ++k) {
    const Box a = random.box(), b = random.box();
    const Pose X_WA = random.pose(0.4), X_WB = random.pose(0.4);
    const double margin = random.below(2) == 0 ? 0.0 : 0.1;
    const double truth = static_cast<double>(oracle::boxGap({a, X_WA}, {b, X_WB}));
    const Manifold manifold = collide(a, X_WA, b, X_WB, margin);
    const std::string where = "seed " + std::to_string(seed) + ", pair " + std::to_string(k);
    if (truth > margin + 1e-12) {
      ASSERT_EQ(manifold.size, 0) << where;
      continue;
    }
    if (truth > margin - 1e-12) continue;
    ++touching;
    ASSERT_GT(manifold.size, 0) << where;
    expectSound(manifold, a, X_WA, b, X_WB, margin, where);
    // No point is deeper than the least overlap of the fifteen axes, and the deepest is as deep, up to the
    // lean of the normal.
    if (truth < 0.0) {
      ASSERT_GE(deepest(manifold), truth - 1e-6) << where;  // of a corner that overhangs by 1e-5
      ASSERT_LE(deepest(manifold), truth + 0.046) << where;
    }
    for (int p = 0; p < manifold.size; ++p) with_edges += manifold.points[p].feature >> 31;
  }
  EXPECT_GT(touching, 4000);
  EXPECT_GT(with_edges, 300);
}

TEST(BoxBox, RestsOnFourPoints) {
  const Box cube{Vec3::Ones()};
  for (const double gap : {-0.3, -1e-3, -1e-12, 0.0, 1e-12, 1e-3, 0.009}) {
    for (const Vec3& tilt : {Vec3(0, 0, 0), Vec3(1e-8, 0, 0), Vec3(1e-8, -1e-8, 1e-8), Vec3(0, 0, 1e-6)}) {
      const Quat q = tilt.isZero() ? Quat(Quat::Identity()) : turned(tilt.norm(), tilt);
      const Manifold manifold = collide(cube, Pose(), cube, at({0, 0, 1 + gap}, q), 0.01);
      ASSERT_EQ(manifold.size, 4) << gap << ", " << tilt.transpose();
      EXPECT_NEAR(manifold.n_W.z(), 1.0, 1e-7);
      for (int k = 0; k < 4; ++k) {
        EXPECT_NEAR(manifold.points[k].separation, gap, 2e-8);
        EXPECT_NEAR(manifold.points[k].p_W.cwiseAbs().x(), 0.5, 1e-5);
        EXPECT_NEAR(manifold.points[k].p_W.cwiseAbs().y(), 0.5, 1e-5);
        EXPECT_NEAR(manifold.points[k].p_W.z(), 0.5 + 0.5 * gap, 2e-8);
      }
    }
  }
}

TEST(BoxBox, ClipsToAnOctagon) {
  const Box cube{Vec3::Ones()};
  const Manifold manifold =
      collide(cube, Pose(), cube, at({0, 0, 0.99}, turned(EIGEN_PI / 4, Vec3::UnitZ())), 0.0);
  ASSERT_EQ(manifold.size, 8);
  for (int k = 0; k < 8; ++k) {  // where the sides cross: (1/2, sqrt(1/2) - 1/2)
    const Vec3 p = manifold.points[k].p_W.cwiseAbs();
    EXPECT_NEAR(std::max(p.x(), p.y()), 0.5, 1e-5);
    EXPECT_NEAR(std::min(p.x(), p.y()), std::sqrt(0.5) - 0.5, 2e-5);
    EXPECT_NEAR(manifold.points[k].separation, -0.01, 1e-15);
  }
}

// Crossed edges: two beams turned by 45 degrees about their lengths, one across the other.
TEST(BoxBox, CrossesEdgesInOnePoint) {
  const Box beam{Vec3(4, 1, 1)};
  const double reach = std::sqrt(0.5);
  const Quat lower = turned(EIGEN_PI / 4, Vec3::UnitX());
  const Quat upper = turned(EIGEN_PI / 2, Vec3::UnitZ()) * lower;
  for (const double gap : {-0.01, 0.01}) {
    const Manifold manifold =
        collide(beam, at({0, 0, 0}, lower), beam, at({0.3, 0.2, 2 * reach + gap}, upper), 0.02);
    ASSERT_EQ(manifold.size, 1);
    EXPECT_NEAR(manifold.points[0].separation, gap, 1e-14);
    EXPECT_TRUE(manifold.points[0].p_W.isApprox(Vec3(0.3, 0.0, reach + 0.5 * gap), 1e-13));
    EXPECT_NEAR(manifold.n_W.z(), 1.0, 1e-14);
  }
}

// Corner over corner along the diagonal: no face and no pair of edges spans the gap.
TEST(BoxBox, MeetsCornerToCorner) {
  const Box cube{Vec3::Ones()};
  const Vec3 diagonal = Vec3::Ones().normalized();
  const Manifold manifold = collide(cube, Pose(), cube, at(Vec3::Ones() + 0.01 * diagonal), 0.02);
  ASSERT_EQ(manifold.size, 1);
  EXPECT_NEAR(manifold.points[0].separation, 0.01, 1e-14);
  EXPECT_TRUE(manifold.n_W.isApprox(diagonal, 1e-10));
  EXPECT_EQ(collide(cube, Pose(), cube, at(Vec3::Ones() + 0.03 * diagonal), 0.02).size, 0);
}

// The features stay while a cube on another wavers by less than it takes to lift a corner.
TEST(BoxBox, FeaturesAreStable) {
  const std::uint64_t seed = 33;
  Random random(seed);
  const Box cube{Vec3::Ones()};
  const auto features = [&](const Pose& X_WB) {
    std::set<std::uint32_t> set;
    const Manifold manifold = collide(cube, Pose(), cube, X_WB, 0.01);
    for (int k = 0; k < manifold.size; ++k) set.insert(manifold.points[k].feature);
    return set;
  };
  const std::set<std::uint32_t> first = features(at({0.5, 0.0, 0.999}));
  EXPECT_EQ(first.size(), 4u);
  for (int k = 0; k < 1000; ++k) {
    const Quat q = turned(random.uniform(0, 1e-6), random.direction());
    EXPECT_EQ(features(at(Vec3(0.5, 0.0, 0.999) + random.inCube(1e-6), q)), first)
        << "seed " << seed << ", " << k;
  }
}

// Hard case A49: depth of a small box in a huge one.
TEST(BoxBox, SmallOnHuge) {
  for (const double ratio : {1e3, 1e6}) {
    const Box huge{Vec3(ratio, ratio, 1.0)}, small{Vec3::Ones()};
    const Pose X_WB = at({0.3 * ratio, 0.2 * ratio, 1.0 - 0.000754}, turned(0.4, Vec3::UnitZ()));
    const Manifold manifold = collide(huge, Pose(), small, X_WB, 0.0);
    ASSERT_EQ(manifold.size, 4);
    for (int k = 0; k < 4; ++k) EXPECT_NEAR(manifold.points[k].separation, -0.000754, 0.000754e-9);
  }
}

// FCL issue 493: identical cubes in a tilted stack, apart or overlapping by about an ulp.
TEST(BoxBox, TiltedKissingCubes) {
  Mat3 R;
  R << 0.94096063217417758029, 0.29296840037289501035, 0.16959541586174811667,   //
      -0.23569836841299879326, 0.92661523595848427348, -0.29296840037289506586,  //
      -0.2429801799032638987, 0.23569836841299884878, 0.94096063217417758029;
  for (const double size : {0.01, 0.25, 0.5, 10.0, 1000.0})
    for (const double distance : {-1e-15, -2.5e-16, -1e-16, 0.0, 1e-16, 2.5e-16, 1e-15}) {
      const double scaled = distance * std::max(1.0, size);
      const Box cube{Vec3::Constant(size)};
      const Pose X_WA = at({0, 0, 5 * size}, Quat(R));
      const Pose X_WB = at(X_WA.p_WB + R * Vec3(0, size + scaled, 0), Quat(R));
      const Gap found = gap(cube, X_WA, cube, X_WB);
      EXPECT_NEAR(found.distance, scaled, 4e-15 * std::max(1.0, size));
      EXPECT_TRUE(found.n_W.isApprox(R.col(1), 1e-13));
      EXPECT_EQ(collide(cube, X_WA, cube, X_WB, 1e-6 * size).size, 4);
    }
}

// The pairs of FCL issues 388, 395, 415, 398, 428 and of Drake issue 21673, on which its EPA gave up.
TEST(BoxBox, PairsThatBrokeOthers) {
  struct Case {
    Vec3 size_a;
    Mat3 R_WA;
    Vec3 p_WA, size_b;
    Mat3 R_WB;
    Vec3 p_WB;
  };
  const Mat3 I = Mat3::Identity();
  Mat3 quarter, tilted, spun, round_z, sixth_a, sixth_b, seventh_a, seventh_b;
  quarter << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  tilted << -3.0627937852578681533e-08, -0.99999999999999888978, -2.8893865161583314238e-08,  //
      0.9999999999999980016, -3.0627939739957803544e-08, 6.4729926918527511769e-08,           //
      -6.4729927722963847085e-08, -2.8893863029448751323e-08, 0.99999999999999711342;
  spun << 0.10758262492983036718, -0.6624881850015212903, -0.74130653817877356637,  //
      0.22682184885125472595, -0.709614040775253474, 0.6670830248314786326,         //
      -0.96797615037608542021, -0.23991106241273435495, 0.07392465377049164954;
  round_z << 0.83512153565236335595, -0.55006546945762568868, -9.4542360608233572896e-16,  //
      0.55006546945762568868, 0.83512153565236313391, 1.1787444236552387666e-15,           //
      1.2902271444330665572e-16, -1.4878153530113264589e-15, 1;
  sixth_a << 0.44540578475530234748, 0.89532881496493399442, -8.8937407685638678971e-09,  //
      -0.89532881496493377238, 0.44540578475530190339, -2.8948680226084145336e-08,        //
      -2.1957263975186326105e-08, 2.0856732016652919226e-08, 0.99999999999999955591;
  sixth_b << 0.44171122913485860728, 0.8971572827861190591, -1.622764514865468214e-09,  //
      -0.8971572827861190591, 0.44171122913485860728, -5.1621053952306079594e-09,       //
      -3.9144271413829990148e-09, 3.7360349218094348098e-09, 1;
  seventh_a << 0.00079632671073326442932, -0.99999968293183538748, 0,  //
      0.99999968293183538748, 0.00079632671073326442932, 0, 0, 0, 1;
  seventh_b << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  const Case cases[] = {
      {{0.03, 0.12, 0.1},
       tilted,
       {0.63499979627350811029, -0.48500002215636439651, 1.0778146458339641356},
       {0.025, 0.35, 1.845},
       quarter,
       {0.8, -0.4575, 1.0225}},
      {{0.46, 0.48, 0.01},
       I,
       {-0.721, -0.772, 0.81},
       {0.049521, 0.146, 0.0725},
       spun,
       {-0.42677133002999478872, -0.76596851247746788882, 0.80746731400091054098}},
      {{0.49, 0.05, 0.21},
       quarter,
       {-0.44, -0.61499999999858001587, 0.355},
       {0.035, 0.12, 0.03},
       round_z,
       {-0.40653441507331000704, -0.69166166923735727945, 0.43057093858718892276}},
      {{0.614, 3, 0.37}, I, {-0.675, 0, 0.9115}, {0.494, 0.552, 0.01}, I, {-0.692, 0, 0.935}},
      {{0.614, 3, 0.037}, I, {-0.675, 0, 0.9115}, {0.494, 0.552, 0.01}, I, {-0.692, 0, 0.935}},
      {{0.2, 0.33, 0.1},
       I,
       {-0.071, -0.772, 0.8},
       {0.452, 0.27, 0.6},
       I,
       {0.121, -0.78769605692727695523, 0.53422044196125151316}},
      {{0.3165, 0.2276, 0.1768},
       sixth_a,
       {1.2652949075960071568, 1.4551012423210101243, 0.49480006232932938204},
       {0.4943, 0.3546, 0.0752},
       sixth_b,
       {1.1304016226141906376, 1.8410802645284281009, 0.44400006232932492933}},
      {{0.05, 0.55, 0.3}, seventh_a, {0.75, 0, 0.15}, {0.25, 0.2, 0.15}, seventh_b, {0.75, 0, 0.15}},
  };
  int number = 0;
  for (const Case& c : cases) {
    const std::string where = "case " + std::to_string(number++);
    const Box a{c.size_a}, b{c.size_b};
    const Pose X_WA = at(c.p_WA, Quat(c.R_WA).normalized()), X_WB = at(c.p_WB, Quat(c.R_WB).normalized());
    const double truth = static_cast<double>(oracle::boxGap({a, X_WA}, {b, X_WB}));
    EXPECT_NEAR(gap(a, X_WA, b, X_WB).distance, truth, 1e-14 + 1e-12 * std::abs(truth)) << where;
    const Manifold manifold = collide(a, X_WA, b, X_WB, std::max(truth, 0.0) + 1e-9);
    EXPECT_GT(manifold.size, 0) << where;
    expectSound(manifold, a, X_WA, b, X_WB, std::max(truth, 0.0) + 1e-9, where);
  }
}

}  // namespace
}  // namespace rbs
