// SPDX-License-Identifier: BSD-3-Clause
// Bullet behind the seam: its discrete dynamics world.
#include "engine.h"

#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <cmath>

namespace rbs::peers {
namespace {

btVector3 toBullet(const Vec3& v) {
  return {btScalar(v.x()), btScalar(v.y()), btScalar(v.z())};
}
Vec3 fromBullet(const btVector3& v) {
  return {v.x(), v.y(), v.z()};
}

// A pair takes what it takes in our scenes: the geometric mean of friction, the larger restitution.
btScalar meanFriction(const btCollisionObject* a, const btCollisionObject* b) {
  return std::sqrt(a->getFriction() * b->getFriction());
}
btScalar largerRestitution(const btCollisionObject* a, const btCollisionObject* b) {
  return std::max(a->getRestitution(), b->getRestitution());
}

class Bullet : public Engine {
 public:
  Bullet(const Task& task, bool better)
      : better_(better),
        step_(btScalar(task.scene.step)),
        pushes_(task.pushes),
        dispatcher_(&configuration_),
        world_(&dispatcher_, &broadphase_, &solver_, &configuration_) {
    refuseFluids(task, "Bullet");
    gCalculateCombinedFrictionCallback = meanFriction;
    gCalculateCombinedRestitutionCallback = largerRestitution;
    if (better) {
      world_.getSolverInfo().m_numIterations = 200;
      world_.getSolverInfo().m_restitutionVelocityThreshold = 0;
    }
    world_.setGravity(toBullet(task.scene.gravity));
    for (const BodyDef& def : task.scene.bodies) add(def);
  }
  ~Bullet() override {
    for (const auto& body : bodies_) world_.removeRigidBody(body.get());
  }

  void step() override {
    for (const Push& push : pushes_) bodies_[push.body]->applyCentralForce(toBullet(push.force_W));
    world_.stepSimulation(step_, 0);
  }
  std::vector<Motion> read() const override {
    std::vector<Motion> motions;
    for (std::size_t k = 0; k < bodies_.size(); ++k) {
      if (bodies_[k]->isStaticObject()) {
        motions.push_back({fixed_[k], {}});
        continue;
      }
      const auto& body = bodies_[k];
      const btTransform& X = body->getWorldTransform();
      const btQuaternion q = X.getRotation();
      motions.push_back({{fromBullet(X.getOrigin()), Quat(q.w(), q.x(), q.y(), q.z())},
                         {fromBullet(body->getLinearVelocity()), fromBullet(body->getAngularVelocity())}});
    }
    return motions;
  }

 private:
  // A plane gets one contact with a box a step, and keeps old ones; a large box gets all of them.
  static constexpr double kLarge = 50.0;

  std::unique_ptr<btCollisionShape> shapeOf(const Shape& shape) const {
    if (const auto* sphere = std::get_if<Sphere>(&shape))
      return std::make_unique<btSphereShape>(btScalar(sphere->radius));
    if (const auto* box = std::get_if<Box>(&shape))
      return std::make_unique<btBoxShape>(toBullet(0.5 * box->size));
    if (std::holds_alternative<Plane>(shape) && better_)
      return std::make_unique<btBoxShape>(toBullet(Vec3::Constant(kLarge)));
    if (std::holds_alternative<Plane>(shape))
      return std::make_unique<btStaticPlaneShape>(btVector3(0, 0, 1), btScalar(0));
    throw Unsupported("the Bullet adapter has no " + shapeName(shape));
  }

  void add(const BodyDef& def) {
    shapes_.push_back(shapeOf(def.shape));
    const bool moves = def.kind == BodyKind::Dynamic;
    btVector3 inertia(0, 0, 0);
    if (moves) inertia = toBullet(massOf(def) * momentsPerMass(def.shape));
    bodies_.push_back(std::make_unique<btRigidBody>(btScalar(moves ? massOf(def) : 0.0), nullptr,
                                                    shapes_.back().get(), inertia));
    btRigidBody& body = *bodies_.back();
    const Quat& q = def.pose.q_WB;
    Vec3 p = def.pose.p_WB;
    if (std::holds_alternative<Plane>(def.shape) && better_) p -= kLarge * (q * Vec3::UnitZ());
    body.setWorldTransform(btTransform(
        btQuaternion(btScalar(q.x()), btScalar(q.y()), btScalar(q.z()), btScalar(q.w())), toBullet(p)));
    fixed_.push_back(def.pose);
    body.setLinearVelocity(toBullet(def.twist.v_WB));
    body.setAngularVelocity(toBullet(def.twist.w_WB));
    body.setFriction(btScalar(def.material.friction));
    body.setRestitution(btScalar(def.material.restitution));
    body.setActivationState(DISABLE_DEACTIVATION);
    world_.addRigidBody(&body);
  }

  bool better_;
  btScalar step_;
  std::vector<Push> pushes_;
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_;
  btDbvtBroadphase broadphase_;
  btSequentialImpulseConstraintSolver solver_;
  btDiscreteDynamicsWorld world_;
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  std::vector<std::unique_ptr<btRigidBody>> bodies_;
  std::vector<Pose> fixed_;  // where the static ones are
};

RegisterEngine add(const std::string& setting, const std::string& sentence, bool better) {
  const std::string version = std::to_string(BT_BULLET_VERSION / 100) + "." +
                              std::to_string(BT_BULLET_VERSION % 100) +
                              (sizeof(btScalar) == sizeof(double) ? ", double" : ", float");
  return RegisterEngine({"bullet", setting, version, sentence,
                         [better](const Task& task) { return std::make_unique<Bullet>(task, better); }});
}

const RegisterEngine as_is = add("default", "sequential impulses, 10 iterations", false);
const RegisterEngine better =
    add("better", "200 iterations, every approach rebounds, floors are large boxes", true);

}  // namespace
}  // namespace rbs::peers
