// The time of a step beside Bullet's, on the same scenes in the same run: turn by turn, in stretches of
// steps, so that a noisy machine is noisy for all. Also how deep bodies overlap at the end of the stretches,
// found by our narrow phase on the poses of either engine, because time without error says little.
#include "narrowphase/collide.h"
#include "rigid_body_sim/scenes.h"

#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

namespace {

using namespace rbs;

constexpr int kSteps = 600, kStretch = 20;

/// One engine with one scene.
class Contestant {
 public:
  explicit Contestant(std::string name) : name(std::move(name)) {}
  virtual ~Contestant() = default;
  virtual void step() = 0;
  virtual std::vector<Pose> poses() const = 0;  ///< in the order of the scene

  const std::string name;
  std::vector<double> seconds;  ///< of each step
  double deepest = 0.0;         ///< m
};

class Ours : public Contestant {
 public:
  explicit Ours(const SceneDef& scene) : Contestant("rigid_body_sim, interactive"), world_(scene) {}
  void step() override { world_.step(); }
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

void race(const std::string& name) {
  const SceneDef scene = readScene(std::string(RBS_SCENES) + "/" + name + ".yaml").scene;
  std::vector<std::unique_ptr<Contestant>> contestants;
  contestants.push_back(std::make_unique<Ours>(scene));
  contestants.push_back(std::make_unique<Bullet>(scene, 1));
  contestants.push_back(std::make_unique<Bullet>(scene, 4));
  for (int done = 0; done < kSteps; done += kStretch) {
    std::fprintf(stderr, "\r%s: step %d of %d ", name.c_str(), done, kSteps);
    for (const auto& contestant : contestants) {
      for (int k = 0; k < kStretch; ++k) {
        const auto start = std::chrono::steady_clock::now();
        contestant->step();
        contestant->seconds.push_back(
            std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
      }
      contestant->deepest = std::max(contestant->deepest, deepestOverlap(scene, contestant->poses()));
    }
  }
  std::fprintf(stderr, "\r%*s\r", 40, "");
  const double ours = quantile(contestants.front()->seconds, 0.5);
  for (const auto& c : contestants) {
    const double median = quantile(c->seconds, 0.5);
    std::printf("| %s | %s | %.2f | %.2f | %.2f | %.1f |\n", name.c_str(), c->name.c_str(), 1e3 * median,
                1e3 * quantile(c->seconds, 0.99), median / ours, 1e3 * c->deepest);
  }
}

}  // namespace

int main() {
  std::printf(
      "| scene | engine | median step, ms | 99th percentile, ms | median against ours | deepest overlap, mm "
      "|\n");
  std::printf("|---|---|--:|--:|--:|--:|\n");
  for (const char* scene : {"mixed_rain", "pyramid", "sphere_rain"}) race(scene);
}
