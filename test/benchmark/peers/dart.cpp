// SPDX-License-Identifier: BSD-3-Clause
// DART behind the seam.
#include "engine.h"

#include <dart/external/odelcpsolver/error.h>
#include <dart/collision/dart/DARTCollisionDetector.hpp>
#include <dart/constraint/ConstraintSolver.hpp>
#include <dart/constraint/ContactConstraint.hpp>
#include <dart/dynamics/BodyNode.hpp>
#include <dart/dynamics/BoxShape.hpp>
#include <dart/dynamics/FreeJoint.hpp>
#include <dart/dynamics/Skeleton.hpp>
#include <dart/dynamics/SphereShape.hpp>
#include <dart/simulation/World.hpp>

#include <algorithm>
#include <cmath>
#include <cstdarg>

namespace rbs::peers {
namespace {

namespace dd = dart::dynamics;
using dart::constraint::ContactConstraint;

class Dart : public Engine {
 public:
  Dart(const Task& task, bool better) : better_(better), pushes_(task.pushes) {
    refuseFluids(task, "DART");
    // Its solver prints a line for every step that it cannot solve.
    dart::external::ode::dSetMessageHandler([](int, const char*, va_list) {});
    // These belong to all worlds. The first of each two is what it has by itself.
    ContactConstraint::setConstraintForceMixing(better ? 1e-9 : 1e-5);  // less it does not take
    ContactConstraint::setErrorReductionParameter(better ? 0.2 : 0.01);
    ContactConstraint::setMaxErrorReductionVelocity(better ? 1.0 : 1e-3);
    world_->setTimeStep(task.scene.step);
    world_->setGravity(task.scene.gravity);
    if (better)
      world_->getConstraintSolver()->setCollisionDetector(dart::collision::DARTCollisionDetector::create());
    for (const BodyDef& def : task.scene.bodies) add(def);
    mixMaterials(task.scene.bodies);
  }

  void step() override {
    for (const Push& push : pushes_) bodies_[push.body]->addExtForce(push.force_W, Vec3::Zero(), false);
    if (better_) alignPyramids();
    world_->step();
  }
  std::vector<Motion> read() const override {
    std::vector<Motion> motions;
    for (std::size_t k = 0; k < bodies_.size(); ++k) {
      if (!bodies_[k]->getSkeleton()->isMobile()) {
        motions.push_back({fixed_[k], {}});
        continue;
      }
      const Eigen::Isometry3d& X = bodies_[k]->getWorldTransform();
      motions.push_back({{X.translation(), Quat(X.rotation())},
                         {bodies_[k]->getLinearVelocity(), bodies_[k]->getAngularVelocity()}});
    }
    return motions;
  }

 private:
  // Its own narrow phase knows no planes, and through those of FCL boxes sink.
  static constexpr double kLarge = 50.0;

  dd::ShapePtr shapeOf(const Shape& shape) const {
    if (const auto* sphere = std::get_if<Sphere>(&shape))
      return std::make_shared<dd::SphereShape>(sphere->radius);
    if (const auto* box = std::get_if<Box>(&shape)) return std::make_shared<dd::BoxShape>(box->size);
    if (std::holds_alternative<Plane>(shape))
      return std::make_shared<dd::BoxShape>(Vec3::Constant(2 * kLarge));
    throw Unsupported("the DART adapter has no " + shapeName(shape));
  }

  void add(const BodyDef& def) {
    const bool moves = def.kind == BodyKind::Dynamic;
    const dd::SkeletonPtr skeleton = dd::Skeleton::create(def.name);
    const auto [joint, body] = skeleton->createJointAndBodyNodePair<dd::FreeJoint>();
    const dd::ShapePtr shape = shapeOf(def.shape);
    shapes_.push_back(
        body->createShapeNodeWith<dd::VisualAspect, dd::CollisionAspect, dd::DynamicsAspect>(shape));
    Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
    X.linear() = def.pose.q_WB.toRotationMatrix();
    X.translation() = def.pose.p_WB;
    if (std::holds_alternative<Plane>(def.shape)) X.translation() -= kLarge * X.linear().col(2);
    joint->setTransform(X);
    skeleton->setMobile(moves);
    if (moves) {
      const Mat3 I = Vec3(massOf(def) * momentsPerMass(def.shape)).asDiagonal();
      body->setInertia(dd::Inertia(massOf(def), Vec3::Zero(), I));
      joint->setLinearVelocity(def.twist.v_WB);
      joint->setAngularVelocity(def.twist.w_WB);
    }
    bodies_.push_back(body);
    fixed_.push_back(def.pose);
    world_->addSkeleton(skeleton);
  }

