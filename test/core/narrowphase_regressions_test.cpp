// SPDX-License-Identifier: BSD-3-Clause
// Pairs of shapes that broke other libraries, by the names under which they were reported, with their
// numbers. Each is held against the oracles: sign, distance or depth, normal, both orders. docs/collision.md
// tells what the others did.
#include "core/narrowphase_check.h"

#include <gtest/gtest.h>

namespace rbs {
namespace {

using oracle::hullShape;
using oracle::Pair;

/// A rotation matrix row by row, as it was reported, and a place.
Pose at(const Vec3& p, const std::array<double, 9>& rows) {
  Mat3 R;
  R << rows[0], rows[1], rows[2], rows[3], rows[4], rows[5], rows[6], rows[7], rows[8];
  return {p, Quat(Quat(R).normalized())};
}
Pose at(const Vec3& p, const Quat& q = Quat::Identity()) {
  return {p, Quat(q.normalized())};
}
Quat turned(double degrees, const Vec3& axis) {
  return Quat(Eigen::AngleAxisd(degrees * EIGEN_PI / 180.0, axis));
}
Shape boxMesh(const Vec3& half) {
  std::vector<Vec3> corners;
  for (int k = 0; k < 8; ++k)
    corners.push_back(half.cwiseProduct(Vec3(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1)));
  return hullShape(corners);
}
/// A prism along x: FCL's and Drake's reports have many.
Shape prism(double half_length, const std::vector<std::array<double, 2>>& section) {
  std::vector<Vec3> corners;
  for (const auto& [y, z] : section) {
    corners.emplace_back(half_length, y, z);
    corners.emplace_back(-half_length, y, z);
  }
  return hullShape(corners);
}
/// A hull whose report has its vertices in the world.
Shape wall(const std::vector<std::array<double, 2>>& section) {
  std::vector<Vec3> corners;
  for (const auto& [x, y] : section) {
    corners.emplace_back(x, y, 0.5);
    corners.emplace_back(x, y, -0.5);
  }
  return hullShape(corners);
}

struct Regression {
  const char* name;
  Pair pair;
};

const std::array<double, 9> kQuarter{0, -1, 0, 1, 0, 0, 0, 0, 1};

std::vector<Regression> regressions() {
  const Pose tall = at({0.8, -0.4575, 1.0225}, kQuarter);
  const Box tall_box{{0.025, 0.35, 1.845}};
  return {
      {"FCL 293: NaN for the points on a plate",
       {Box{{2.75, 6, 0.05}}, Box{{0.424, 0.15, 0.1686}}, at({1.625, 0, 0.5}),
        at({0.192074, -0.27787, 0.273546}, Quat(0.672811, 0.340674, 0.155066, 0.638138))}},
      {"FCL 305: an edge in a face, depth by a vector that is not a unit",
       {Box{{1, 1, 1}}, Box{{0.6, 0.8, 1}}, at({0, 0, 0.5}),
        at({-0.9, 0.1, 0.5}, {0.6, -0.8, 0, 0.8, 0.6, 0, 0, 0, 1})}},
      {"FCL 319: expandPolytope should not happen, box and cylinder",
       {Box{{0.05, 0.39, 1.47}}, Cylinder{0.18, 0.09},
        at({0.8, -0.385, 0.735}, Quat(0.707107, 0, 0, 0.707107)),
        at({0.4, -0.4, 0.93}, Quat(0.991445, 0, 0, -0.130526))}},
      {"FCL 319 again, after its first repair",
       {Cylinder{0.05, 0.03}, tall_box,
        at({0.57500009756757608503, -0.42711963046787942977, 1.1867093358746836351},
           {-0.99999999997999022838, 6.2572835802045040178e-10, 6.3260669852976095481e-06,
            6.3260669851683709551e-06, -6.3943303429958554955e-10, 0.99999999997999056145,
            6.2573180158128459924e-10, 1, 6.3942912945996747041e-10}),
        tall}},
      {"FCL 388, 390: origin outside of the polytope, kissing boxes turned by 3e-8",
       {Box{{0.03, 0.12, 0.1}}, tall_box,
        at({0.63499979627350811029, -0.48500002215636439651, 1.0778146458339641356},
           {-3.0627937852578681533e-08, -0.99999999999999888978, -2.8893865161583314238e-08,
            0.9999999999999980016, -3.0627939739957803544e-08, 6.4729926918527511769e-08,
            -6.4729927722963847085e-08, -2.8893863029448751323e-08, 0.99999999999999711342}),
        tall}},
      {"FCL 390, comment 481634606: cylinder and box",
       {Cylinder{0.05, 0.03}, tall_box,
        at({0.87472781461138560122, -0.4038687881347159947, 1.5871328698116491385},
           {-0.97313010759279283679, -0.12202804064972551379, 0.19526123781136842106, 0.20950801135757171623,
            -0.11745920593569325607, 0.97072639199619581429, -0.095520609678929752073, 0.98555187191549953329,
            0.13986894183635001365}),
        tall}},
      {"FCL 391: cylinder and sphere",
       {Cylinder{0.03, 0.325}, Sphere{0.055}, at({0.6, 0, 0.325}),
        at({0.5419794018, -0.0621175025, 0.6016236576})}},
      {"FCL 395: triangle of size zero",
       {Box{{0.46, 0.48, 0.01}}, Box{{0.049521, 0.146, 0.0725}}, at({-0.721, -0.772, 0.81}),
        at({-0.42677133002999478872, -0.76596851247746788882, 0.80746731400091054098},
           {0.10758262492983036718, -0.6624881850015212903, -0.74130653817877356637, 0.22682184885125472595,
            -0.709614040775253474, 0.6670830248314786326, -0.96797615037608542021, -0.23991106241273435495,
            0.07392465377049164954})}},
      {"FCL 398: origin outside of the polytope",
       {Box{{0.614, 3, 0.037}}, Box{{0.494, 0.552, 0.01}}, at({-0.675, 0, 0.9115}), at({-0.692, 0, 0.935})}},
      {"FCL 398, as in its test",
       {Box{{0.614, 3, 0.37}}, Box{{0.494, 0.552, 0.01}}, at({-0.675, 0, 0.9115}), at({-0.692, 0, 0.935})}},
      {"FCL 408: sphere touching an edge of a box",
       {Sphere{0.06}, Box{{0.1, 0.1, 0.1}}, at({1.7855056639081962376e-10, 0.04, 0.33000000000000012657}),
        at({0.05, 0.15, 0.35})}},
      {"FCL 415: point in line with an edge",
       {Box{{0.49, 0.05, 0.21}}, Box{{0.035, 0.12, 0.03}},
        at({-0.44, -0.61499999999858001587, 0.355},
           {4.8966386501092529215e-12, -1, 0, 1, 4.8966386501092529215e-12, 0, 0, 0, 1}),
        at({-0.40653441507331000704, -0.69166166923735727945, 0.43057093858718892276},
           {0.83512153565236335595, -0.55006546945762568868, -9.4542360608233572896e-16,
            0.55006546945762568868, 0.83512153565236313391, 1.1787444236552387666e-15,
            1.2902271444330665572e-16, -1.4878153530113264589e-15, 1})}},
      {"FCL 428: parallel boxes, deep",
       {Box{{0.2, 0.33, 0.1}}, Box{{0.452, 0.27, 0.6}}, at({-0.071, -0.772, 0.8}),
        at({0.121, -0.78769605692727695523, 0.53422044196125151316})}},
      {"FCL 508: unit cubes, 3 apart along y, said to be 3.16",
       {Box{{1, 1, 1}}, Box{{1, 1, 1}}, at({0, 4, 0}), at({0, 0, 0})}},
      {"FCL, sixth of its box regressions: touching, turned by 1e-8",
       {Box{{0.3165, 0.2276, 0.1768}}, Box{{0.4943, 0.3546, 0.0752}},
        at({1.2652949075960071568, 1.4551012423210101243, 0.49480006232932938204},
           {0.44540578475530234748, 0.89532881496493399442, -8.8937407685638678971e-09,
            -0.89532881496493377238, 0.44540578475530190339, -2.8948680226084145336e-08,
            -2.1957263975186326105e-08, 2.0856732016652919226e-08, 0.99999999999999955591}),
        at({1.1304016226141906376, 1.8410802645284281009, 0.44400006232932492933},
           {0.44171122913485860728, 0.8971572827861190591, -1.622764514865468214e-09, -0.8971572827861190591,
            0.44171122913485860728, -5.1621053952306079594e-09, -3.9144271413829990148e-09,
            3.7360349218094348098e-09, 1})}},
      {"Drake 21234: cylinder and plate",
       {Cylinder{0.041, 0.085}, Box{{0.3, 0.6, 0.016}},
        at({0.20238033346825459735, 0.027845683594011010065, 0.3114233939246693339},
           {0.62286449762754547699, 0.71651535568044355529, -0.31407891153229777759, -0.20605566270224237591,
            -0.23703718387333412837, -0.94939688083050233214, -0.75470582445316081177, 0.65606334948423605802,
            4.0172294049188053423e-17}),
        at({0.4, 0, 0.26885})}},
      {"Drake 21673: boxes deep, turned by 8e-4",
       {Box{{0.05, 0.55, 0.3}}, Box{{0.25, 0.2, 0.15}},
        at({0.75000000000000055511, -2.4083553715553102684e-15, 0.15},
           {0.00079632671073326442932, -0.99999968293183538748, 0, 0.99999968293183538748,
            0.00079632671073326442932, 0, 0, 0, 1}),
        at({0.75, 0, 0.15}, {0, 0, 1, -1, 0, 0, 0, -1, 0})}},
      {"Drake 21673, first hulls",
       {prism(0.5, {{0.707107, -0.707107},
                    {0, -1},
                    {1, 0},
                    {-1, 0},
                    {-0.707107, -0.707107},
                    {0, 1},
                    {-0.707107, 0.707107},
                    {0.707107, 0.707107}}),
        wall({{10.294759, 8.932157}, {11.618371, 9.456563}, {11.452373, 8.227672}}),
        at({11.477445682202462862, 9.7785056920756936449, 0},
           {-2.0399676677885372849e-09, 0.77129744817973977522, -0.63647485922966484662,
            2.4720879917217940548e-09, 0.63647485922966484662, 0.77129744817973977522, 1, 0,
            -3.2051032938795742666e-09}),
        at({0, 0, 0})}},
      {"Drake 21673, second hulls",
       {prism(0.5, {{0.5, -0.866025}, {-0.5, -0.866025}, {1, 0}, {-0.5, 0.866025}, {0.5, 0.866025}, {-1, 0}}),
        wall({{4.149402, 8.493709}, {5.188451, 7.476263}, {3.931647, 7.374503}}),
        at({4.2864836941313040342, 7.3869576872253679412, 0},
           {-3.0140487242790098936e-09, 0.34009658459984087875, -0.94039051098122172778,
            1.090044683538143324e-09, 0.94039051098122172778, 0.34009658459984087875, 1, 0,
            -3.2051032938795742666e-09}),
        at({0, 0, 0})}},
      {"Drake 21673, third hulls",
       {prism(0.5, {{1, 0},
                    {0.62349, -0.781831},
                    {-0.222521, -0.974928},
                    {0.62349, 0.781831},
                    {-0.900969, 0.433884},
                    {-0.222521, 0.974928},
                    {-0.900969, -0.433884}}),
        wall({{14.835101, 13.06041}, {13.785037, 12.890524}, {14.767995, 13.150248}}),
        at({13.670417904867957049, 13.169816779836704512, 0},
           {-2.0479437360480804916e-09, -0.76923712747984118732, -0.63896341186844385351,
            -2.4654844510601008403e-09, 0.63896341186844385351, -0.76923712747984118732, 1, 0,
            -3.2051032938795742666e-09}),
        at({0, 0, 0})}},
      {"libccd 25: cubes of 2 at 1.9, said to be apart",
       {Box{{2, 2, 2}}, Box{{2, 2, 2}}, at({0, 0, 0}), at({0, 0, 1.9})}},
      {"libccd 25, along x", {Box{{2, 2, 2}}, Box{{2, 2, 2}}, at({0, 0, 0}), at({1.9, 0, 0})}},
      {"libccd 25, along y", {Box{{2, 2, 2}}, Box{{2, 2, 2}}, at({0, 0, 0}), at({0, 1.9, 0})}},
      {"coal 604: wrong distance of boxes nearly touching",
       {Box{{0.363, 0.277, 0.363}}, Box{{0.363, 0.363, 0.277}},
        at({1.503354966, -0.8531707835, 0.7700092418},
           {0.9999195703, 0.01021849413, 0.007512347878, -0.01021878248, 0.9999477869, -3.329855922e-17,
            -0.007511955635, -7.676704888e-05, 0.9999717819}),
        at({1.48838308, -1.102020834, 0.4497073799},
           {0.9998670967, -0.01297708324, 0.009868343982, 0.01297771517, 0.9999157859, 5.255670031e-17,
            -0.009867512928, 0.0001280685574, 0.9999513067})}},
      {"MuJoCo BoxBoxTouching",
       {Box{{2, 2, 2}}, Box{{2, 2, 2}}, at({0, 0, 1.8599132}), at({0, 2, 1.8599132})}},
      {"MuJoCo BoxBoxDepth", {Box{{5, 5, 5}}, Box{{2, 2, 2}}, at({-1, 0, 0}), at({1.5, 0, 0})}},
      {"MuJoCo BoxBoxDepth2: cube on a plate, turned by 2.6e-4",
       {Box{{10, 10, 0.2}}, Box{{2, 2, 2}}, at({0, 0, 0}),
        at({-0.000171208577507291721461757383, -0.000171208577507290908310128019,
            1.067119586248553853025100579544},
           {0.999999966039443077825410455262, -0.000000033960556969622165789148,
            -0.000260616790777324182967061850, -0.000000033960556972087627235699,
            0.999999966039443077825410455262, -0.000260616790777321797722282382,
            0.000260616790777324182967061850, 0.000260616790777321797722282382,
            0.999999932078886044628518448008})}},
      {"MuJoCo BoxBoxDepth3",
       {Box{{0.5, 0.5, 0.1}}, Box{{0.5, 0.5, 0.1}},
        at({-0.015346499999999199323474918799, -0.023505500000000002086553152481,
            -4.562296442400120888294168253196},
           turned(15, Vec3::UnitZ())),
        at({-0.015346499999999797803074130798, -0.023505499999999998617106200527,
            -4.659230360891631228525966434972},
           turned(30, Vec3::UnitZ()))}},
      {"MuJoCo BoxBoxMultiCCD9: cubes turned by 1e-16",
       {Box{{0.05, 0.05, 0.05}}, Box{{0.05, 0.05, 0.05}},
        at({-0.10714, -0.19286, 0.174995152456491720460718}),
        at({-0.10714, -0.19286, 0.2156259187793853615566774}, Quat(1, 7.8e-17, -3.2e-17, 1.3e-36))}},
      {"MuJoCo LongBox",
       {Box{{2, 2, 0.6}}, boxMesh({0.6, 0.03, 0.03}), at({0, 0, -0.3}),
        at({0, 0, 0.02}, turned(40, Vec3::UnitZ()))}},
      {"MuJoCo SmallBoxMesh: touching but for 1e-9",
       {boxMesh({0.1, 0.1, 0.1}), boxMesh({0.5, 0.5, 0.1}), at({0, 0, 0.1}), at({0, 0, -0.099999999})}},
      {"MuJoCo BoxMesh: prism of five sides on a floor, on its side",
       {Box{{6, 6, 0.02}},
        hullShape({{0.2, 0, -0.05},
                   {0.0618, 0.1902, -0.05},
                   {-0.1618, 0.1176, -0.05},
                   {-0.1618, -0.1176, -0.05},
                   {0.0618, -0.1902, -0.05},
                   {0.2, 0, 0.05},
                   {0.0618, 0.1902, 0.05},
                   {-0.1618, 0.1176, 0.05},
                   {-0.1618, -0.1176, 0.05},
                   {0.0618, -0.1902, 0.05}}),
        at({0, 0, -0.01}), at({0, 0, 0.157}, turned(-90, Vec3::UnitY()))}},
      {"MuJoCo CapsuleCapsule",
       {Capsule{0.15, 0.3}, Capsule{0.1, 0.1}, at({-0.3, 0.2, -0.4}), at({0.3, 0.2, 0.4})}},
      {"MuJoCo BoxBoxLarge: 0.2 on 100",
       {Box{{100, 100, 0.5}}, Box{{0.2, 0.2, 0.2}}, at({0, 0, 0}),
        at({30, 20, 0.349246}, turned(25, Vec3::UnitZ()))}},
      {"Jolt EPATests: concentric spheres", {Sphere{2}, Sphere{2}, at({0, 0, 0}), at({0, 0, 0})}},
      {"Jolt 671: sphere a hair inside a box",
       {Sphere{0.5}, Box{{2, 2, 2}}, at({0, 0, 1 - 1e-9}), at({0, 0, 0})}},
      {"Bullet 889: normal as the gap goes to nothing",
       {Cylinder{0.5, 0.5}, Box{{4, 4, 1}}, at({0.3, 0.2, 1 + 1e-12}), at({0, 0, 0})}},
      {"Bullet 2157: far from the origin",
       {Box{{1, 1, 1}}, Cylinder{0.5, 0.5}, at({1e6, -1e6, 1e6}), at({1e6 + 0.25, -1e6, 1e6 + 1.0})}},
  };
}

TEST(Regressions, ByName) {
  for (const Regression& regression : regressions()) {
    oracle::Worst worst;
    EXPECT_EQ(faultOf(regression.pair, 1e-12, worst), "") << regression.name;
    const double distance =
        gap(regression.pair.a, regression.pair.X_WA, regression.pair.b, regression.pair.X_WB).distance;
    const double size = oracle::sizeOf(regression.pair);
    const Manifold manifold = collide(regression.pair.a, regression.pair.X_WA, regression.pair.b,
                                      regression.pair.X_WB, std::max(distance, 0.0) + 1e-9 * size);
    EXPECT_GT(manifold.size, 0) << regression.name;
  }
}

// FCL 493, 495: identical cubes in a tilted stack, apart or overlapping by about an ulp.
TEST(Regressions, TiltedKissingCubes) {
  Mat3 R;
  R << 0.94096063217417758029, 0.29296840037289501035, 0.16959541586174811667,   //
      -0.23569836841299879326, 0.92661523595848427348, -0.29296840037289506586,  //
      -0.2429801799032638987, 0.23569836841299884878, 0.94096063217417758029;
  for (const double size : {0.01, 0.25, 0.5, 10.0, 1000.0})
    for (const double distance : {-1e-15, -2.5e-16, -1e-16, 0.0, 1e-16, 2.5e-16, 1e-15}) {
      const double scaled = distance * std::max(1.0, size);
      const Pose X_WA = at({0, 0, 5 * size}, Quat(R));
      const Pose X_WB = at(X_WA.p_WB + R * Vec3(0, size + scaled, 0), Quat(R));
      for (const Shape& cube : {Shape(Box{Vec3::Constant(size)}), boxMesh(Vec3::Constant(0.5 * size))}) {
        const Gap found = gap(cube, X_WA, cube, X_WB);
        EXPECT_NEAR(found.distance, scaled, 4e-15 * std::max(1.0, size));
        EXPECT_TRUE(found.n_W.isApprox(R.col(1), 1e-12)) << found.n_W.transpose();
        EXPECT_EQ(collide(cube, X_WA, cube, X_WB, 1e-6 * size).size, 4);
      }
    }
}

// Out of the battery: features nearly parallel, or points equally near, so that the direction hangs on digits
// that the distance does not have.
TEST(Regressions, TiesButForRounding) {
  const Pair pairs[] = {
      {Box{{1, 1, 0.67228910379937368}},
       Box{{1, 1, 1}},
       {{0, 0, 0}, Quat(1, 0, 0, 0)},
       {{0, 0, -0.83619486744613458},
        Quat(1.1795946303795043e-08, 0.70710678118654735, -9.586856359770488e-10, -0.70710678118654735)}},
      {Box{{1, 1, 0.48503189993523999}},
       Box{{0.071871781977999996, 0.0502730002303, 1}},
       {{0, 0, 0}, Quat(1, 0, 0, 0)},
       {{0, 0, 0.27879275501241213},
        Quat(-0.12786874097835521, 0.12786874334249662, -0.69544919543353378, -0.69544919737351873)}},
      {Capsule{0.5, 0.164249264852},
       Box{{0.050135704309056742, 1, 0.00079510929183215968}},
       {{0, 0, 0}, Quat(1, 0, 0, 0)},
       {{0, 0.500397554646, 4.0278728728e-07},
        Quat(-1.0236854349566061e-13, -1.8040206017580787e-15, 0.70710678118661274, -0.70710678118648229)}},
      {Capsule{0.0060353485534527613, 0.5},
       Box{{1, 0.0583355683193, 0.066288787375099995}},
       {{0, 0, 0}, Quat(1, 0, 0, 0)},
       {{0, -0.035203132999999998, -1.7963176e-13},
        Quat(-2.191035096634373e-14, -0.70710678118654757, 8.4653628733600767e-15, 0.70710678118654757)}},
      {Box{{1, 1, 1}},
       Box{{1, 0.9683144752924373, 0.67847313618190164}},
       {{0, 0, 0}, Quat(1, 0, 0, 0)},
       {{0, 1.5, 0},
        Quat(0.50000000002566203, 0.50000000001011291, 0.49999999998811318, -0.49999999997611189)}},
      {Box{{1, 1, 0.00073286}},
       Box{{0.6365658365023863, 0.6365658365023863, 1}},
       {{0, 0, 0}, Quat(1, 0, 0, 0)},
       {{0, 1, 0},
        Quat(-0.66011954546208285, 0.25346042235110933, -0.66011954546275897, 0.25346042235144123)}},
      {Capsule{0.5, 0.5},
       Box{{0.5, 0.5, 1}},
       {{0, 0, 0}, Quat(1, 0, 0, 0)},
       {{0, 1, 0},
        Quat(-0.33143884261758239, -4.0852857342071244e-11, 1.2914954901056228e-11, 0.9434767053850972)}},
      {Capsule{0.5, 0.5},
       Box{{0.25, 1, 0.041000000000000002}},
       {{0, 0, 0}, Quat(1, 0, 0, 0)},
       {{0.52072437199724042, 0, -8.6479782525696829e-10},
        Quat(0.56265948530594012, 0.42826896174632212, -0.56265948530597354, -0.42826896174623608)}},
      {Box{{0.32899, 1, 0.039357000000000003}},
       Box{{0.47861132388332844, 0.47861132388332844, 1}},
       {{0, 0, 0}, Quat(1, 0, 0, 0)},
       {{-0.66432000000000002, 0, -0.25933},
        Quat(0.50028427954701926, -0.4997864995474699, 0.49992646954734316, -0.50000261954727421)}},
      {Capsule{0.16, 0.5},
       Capsule{0.5, 0.5},
       {{0, 0, 0}, Quat(1, 0, 0, 0)},
       {{0, -0.29999999999999999, -3e-10}, Quat(1, 0, 0, 0)}},
      {Capsule{0.02, 0.5},
       Capsule{0.325592564646, 0.5},
       {{0, 0, 0}, Quat(1, 0, 0, 0)},
       {{-0.19233836926055042, 0.28472505127957604, 0},
        Quat(1.9502924636201313e-10, -0.7071067812530476, -0.70710678112004766, 1.0070858416800679e-09)}}};
  oracle::Worst worst;
  for (const Pair& pair : pairs) EXPECT_EQ(faultOf(pair, 1e-12, worst), "") << text(pair);
}

// What meets a round shape along a feature that another one ties with but for rounding: the normal is still
// that of the feature.
TEST(Regressions, RoundFeaturesThatNearlyTie) {
  const std::vector<Pair> pairs{
      // An edge that comes down on a disc by 1e-6 rad and passes over its rim.
      {Capsule{0.00059449364613488429, 0.5},
       Cylinder{0.5, 0.26798887309308406},
       {{0.01720845888452871, -0.068498254806520054, 0.22787875690920179},
        Quat(-0.083430795664438701, -0.82415079965558091, -0.25347184143987339, 0.49956659952297144)},
       {{-0.11739421782760689, 0.16183462624658929, 0.25896296001799657},
        Quat(-0.57683796589487257, -0.74687962979561895, -0.0061591315790443524, -0.33074286809667885)}},
      // Lines on two sides that cross at 3e-8 rad: the product of the orientations keeps too few digits of
      // it.
      {Capsule{0.5, 0.0043402303490230297},
       Cylinder{0.441436179218125, 0.5},
       {{-0.68341965847823405, 1.3144640463774668, 1.2421055925977957},
        Quat(0.49055476267854126, 0.78951012444231794, -0.36639485165012881, -0.042244536933851579)},
       {{-1.3515682040380153, 1.2407795019224768, 1.9012339476073756},
        Quat(0.37674599649260271, 0.2991876689150349, -0.81734825468178451, 0.31700319156851375)}},
      // The end of a segment over the side of a flat cone: the direction in which the search for the rim
      // began
      // ties with that of the side.
      {Capsule{0.33595471523468734, 0.35530160969588692},
       Cone{0.5, 0.06973596932048827},
       {},
       {{0.37199280127463413, -0.18859411679687091, 0.036409426322034442},
        Quat(-0.33405868277166889, -0.39923726546538374, 0.67266804801863711, 0.52586319466509235)}},
  };
  oracle::Worst worst;
  for (const Pair& pair : pairs) EXPECT_EQ(faultOf(pair, 1e-10, worst), "") << text(pair);
}

// The sizes of MuJoCo's box fuzz test, on which its convex collider is off by up to 1 % of the depth.
TEST(Regressions, BoxFuzz) {
  const std::pair<Vec3, Vec3> cases[] = {
      {{0.05, 0.05, 0.05}, {0.05, 0.05, 0.05}},      {{0.05, 0.05, 0.05}, {0.013, 0.013, 0.013}},
      {{0.08, 0.08, 0.004}, {0.06, 0.06, 0.006}},    {{0.002, 0.002, 0.09}, {0.04, 0.04, 0.04}},
      {{0.07, 0.05, 0.003}, {0.0015, 0.0015, 0.06}}, {{0.018, 0.038, 0.047}, {0.026, 0.0014, 0.008}}};
  const std::uint64_t seed = 6;
  oracle::Random random(seed);
  oracle::Worst worst;
  for (const auto& [half_a, half_b] : cases) {
    const double scale = half_a.maxCoeff() + half_b.maxCoeff();
    const Shape mesh_a = boxMesh(half_a), mesh_b = boxMesh(half_b);
    for (int k = 0; k < 500; ++k) {
      Pair pair{Box{2 * half_a}, Box{2 * half_b}, at({0, 0, 0}, random.orientation()),
                at(random.inCube(1.15 * scale), random.orientation())};
      EXPECT_EQ(faultOf(pair, 1e-12, worst), "") << "seed " << seed << ", pair " << k << "\n" << text(pair);
      pair.a = mesh_a, pair.b = mesh_b;
      EXPECT_EQ(faultOf(pair, 1e-10, worst), "") << "seed " << seed << ", pair " << k << "\n" << text(pair);
    }
  }
}

}  // namespace
}  // namespace rbs
