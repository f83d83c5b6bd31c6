// SPDX-License-Identifier: BSD-3-Clause
// The broad phase against brute force: all pairs whose bounds overlap, whatever moves, grows, comes and goes.
#include "broadphase/bounds.h"
#include "broadphase/bounds_tree.h"
#include "broadphase/broad_phase.h"
#include "core/narrowphase_oracles.h"
#include "make_scene.h"
#include "rigid_body_sim/scenes.h"
#include "step/analyse_scene.h"

#include <gtest/gtest.h>

#include <numeric>
#include <set>

using namespace rbs;
using namespace rbs::test;
using rbs::oracle::Random;

namespace {

constexpr double kReach = 4.0;  // of the places of bodies, m

// Of all kinds and sizes: mostly of 0.1 to 1 m, some tiny, some huge.
Shape anyShape(Random& random) {
  const double size = random.below(8) == 0 ? std::pow(10.0, random.uniform(-3, 2)) : random.uniform(0.1, 1.0);
  const double part = size * random.uniform(0.2, 1.0);
  switch (random.below(6)) {
    case 0:
    case 1:
      return Sphere{0.5 * size};
    case 2:
      return Capsule{0.5 * part, size};
    case 3:
      return Cylinder{0.5 * size, part};
    case 4:
      return Cone{0.5 * part, size};
    default:
      return Box{{size, part, size * random.uniform(0.2, 1.0)}};
  }
}

BodyDef anyBody(Random& random) {
  BodyDef def;
  const int kind = random.below(8);
  def.kind = kind == 0 ? BodyKind::Static : kind == 1 ? BodyKind::Kinematic : BodyKind::Dynamic;
  def.shape = anyShape(random);
  def.pose = random.pose(kReach);
  def.group = 1u << random.below(2);
  if (random.below(4) == 0) def.mask = static_cast<std::uint32_t>(random.below(4));
  if (def.kind != BodyKind::Static)
    def.twist = {random.inCube(random.below(5) == 0 ? 100.0 : 3.0), random.inCube(10.0)};
  else if (random.below(3) == 0)
    def.shape = Plane{};
  return def;
}

using Pairs = std::set<std::pair<Index, Index>>;

// What a step of these bodies must find. A plane's pairs are those with bounds that reach below it.
Pairs bruteForce(const Bodies& bodies, const std::vector<Load>& load, double step) {
  Pairs pairs;
  std::vector<Bounds> bounds;
  for (Index i = 0; i < bodies.size(); ++i) bounds.push_back(sweptBounds(bodies, load[i], i, step));
  const auto reachesBelow = [&](Index i, Index plane) {
    const Vec3 n = bodies.R_WB(plane).col(2);
    double lowest = 0.0;
    for (int k = 0; k < 3; ++k) lowest += n[k] * (n[k] > 0.0 ? bounds[i].lo[k] : bounds[i].hi[k]);
    return lowest <= n.dot(bodies.pose[plane].p_WB);
  };
  for (Index i = 0; i < bodies.size(); ++i) {
    for (Index j = i + 1; j < bodies.size(); ++j) {
      const Traits &a = bodies.traits[i], &b = bodies.traits[j];
      const bool moves = a.kind == BodyKind::Dynamic || b.kind == BodyKind::Dynamic;
      if (!moves || !(a.group & b.mask) || !(b.group & a.mask)) continue;
      bool overlap = true;
      if (std::holds_alternative<Plane>(a.shape))
        overlap = reachesBelow(j, i);
      else if (std::holds_alternative<Plane>(b.shape))
        overlap = reachesBelow(i, j);
      else
        for (int k = 0; k < 4; ++k)
          overlap &= bounds[i].lo[k] <= bounds[j].hi[k] && bounds[j].lo[k] <= bounds[i].hi[k];
      if (overlap) pairs.insert({i, j});
    }
  }
  return pairs;
}

// --- worlds, by the edits that everyone can make

// A world and its edits follow from the seed, body by body, so that bodies can be left out of it.
struct Case {
  std::uint64_t seed;
  std::vector<int> bodies;
  int rounds;