  // A pair takes what it takes in our scenes: the geometric mean of friction, the larger restitution. DART
  // takes the smaller friction and the product of restitutions, so bodies get coefficients that come to the
  // same.
  void mixMaterials(const std::vector<BodyDef>& defs) {
    const std::size_t count = defs.size();
    const auto meet = [&](std::size_t i, std::size_t j) {
      return i != j && (defs[i].kind == BodyKind::Dynamic || defs[j].kind == BodyKind::Dynamic);
    };
    const auto friction = [&](std::size_t i, std::size_t j) {
      return std::sqrt(defs[i].material.friction * defs[j].material.friction);
    };
    const auto restitution = [&](std::size_t i, std::size_t j) {
      return std::max(defs[i].material.restitution, defs[j].material.restitution);
    };
    for (std::size_t i = 0; i < count; ++i) {
      double mu = 0, e = 0;
      for (std::size_t j = 0; j < count; ++j)
        if (meet(i, j)) mu = std::max(mu, friction(i, j)), e = std::max(e, restitution(i, j));
      shapes_[i]->getDynamicsAspect()->setFrictionCoeff(mu);
      shapes_[i]->getDynamicsAspect()->setRestitutionCoeff(std::sqrt(e));
    }
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t j = 0; j < i; ++j) {
        if (!meet(i, j)) continue;
        const auto &a = *shapes_[i]->getDynamicsAspect(), &b = *shapes_[j]->getDynamicsAspect();
        if (std::min(a.getFrictionCoeff(), b.getFrictionCoeff()) != friction(i, j) ||
            std::abs(a.getRestitutionCoeff() * b.getRestitutionCoeff() - restitution(i, j)) > 1e-15)
          throw Unsupported("DART cannot have the materials of " + defs[i].name + " and " + defs[j].name);
      }
  }

  // Its cone of friction is a pyramid, which is right along its edges: so one is laid along the way that a
  // body would go without contacts.
  void alignPyramids() {
    for (std::size_t k = 0; k < bodies_.size(); ++k) {
      if (!bodies_[k]->getSkeleton()->isMobile()) continue;
      const Vec3 a =
          world_->getGravity() + bodies_[k]->getExternalForceGlobal().tail<3>() / bodies_[k]->getMass();
      auto* material = shapes_[k]->getDynamicsAspect();
      material->setFirstFrictionDirectionFrame(dd::Frame::World());
      material->setFirstFrictionDirection(bodies_[k]->getLinearVelocity() + world_->getTimeStep() * a);
    }
  }

  bool better_;
  std::vector<Push> pushes_;
  dart::simulation::WorldPtr world_ = dart::simulation::World::create();
  std::vector<dd::BodyNode*> bodies_;
  std::vector<dd::ShapeNode*> shapes_;
  std::vector<Pose> fixed_;  // where the static ones are
};

RegisterEngine add(const std::string& setting, const std::string& sentence, bool better) {
  return RegisterEngine({"dart", setting, DART_VERSION ", double, with its assertions", sentence,
                         [better](const Task& task) { return std::make_unique<Dart>(task, better); }});
}

const RegisterEngine as_is =
    add("default", "direct solver (Dantzig's), FCL on meshes, floors are large boxes", false);
const RegisterEngine better = add("better",
                                  "the same, softness 1e-9, overlaps closed faster, its own narrow phase, "
                                  "friction pyramid laid along the way",
                                  true);

}  // namespace
}  // namespace rbs::peers
