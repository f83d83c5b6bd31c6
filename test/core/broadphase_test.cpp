// Sweep and prune against brute force: all pairs whose boxes and whose intervals along (1,1,1) overlap,
// whatever moves, comes and goes.
#include "broadphase/bounds.h"
#include "broadphase/sweep_and_prune.h"
#include "context.h"
#include "make_scene.h"

#include <gtest/gtest.h>

#include <random>

using namespace rbs;
using namespace rbs::test;

namespace {

// Bodies on their own, as a stage sees them.
class Crowd {
 public:
  explicit Crowd(unsigned seed) : random_(seed) {}

  double number(double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(random_); }
  Vec3 place(double reach) { return {number(-reach, reach), number(-reach, reach), number(-reach, reach)}; }

  BodyDef anyBody(double reach) {
    BodyDef def;
    const int kind = static_cast<int>(number(0.0, 4.0));
    const double size = std::pow(10.0, number(-2.0, 1.0));
    if (kind == 0)
      def.shape = Sphere{size};
    else
      def.shape = Box{Vec3(size, size * number(0.2, 1.0), size * number(0.2, 1.0))};
    def.kind = kind == 3 ? BodyKind::Static : BodyKind::Dynamic;
    def.pose = {place(reach), Quat(Eigen::Quaterniond::UnitRandom())};
    if (def.kind == BodyKind::Dynamic) def.twist = {place(30.0), place(10.0)};
    return def;
  }

  std::mt19937 random_;
};

// How many pairs a step of this world must find.
std::uint32_t bruteForceCount(const World& world) {
  const SceneDef scene = world.capture();
  Bodies bodies;
  std::vector<Load> load;
  for (std::size_t k = 0; k < scene.bodies.size(); ++k) {
    bodies.append(BodyId{k + 1}, scene.bodies[k]);
    load.push_back({});
    if (scene.bodies[k].kind == BodyKind::Dynamic) load.back().a_W = scene.gravity;
  }
  std::uint32_t count = 0;
  for (Index i = 0; i < bodies.size(); ++i) {
    for (Index j = i + 1; j < bodies.size(); ++j) {
      if (!sweep_and_prune::mayCollide(bodies.traits[i], bodies.traits[j])) continue;
      const Interval a = diagonalInterval(bodies, load[i], i, scene.step);
      const Interval b = diagonalInterval(bodies, load[j], j, scene.step);
      if (a.hi < b.lo || b.hi < a.lo) continue;
      count +=
          sweptBounds(bodies, load[i], i, scene.step).overlaps(sweptBounds(bodies, load[j], j, scene.step));
    }
  }
  return count;
}

TEST(SweepAndPrune, FindsThePairsOfBruteForceWhateverMovesComesAndGoes) {
  for (unsigned seed = 1; seed <= 40; ++seed) {
    Crowd crowd(seed);
    SceneDef scene;
    scene.gravity.setZero();
    for (int k = 0; k < 60; ++k) scene.bodies.push_back(crowd.anyBody(6.0));
    World world(scene);
    for (int step = 0; step < 8; ++step) {
      const std::uint32_t expected = bruteForceCount(world);
      EXPECT_EQ(world.step().pairs, expected) << "seed " << seed << ", step " << step;
      const Snapshot now = world.snapshot();
      const BodyId any = now.states[static_cast<std::size_t>(crowd.number(0.0, now.states.size()))].id;
      if (step % 3 == 0) world.removeBody(any);
      if (step % 3 == 1) world.addBody(crowd.anyBody(6.0));
      if (step % 3 == 2) {
        BodyEdit jump;
        jump.pose = Pose{crowd.place(6.0), Quat::Identity()};
        world.editBody(any, jump);
      }
    }
  }
}

// All centres at the same place along (1,1,1): the axis sorts nothing, and nothing may be missed.
TEST(SweepAndPrune, FindsThePairsWhenAllCentresLieInOnePlaneAcrossTheAxis) {
  Crowd crowd(7);
  SceneDef scene;
  scene.gravity.setZero();
  for (int k = 0; k < 80; ++k) {
    const Vec3 p = crowd.place(3.0);
    scene.bodies.push_back(ball("ball_" + std::to_string(k), 0.3, p - Vec3::Constant(p.sum() / 3.0)));
  }
  World world(scene);
  const std::uint32_t expected = bruteForceCount(world);
  EXPECT_GT(expected, 0u);
  EXPECT_EQ(world.step().pairs, expected);
}

TEST(Bounds, HoldTheBodyOverTheWholeStep) {
  for (unsigned seed = 1; seed <= 300; ++seed) {
    Crowd crowd(seed);
    BodyDef def = crowd.anyBody(5.0);
    def.kind = BodyKind::Dynamic;
    def.twist = {crowd.place(20.0), crowd.place(20.0)};
    Bodies bodies;
    bodies.append(BodyId{1}, def);
    Load load;
    load.a_W = crowd.place(100.0);
    const double dt = crowd.number(0.001, 0.1);
    const Aabb bounds = sweptBounds(bodies, load, 0, dt);
    const Interval interval = diagonalInterval(bodies, load, 0, dt);
    for (int k = 0; k <= 20; ++k) {
      const double t = dt * k / 20;
      const Vec3 p = def.pose.p_WB + t * def.twist.v_WB + 0.5 * t * t * load.a_W;
      const Mat3 R = Eigen::AngleAxisd(t * def.twist.w_WB.norm(), def.twist.w_WB.normalized()) *
                     def.pose.q_WB.toRotationMatrix();
      for (int corner = 0; corner < 8; ++corner) {
        const Vec3 sign(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
        Vec3 point = p;
        if (const auto* box = std::get_if<Box>(&def.shape))
          point += R * (0.5 * box->size.cwiseProduct(sign));
        else
          point += std::get<Sphere>(def.shape).radius * sign.normalized();
        EXPECT_TRUE(bounds.contains({point, point})) << seed;
        EXPECT_LE(interval.lo, point.sum() / std::sqrt(3.0)) << seed;
        EXPECT_GE(interval.hi, point.sum() / std::sqrt(3.0)) << seed;
      }
    }
  }
}

}  // namespace
