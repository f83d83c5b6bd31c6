// SPDX-License-Identifier: BSD-3-Clause
// The time of a step beside Bullet's, on the same scenes in the same run: turn by turn, in stretches of
// steps, so that a noisy machine is noisy for all. Also how many contact points there are, how deep bodies
// overlap at the end of the stretches, found by our narrow phase on the poses of either engine, and how far
// the highest body has sunk: time without error says little.
//
// Usage: beside_bullet_benchmark [NAME]     NAME: only the scenes whose names begin so
#include "narrowphase/collide.h"
#include "rigid_body_sim/scenes.h"

#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <random>
#include <string>
#include <vector>

namespace {

using namespace rbs;

constexpr int kStretch = 20;

/// So many steps in a row that are summed up together. Before the first of them each body that moves may be
/// given a velocity, to the side and up, m/s.
struct Phase {
  std::string name;
  int steps;
  double kick = 0.0;
};

struct Race {
  std::string name;
  SceneDef scene;
  std::vector<Phase> phases;
};

/// One engine with one scene.
class Contestant {
 public:
  explicit Contestant(std::string name) : name(std::move(name)) {}
  virtual ~Contestant() = default;
  virtual void step() = 0;
  virtual void kick(double speed) = 0;
  virtual std::vector<Pose> poses() const = 0;  ///< in the order of the scene
  virtual std::size_t contacts() const = 0;     ///< points

  const std::string name;
  std::vector<double> seconds;  ///< of each step of the phase
  double deepest = 0.0;         ///< in the phase, m
};

Vec3 kicked(double speed) {
  return speed * Vec3(0.5, 0.5, 1.0);
}

class Ours : public Contestant {
 public:
  explicit Ours(const SceneDef& scene) : Contestant("rigid_body_sim, interactive"), world_(scene) {}
  void step() override { world_.step(); }
  void kick(double speed) override {
    BodyEdit edit;
    edit.twist = Twist{kicked(speed), Vec3::Zero()};
    const Snapshot now = world_.snapshot();
    for (const BodyDescription& body : *now.bodies)
      if (body.kind == BodyKind::Dynamic) world_.editBody(body.id, edit);
  }
  std::size_t contacts() const override { return world_.snapshot().contacts.size(); }
  std::vector<Pose> poses() const override {
    std::vector<Pose> poses;
    for (const BodyState& state : world_.snapshot().states) poses.push_back(state.pose);
    return poses;
  }

 private:
  World world_;
};

btVector3 toBullet(const Vec3& v) {
  return btVector3(btScalar(v.x()), btScalar(v.y()), btScalar(v.z()));
}

/// Bullet's discrete dynamics world with its own defaults, its step cut into so many.
class Bullet : public Contestant {
 public:
  Bullet(const SceneDef& scene, int cuts)
      : Contestant("Bullet, step of 1/" + std::to_string(std::lround(cuts / scene.step)) + " s"),
        step_(scene.step / cuts),
        cuts_(cuts),
        dispatcher_(&configuration_),
        world_(&dispatcher_, &broadphase_, &solver_, &configuration_) {
    world_.setGravity(toBullet(scene.gravity));
    for (const BodyDef& def : scene.bodies) add(def);
  }
  ~Bullet() override {
    for (const auto& body : bodies_) world_.removeRigidBody(body.get());
  }

  void step() override {
    for (int k = 0; k < cuts_; ++k) world_.stepSimulation(btScalar(step_), 0);
  }
  void kick(double speed) override {
    for (const auto& body : bodies_) {
      if (body->isStaticObject()) continue;
      body->setLinearVelocity(toBullet(kicked(speed)));
      body->setAngularVelocity(btVector3(0, 0, 0));
    }
  }
  std::size_t contacts() const override {
    std::size_t points = 0;
    btDispatcher* dispatcher = const_cast<btCollisionDispatcher*>(&dispatcher_);
    for (int k = 0; k < dispatcher->getNumManifolds(); ++k)
      points += static_cast<std::size_t>(dispatcher->getManifoldByIndexInternal(k)->getNumContacts());
    return points;
  }
  std::vector<Pose> poses() const override {
    std::vector<Pose> poses;
    for (const auto& body : bodies_) {
      const btTransform& X = body->getWorldTransform();
      const btQuaternion q = X.getRotation();
      poses.push_back({Vec3(X.getOrigin().x(), X.getOrigin().y(), X.getOrigin().z()),
                       Quat(q.w(), q.x(), q.y(), q.z()).normalized()});
    }
    return poses;
  }