  std::string text() const {
    std::string list;
    for (const int k : bodies) list += ' ' + std::to_string(k);
    return "seed " + std::to_string(seed) + ", bodies" + list + ", rounds " + std::to_string(rounds);
  }
};

Random chance(const Case& c, int round, int body) {
  return Random(c.seed * 1000003u + static_cast<std::uint64_t>(round) * 1009u +
                static_cast<std::uint64_t>(body));
}

std::string nameOf(int body) {
  return "body_" + std::to_string(body);
}

void edit(World& world, const Case& c, int round, int body) {
  Random random = chance(c, round, body);
  const BodyId id = world.find(nameOf(body));
  const Snapshot now = world.snapshot();
  const BodyDescription& description = (*now.bodies)[now.find(id)];
  BodyEdit edit;
  switch (random.below(10)) {
    case 0:
      edit.pose = random.pose(kReach);
      break;
    case 1:
      if (std::holds_alternative<Plane>(description.shape)) return;
      edit.shape = anyShape(random);
      break;
    case 2:
      world.removeBody(id);
      return;
    case 3:
      world.addBody(anyBody(random));
      return;
    default:
      return;
  }
  world.editBody(id, edit);
}

std::size_t expectedPairs(const SceneDef& scene) {
  Bodies bodies;
  std::vector<Load> load(scene.bodies.size());
  for (std::size_t k = 0; k < scene.bodies.size(); ++k) {
    bodies.append(BodyId{k + 1}, scene.bodies[k]);
    if (scene.bodies[k].kind == BodyKind::Dynamic) load[k].a_W = scene.gravity;
  }
  return bruteForce(bodies, load, scene.step).size();
}

// What goes wrong; empty if nothing does.
std::string faultOf(const Case& c) {
  SceneDef scene;
  scene.fidelity = Fidelity::Preview;  // which pairs are found does not depend on it
  for (const int k : c.bodies) {
    Random random = chance(c, 0, k);
    scene.bodies.push_back(anyBody(random));
    scene.bodies.back().name = nameOf(k);
  }
  World world(scene);
  for (int round = 1; round <= c.rounds; ++round) {
    const SceneDef before = world.capture();
    const std::size_t expected = expectedPairs(before);
    const std::size_t found = world.step().pairs;
    if (found != expected)
      return "round " + std::to_string(round) + ": " + std::to_string(found) + " pairs, not " +
             std::to_string(expected) + ", in\n" + writeScene(before);
    for (const int k : c.bodies)
      if (world.find(nameOf(k))) edit(world, c, round, k);
  }
  return "";
}

// The same fault with as few bodies as can be.
Case shrunk(Case c) {
  for (std::size_t k = 0; k < c.bodies.size();) {
    Case smaller = c;
    smaller.bodies.erase(smaller.bodies.begin() + static_cast<std::ptrdiff_t>(k));
    if (faultOf(smaller).empty())
      ++k;
    else
      c = std::move(smaller);
  }
  return c;
}

TEST(BroadPhase, FindsThePairsOfBruteForceInRandomWorlds) {
  for (std::uint64_t seed = 1; seed <= 3000; ++seed) {
    Case c{seed, std::vector<int>(3 + seed % 18), 3};
    std::iota(c.bodies.begin(), c.bodies.end(), 0);
    if (faultOf(c).empty()) continue;
    const Case small = shrunk(c);
    FAIL() << small.text() << ", " << faultOf(small);
  }
}

// --- the stage alone

// Bodies as the stage sees them, without anything else happening to them.
struct Crowd {
  SceneStore scene;
  StepStore step;
  SceneAnalysis analysis;

