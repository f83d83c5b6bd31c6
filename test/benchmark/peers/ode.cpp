// SPDX-License-Identifier: BSD-3-Clause
// The Open Dynamics Engine behind the seam.
#include "engine.h"

#include <ode/ode.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdarg>

namespace rbs::peers {
namespace {

class Ode : public Engine {
 public:
  Ode(const Task& task, bool better) : better_(better), step_(task.scene.step), pushes_(task.pushes) {
    refuseFluids(task, "ODE");
    static const bool started = dInitODE2(0) != 0;
    if (!started) throw std::runtime_error("ODE does not start");
    dSetMessageHandler(
        [](int, const char*, va_list) {});  // it prints a line for every step that it cannot solve
    dRandSetSeed(0);  // it shuffles its contacts, and goes on from where the last world stopped
    world_.reset(dWorldCreate());
    space_.reset(dHashSpaceCreate(nullptr));
    group_.reset(dJointGroupCreate(0));
    const Vec3& g = task.scene.gravity;
    dWorldSetGravity(world_.get(), g.x(), g.y(), g.z());
    for (const BodyDef& def : task.scene.bodies) add(def);
  }

  void step() override {
    for (const Push& push : pushes_)
      dBodyAddForce(bodies_[push.body], push.force_W.x(), push.force_W.y(), push.force_W.z());
    dSpaceCollide(space_.get(), this,
                  [](void* self, dGeomID a, dGeomID b) { static_cast<Ode*>(self)->meet(a, b); });
    if (better_) {
      dWorldStep(world_.get(), step_);
    } else {
      dWorldQuickStep(world_.get(), step_);
    }
    dJointGroupEmpty(group_.get());
  }
  std::vector<Motion> read() const override {
    std::vector<Motion> motions;
    for (std::size_t k = 0; k < bodies_.size(); ++k) {
      if (bodies_[k] == nullptr) {
        motions.push_back({fixed_[k], {}});
        continue;
      }
      const dReal* q = dBodyGetQuaternion(bodies_[k]);
      motions.push_back({{vector(dBodyGetPosition(bodies_[k])), Quat(q[0], q[1], q[2], q[3])},
                         {vector(dBodyGetLinearVel(bodies_[k])), vector(dBodyGetAngularVel(bodies_[k]))}});
    }
    return motions;
  }

 private:
  static Vec3 vector(const dReal* v) { return {v[0], v[1], v[2]}; }

  void add(const BodyDef& def) {
    const Quat& q = def.pose.q_WB;
    const Vec3& p = def.pose.p_WB;
    dGeomID geom = nullptr;
    if (const auto* sphere = std::get_if<Sphere>(&def.shape)) {
      geom = dCreateSphere(space_.get(), sphere->radius);
    } else if (const auto* box = std::get_if<Box>(&def.shape)) {
      geom = dCreateBox(space_.get(), box->size.x(), box->size.y(), box->size.z());
    } else if (std::holds_alternative<Plane>(def.shape)) {
      const Vec3 n = q * Vec3::UnitZ();
      geom = dCreatePlane(space_.get(), n.x(), n.y(), n.z(), n.dot(p));
    } else {
      throw Unsupported("the ODE adapter has no " + shapeName(def.shape));
    }
    materials_.push_back(def.material);
    fixed_.push_back(def.pose);
    dGeomSetData(geom, reinterpret_cast<void*>(materials_.size() - 1));
    bodies_.push_back(nullptr);
    const dReal orientation[4] = {q.w(), q.x(), q.y(), q.z()};
    if (def.kind != BodyKind::Dynamic) {
      if (!std::holds_alternative<Plane>(def.shape)) {
        dGeomSetPosition(geom, p.x(), p.y(), p.z());
        dGeomSetQuaternion(geom, orientation);
      }
      return;
    }
    dBodyID body = bodies_.back() = dBodyCreate(world_.get());
    dMass mass;
    const Vec3 I = massOf(def) * momentsPerMass(def.shape);
    dMassSetParameters(&mass, massOf(def), 0, 0, 0, I.x(), I.y(), I.z(), 0, 0, 0);
    dBodySetMass(body, &mass);
    dGeomSetBody(geom, body);
    dBodySetPosition(body, p.x(), p.y(), p.z());
    dBodySetQuaternion(body, orientation);
    dBodySetLinearVel(body, def.twist.v_WB.x(), def.twist.v_WB.y(), def.twist.v_WB.z());
    dBodySetAngularVel(body, def.twist.w_WB.x(), def.twist.w_WB.y(), def.twist.w_WB.z());
    if (better_) dBodySetFiniteRotationMode(body, 1);
  }