 private:
  static std::unique_ptr<btCollisionShape> shapeOf(const Shape& shape) {
    if (const auto* sphere = std::get_if<Sphere>(&shape))
      return std::make_unique<btSphereShape>(btScalar(sphere->radius));
    if (const auto* box = std::get_if<Box>(&shape))
      return std::make_unique<btBoxShape>(toBullet(0.5 * box->size));
    return std::make_unique<btStaticPlaneShape>(btVector3(0, 0, 1), btScalar(0));
  }

  void add(const BodyDef& def) {
    shapes_.push_back(shapeOf(def.shape));
    const bool moves = def.kind == BodyKind::Dynamic;
    const double mass = def.mass.value_or(def.density.value_or(kDefaultDensity) * volume(def.shape));
    btVector3 inertia(0, 0, 0);
    if (moves) shapes_.back()->calculateLocalInertia(btScalar(mass), inertia);
    bodies_.push_back(
        std::make_unique<btRigidBody>(btScalar(moves ? mass : 0.0), nullptr, shapes_.back().get(), inertia));
    btRigidBody& body = *bodies_.back();
    const Eigen::Quaternion<btScalar> q(def.pose.q_WB.cast<btScalar>());
    body.setWorldTransform(btTransform(btQuaternion(q.x(), q.y(), q.z(), q.w()), toBullet(def.pose.p_WB)));
    body.setLinearVelocity(toBullet(def.twist.v_WB));
    body.setAngularVelocity(toBullet(def.twist.w_WB));
    body.setFriction(btScalar(std::sqrt(def.material.friction)));  // of a pair it takes the product
    body.setRestitution(btScalar(def.material.restitution));
    body.setActivationState(DISABLE_DEACTIVATION);  // we have no sleep, so nobody sleeps
    world_.addRigidBody(&body);
  }

  double step_;
  int cuts_;
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_;
  btDbvtBroadphase broadphase_;
  btSequentialImpulseConstraintSolver solver_;
  btDiscreteDynamicsWorld world_;
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  std::vector<std::unique_ptr<btRigidBody>> bodies_;
};

double deepestOverlap(const SceneDef& scene, const std::vector<Pose>& poses) {
  const auto moves = [&](std::size_t k) { return scene.bodies[k].kind == BodyKind::Dynamic; };
  double deepest = 0.0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    for (std::size_t j = i + 1; j < poses.size(); ++j) {
      if (!moves(i) && !moves(j)) continue;
      const Shape &a = scene.bodies[i].shape, &b = scene.bodies[j].shape;
      const bool plane = std::holds_alternative<Plane>(a) || std::holds_alternative<Plane>(b);
      if (!plane && (poses[i].p_WB - poses[j].p_WB).norm() > boundingRadius(a) + boundingRadius(b)) continue;
      const Manifold manifold = collide(a, poses[i], b, poses[j], 0.0);
      for (int k = 0; k < manifold.size; ++k) deepest = std::max(deepest, -manifold.points[k].separation);
    }
  }
  return deepest;
}