  void add(const BodyDef& def) { scene.bodies.append(BodyId{scene.bodies.size() + 1}, def); }
  void admit() {
    analysis = analyseScene(scene);
    scene.pair_search = {};
    scene.pair_search.order = scene.lists.collidable;
  }
  std::uint64_t run() {
    step.begin(scene, 0.0, 0.01);
    Context context{scene, step, analysis};
    broad_phase::findPairs(context);
    return step.report.overlap_tests;
  }
  Pairs pairs() const {
    Pairs found;
    for (const Contact& contact : scene.contacts.active)
      EXPECT_TRUE(found.insert({contact.i, contact.j}).second);
    return found;
  }
  Pairs expected() const { return bruteForce(scene.bodies, step.load, step.h()); }
};

TEST(BroadPhase, FindsEachPairOnceAndNoOther) {
  const std::uint64_t seed = 81;
  Random random(seed);
  for (int k = 0; k < 100; ++k) {
    Crowd crowd;
    for (int i = 0; i < 120; ++i) crowd.add(anyBody(random));
    crowd.admit();
    for (int round = 0; round < 5; ++round) {
      crowd.run();
      ASSERT_EQ(crowd.pairs(), crowd.expected()) << "seed " << seed << ", crowd " << k << ", round " << round;
      for (int jumps = 0; jumps < (round == 3 ? 120 : 12); ++jumps)
        crowd.scene.bodies.pose[static_cast<std::size_t>(random.below(120))] = random.pose(kReach);
    }
  }
}

// A body that comes or goes does not make it choose its search anew, and finds its pairs all the same.
TEST(BroadPhase, KeepsItsSearchWhereFewBodiesComeAndGo) {
  const std::uint64_t seed = 89;
  Random random(seed);
  SceneDef scene;
  for (int k = 0; k < 4000; ++k) scene.bodies.push_back(ball(nameOf(k), 0.15, random.inCube(6.0)));
  World world(scene);
  for (int round = 0; round < 12; ++round) {
    for (int k = 0; k < 20; ++k) world.addBody(ball("", 0.2, random.inCube(6.0)));
    for (int k = 0; k < 20; ++k) world.removeBody(world.find(nameOf(20 * round + k)));
    const std::size_t expected = expectedPairs(world.capture());
    ASSERT_EQ(world.step().pairs, expected) << "seed " << seed << ", round " << round;
  }
}

// Balls as dense as in a heap one ball deep, with their centres in the plane n.p = 0.
void spreadOut(Crowd& crowd, const Vec3& n, Random& random) {
  const double reach = 0.5 * std::sqrt(static_cast<double>(crowd.scene.bodies.size()));
  for (Pose& pose : crowd.scene.bodies.pose) {
    const Vec3 p = random.inCube(reach);
    pose.p_WB = p - n * (n.dot(p) / n.squaredNorm());
  }
}

// Where no axis is at fault, n^1.5 tests find the pairs of a layer; an axis across the layer takes n²/2.
TEST(BroadPhase, NoPlaneOfCentresMakesItTestAllPairs) {
  const std::size_t n = 1000;
  Random random(82);
  Crowd crowd;
  for (std::size_t k = 0; k < n; ++k) crowd.add(ball("", 0.15, Vec3::Zero()));
  crowd.admit();
  for (const Vec3& normal :
       {Vec3(1, 1, 1), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(1, -1, 0), Vec3(1, 1, 1)}) {
    spreadOut(crowd, normal, random);
    crowd.run();  // notices
    const std::uint64_t tests = crowd.run();
    EXPECT_LT(tests, 40 * n) << normal.transpose();
    EXPECT_EQ(crowd.pairs(), crowd.expected()) << normal.transpose();
    EXPECT_FALSE(crowd.pairs().empty());
  }
}

// Its groups are of neighbours, whatever the order of creation.
TEST(BroadPhase, TheTreeTestsFewGroups) {
  const std::size_t n = 4000;
  Random random(83);
  Crowd crowd;
  for (std::size_t k = 0; k < n; ++k) crowd.add(ball("", 0.15, random.inCube(6.0)));
  crowd.admit();
  crowd.run();  // notices
  EXPECT_LT(crowd.run(), 60 * n);
  EXPECT_EQ(crowd.pairs(), crowd.expected());
}

// --- the tree alone

// Bounds of all sizes, some of which are points or lines, in a box of any shape: a cube, a plate or a rod.
std::vector<Bounds> anyBounds(Random& random, Index n) {
  const Bounds::Array4 room(random.uniform(0, 2), random.uniform(0, 2), random.uniform(0, 2), 2.0);
  const double size = std::pow(10.0, random.uniform(-2, 0.5));
  std::vector<Bounds> bounds(n);
  for (Bounds& own : bounds) {
    const double most = random.below(10) == 0 ? 4.0 : size;
    own.lo = room * Bounds::Array4::NullaryExpr([&] { return random.uniform(-1, 1); });
    own.hi =
        own.lo + Bounds::Array4::NullaryExpr([&] { return std::max(random.uniform(-0.2, 1) * most, 0.0); });
  }
  return bounds;
}

bool areNear(const Bounds& a, const Bounds& b) {
  return (a.lo <= b.hi).all() && (b.lo <= a.hi).all();
}

// In any order of the bodies, since only the speed may depend on it.
std::vector<Index> anyOrder(Random& random, const std::vector<Bounds>& bounds) {
  std::vector<Index> order(bounds.size());
  std::iota(order.begin(), order.end(), 0u);
  if (random.below(4) > 0) sortByPlace(order, bounds);
  return order;
}

TEST(BoundsTree, FindsThePairsOfBruteForce) {
  const std::uint64_t seed = 85;
  Random random(seed);
  Workers workers;
  for (int k = 0; k < 1500; ++k) {
    const Index n = static_cast<Index>(random.below(k % 50 == 0 ? 700 : 150));
    const std::vector<Bounds> bounds = anyBounds(random, n);
    std::vector<Traits> traits(n);
    for (Traits& t : traits) {
      t.kind = random.below(3) == 0 ? BodyKind::Static : BodyKind::Dynamic;
      t.group = 1u << random.below(2);
      if (random.below(4) == 0) t.mask = static_cast<std::uint32_t>(random.below(4));
    }
    const std::vector<Index> order = anyOrder(random, bounds);
    IndexPairs found, expected;
    const std::uint64_t tests = BoundsTree(order, bounds).findPairs(traits, workers, found);
    for (Index i = 0; i < n; ++i)
      for (Index j = i + 1; j < n; ++j)
        if (areNear(bounds[i], bounds[j]) && mayCollide(traits[i], traits[j])) expected.emplace_back(i, j);
    std::sort(found.begin(), found.end());
    ASSERT_EQ(found, expected) << "seed " << seed << ", crowd " << k;
    ASSERT_GE(tests, expected.size());
  }
}

TEST(BoundsTree, FindsTheNeighboursOfBodiesThatAreMoved) {
  const std::uint64_t seed = 83;
  Random random(seed);
  for (int k = 0; k < 200; ++k) {
    const Index n = 1 + static_cast<Index>(random.below(k % 10 == 0 ? 700 : 100));
    std::vector<Bounds> bounds = anyBounds(random, n);
    const std::vector<Index> order = anyOrder(random, bounds);
    BoundsTree tree(order, bounds);
    for (int move = 0; move < 20; ++move) {
      const auto i = static_cast<Index>(random.below(static_cast<int>(n)));
      bounds[i] = anyBounds(random, 1).front();
      tree.move(i, bounds[i]);
      std::vector<Index> expected;
      for (Index j = 0; j < n; ++j)
        if (j != i && areNear(bounds[j], bounds[i])) expected.push_back(j);
      ASSERT_EQ(tree.of(i), expected) << "seed " << seed << ", crowd " << k << ", move " << move;
    }
  }
}

TEST(BoundsTree, SortsAnyBodiesAndLosesNone) {
  Random random(86);
  for (Index n = 0; n < 300; ++n) {
    const std::vector<Bounds> bounds = anyBounds(random, n);
    std::vector<Index> order(n), all(n);
    std::iota(order.begin(), order.end(), 0u);
    all = order;
    sortByPlace(order, bounds);
    std::sort(order.begin(), order.end());
    EXPECT_EQ(order, all);
  }
}

// A gas, a heap on the ground, a wall, and towers far apart: a body has as many neighbours however many there are.
std::uint64_t testsOfABody(Index n, const Vec3& room, Random& random) {
  const double scale = std::cbrt(n / room.prod());
  std::vector<Bounds> bounds(n);
  for (Bounds& own : bounds) {
    const Vec3 p =
        scale * room.cwiseProduct(Vec3(random.uniform(0, 1), random.uniform(0, 1), random.uniform(0, 1)));
    own.lo << p, p.sum() / std::sqrt(3.0);
    own.hi = own.lo + 0.7;
  }
  std::vector<Index> order(n);
  std::iota(order.begin(), order.end(), 0u);
  sortByPlace(order, bounds);
  Workers workers;
  IndexPairs found;
  return BoundsTree(order, bounds).findPairs(std::vector<Traits>(n), workers, found) / n;
}

TEST(BoundsTree, TakesHardlyMoreTestsOfABodyInALargeScene) {
  Random random(87);
  for (const Vec3& room : {Vec3(1, 1, 1), Vec3(1, 1, 0.1), Vec3(1, 0.01, 1)}) {
    const std::uint64_t few = testsOfABody(1000, room, random), many = testsOfABody(64000, room, random);
    EXPECT_LT(many, 2 * few) << room.transpose();
    EXPECT_LT(many, 150u) << room.transpose();
  }
}

// --- the choice between the two

TEST(BroadPhase, TakesTheTreeWhereASweepTestsManyOfABodyAndSaysSo) {
  Random random(88);
  const auto howOf = [&](int n) {
    Crowd crowd;
    for (int k = 0; k < n; ++k) crowd.add(ball("", 0.15, random.inCube(0.5 * std::cbrt(n))));
    crowd.admit();
    EXPECT_EQ(broad_phase::describe(crowd.scene), "");
    crowd.run();
    EXPECT_EQ(crowd.pairs(), crowd.expected()) << n;
    return broad_phase::describe(crowd.scene);
  };
  EXPECT_NE(howOf(100).find("by a sweep along (1, 1, 1): "), std::string::npos);
  EXPECT_NE(howOf(6000).find("by a tree of bounds: a sweep along "), std::string::npos);
}

// --- bounds

TEST(Bounds, HoldTheBodyOverTheWholeStep) {
  const std::uint64_t seed = 84;
  Random random(seed);
  for (int k = 0; k < 3000; ++k) {
    BodyDef def;
    def.shape = anyShape(random);
    def.pose = random.pose(5.0);
    def.twist = {random.inCube(20.0), random.inCube(20.0)};
    Bodies bodies;
    bodies.append(BodyId{1}, def);
    Load load;
    load.a_W = random.inCube(100.0);
    const double dt = random.uniform(0.001, 0.1);
    const Bounds bounds = sweptBounds(bodies, load, 0, dt);
    for (int part = 0; part <= 20; ++part) {
      const double t = dt * part / 20;
      const Vec3 p = def.pose.p_WB + t * def.twist.v_WB + 0.5 * t * t * load.a_W;
      const Mat3 R = Eigen::AngleAxisd(t * def.twist.w_WB.norm(), def.twist.w_WB.normalized()) *
                     def.pose.q_WB.toRotationMatrix();
      for (int direction = 0; direction < 8; ++direction) {
        const Vec3 d = direction < 4 ? (direction < 3 ? Vec3(Vec3::Unit(direction)) : Vec3(Vec3::Ones()))
                                     : random.direction();
        for (const Vec3& towards : {d, Vec3(-d)}) {
          const Vec3 point = p + R * supportPoint(def.shape, R.transpose() * towards);
          for (int axis = 0; axis < 4; ++axis) {
            const double along = axis < 3 ? point[axis] : point.sum() / std::sqrt(3.0);
            ASSERT_LE(bounds.lo[axis], along) << "seed " << seed << ", body " << k << ", axis " << axis;
            ASSERT_GE(bounds.hi[axis], along) << "seed " << seed << ", body " << k << ", axis " << axis;
          }
        }
      }
    }
  }
}

}  // namespace