  static Vec3 velocityAt(dBodyID body, const dReal* point) {
    dVector3 v{};
    if (body != nullptr) dBodyGetPointVel(body, point[0], point[1], point[2], v);
    return vector(v);
  }

  void meet(dGeomID a, dGeomID b) {
    dBodyID body_a = dGeomGetBody(a), body_b = dGeomGetBody(b);
    if (body_a == nullptr && body_b == nullptr) return;
    std::array<dContact, 8> contacts{};
    const int count = dCollide(a, b, int(contacts.size()), &contacts[0].geom, sizeof(dContact));
    const Material &m = materials_[reinterpret_cast<std::size_t>(dGeomGetData(a))],
                   &n = materials_[reinterpret_cast<std::size_t>(dGeomGetData(b))];
    for (int k = 0; k < count; ++k) {
      dContact& contact = contacts[k];
      contact.surface.mode = dContactApprox1 | dContactBounce;
      contact.surface.mu = std::sqrt(m.friction * n.friction);
      contact.surface.bounce = std::max(m.restitution, n.restitution);
      contact.surface.bounce_vel = 0;
      if (better_) alignPyramid(contact, body_a, body_b);
      dJointAttach(dJointCreateContact(world_.get(), group_.get(), &contact), body_a, body_b);
    }
  }

  // Its cone of friction is a pyramid, which is right along its edges: so one is laid along the slip.
  static void alignPyramid(dContact& contact, dBodyID a, dBodyID b) {
    const Vec3 normal = vector(contact.geom.normal);
    Vec3 slip = velocityAt(a, contact.geom.pos) - velocityAt(b, contact.geom.pos);
    slip -= slip.dot(normal) * normal;
    if (slip.norm() < 1e-9) return;
    slip.normalize();
    contact.surface.mode |= dContactFDir1;
    for (int i = 0; i < 3; ++i) contact.fdir1[i] = slip[i];
  }

  struct Destroy {
    void operator()(dxWorld* world) const { dWorldDestroy(world); }
    void operator()(dxSpace* space) const { dSpaceDestroy(space); }
    void operator()(dxJointGroup* group) const { dJointGroupDestroy(group); }
  };
  bool better_;
  double step_;
  std::vector<Push> pushes_;
  std::unique_ptr<dxWorld, Destroy> world_;
  std::unique_ptr<dxSpace, Destroy> space_;
  std::unique_ptr<dxJointGroup, Destroy> group_;
  std::vector<dBodyID> bodies_;  // null for static ones
  std::vector<Material> materials_;
  std::vector<Pose> fixed_;  // where the static ones are
};

RegisterEngine add(const std::string& setting, const std::string& sentence, bool better) {
  return RegisterEngine({"ode", setting, RBS_ODE_VERSION ", double", sentence,
                         [better](const Task& task) { return std::make_unique<Ode>(task, better); }});
}

const RegisterEngine as_is = add("default", "quick step, 20 iterations", false);
const RegisterEngine better =
    add("better", "direct solver, friction pyramid laid along the slip, finite rotations", true);

}  // namespace
}  // namespace rbs::peers