double quantile(std::vector<double> values, double share) {
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

double highest(const std::vector<Pose>& poses) {
  double z = 0.0;
  for (const Pose& pose : poses) z = std::max(z, pose.p_WB.z());
  return z;
}

void run(const Race& race) {
  std::vector<std::unique_ptr<Contestant>> contestants;
  contestants.push_back(std::make_unique<Ours>(race.scene));
  contestants.push_back(std::make_unique<Bullet>(race.scene, 1));
  contestants.push_back(std::make_unique<Bullet>(race.scene, 4));
  const double top = highest(contestants.front()->poses());
  for (const Phase& phase : race.phases) {
    for (const auto& contestant : contestants) {
      contestant->seconds.clear();
      contestant->deepest = 0.0;
      if (phase.kick > 0.0) contestant->kick(phase.kick);
    }
    for (int done = 0; done < phase.steps; done += kStretch) {
      std::fprintf(stderr, "\r%s, %s: step %d of %d ", race.name.c_str(), phase.name.c_str(), done,
                   phase.steps);
      for (const auto& contestant : contestants) {
        for (int k = 0; k < kStretch; ++k) {
          const auto start = std::chrono::steady_clock::now();
          contestant->step();
          contestant->seconds.push_back(
              std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
        }
        if (done % 100 == 0 || done + kStretch == phase.steps)
          contestant->deepest =
              std::max(contestant->deepest, deepestOverlap(race.scene, contestant->poses()));
      }
    }
    std::fprintf(stderr, "\r%*s\r", 60, "");
    const double ours = quantile(contestants.front()->seconds, 0.5);
    for (const auto& c : contestants) {
      const double median = quantile(c->seconds, 0.5);
      std::printf("| %s | %s | %s | %zu | %.2f | %.2f | %.2f | %.1f | %.2f |\n", race.name.c_str(),
                  phase.name.c_str(), c->name.c_str(), c->contacts(), 1e3 * median,
                  1e3 * quantile(c->seconds, 0.99), median / ours, 1e3 * c->deepest,
                  top - highest(c->poses()));
      std::fflush(stdout);
    }
  }
}

SceneDef catalogue(const std::string& name) {
  return readScene(std::string(RBS_SCENES) + "/" + name + ".yaml").scene;
}

// A wall of so many rows of boxes of 1 m, half overlapping.
SceneDef wall(int rows) {
  SceneDef scene = catalogue("pyramid");
  scene.bodies.resize(1);
  BodyDef brick;
  brick.shape = Box{Vec3::Ones()};
  brick.material.friction = 0.5;
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < rows - row; ++column) {
      brick.pose.p_WB = Vec3(1.1 * (column + 0.5 * (row - rows + 1)), 0.0, 0.5 + row);
      scene.bodies.push_back(brick);
    }
  return scene;
}

// A thousand balls and cubes of half a metre, at random orientations, that fall into a pen of 4 m.
SceneDef pile() {
  SceneDef scene = catalogue("pyramid");
  scene.bodies.resize(1);
  const auto addWall = [&](const Vec3& size, const Vec3& p_WB) {
    BodyDef def;
    def.shape = Box{size};
    def.kind = BodyKind::Static;
    def.pose.p_WB = p_WB;
    def.material.friction = 0.5;
    scene.bodies.push_back(def);
  };
  for (const double side : {-1.0, 1.0}) {
    addWall(Vec3(1.0, 6.0, 30.0), Vec3(side * 2.5, 0.0, 15.0));
    addWall(Vec3(6.0, 1.0, 30.0), Vec3(0.0, side * 2.5, 15.0));
  }
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (int k = 0; k < 1000; ++k) {
    BodyDef def;
    if (k % 2 == 0)
      def.shape = Sphere{0.25};
    else
      def.shape = Box{Vec3::Constant(0.5)};
    def.material.friction = 0.5;
    def.pose.p_WB = Vec3(-1.4 + 0.7 * (k % 5), -1.4 + 0.7 * (k / 5 % 5), 0.6 + 0.7 * (k / 25));
    def.pose.q_WB = Quat(normal(random), normal(random), normal(random), normal(random)).normalized();
    scene.bodies.push_back(def);
  }
  return scene;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string only = argc > 1 ? argv[1] : "";
  const std::vector<Phase> falls = {{"falling and at rest", 600}};
  const std::vector<Phase> stands = {{"at rest", 300}};
  const std::vector<Race> races = {
      {"mixed_rain", catalogue("mixed_rain"), falls},
      {"sphere_rain", catalogue("sphere_rain"), falls},
      {"wall of 55", wall(10), stands},
      {"wall of 210", wall(20), stands},
      {"wall of 1830", wall(60), stands},
      {"pile of 1000", pile(), {{"settling", 300}, {"", 200}, {"at rest", 100}, {"kicked", 40, 3.0}}}};
  std::printf(
      "| scene | phase | engine | contacts | median step, ms | 99th percentile, ms | median against ours | "
      "deepest "
      "overlap, mm | top sunk by, m |\n");
  std::printf("|---|---|---|--:|--:|--:|--:|--:|--:|\n");
  for (const Race& race : races)
    if (race.name.rfind(only, 0) == 0) run(race);
}
