// SPDX-License-Identifier: BSD-3-Clause
// The bodies of a scene, as parallel arrays in canonical order: the order of creation.
//
// Hot arrays (pose, twist, mass) are separate from cold ones (names, definitions). The position of a body in
// the arrays is its dense index. It changes when an older body is removed, so everything that outlives a step
// refers to bodies by BodyId.
#pragma once

#include "base/index.h"
#include "dynamics/inertia.h"
#include "rigid_body_sim/scene.h"
#include "rigid_body_sim/snapshot.h"
#include "state/name_table.h"

#include <cstdint>
#include <string>
#include <vector>

namespace rbs {

/// Properties of a body that the broad and narrow phase and the effects use, the traits of its shape among
/// them.
struct Traits : ShapeTraits {
  Shape shape;
  BodyKind kind = BodyKind::Dynamic;
  bool held = false;     ///< has a kinematic target (World::hold()) until it is released
  bool frozen = false;   ///< quarantined: static until an edit
  bool asleep = false;   ///< at rest and left out of the step (sleep.h)
  double mass = 0.0;     ///< kg, whatever the kind
  double density = 0.0;  ///< kg/m³
  Material material;
  double bounding_radius = 0.0, length = 0.0;  ///< m, of the shape
  std::uint32_t group = 1, mask = 0xffffffffu;

  /// Moved by forces, now or once it wakes.
  bool movable() const { return kind == BodyKind::Dynamic && !held && !frozen; }
  bool moved_by_forces() const { return movable() && !asleep; }
  bool is_kinematic() const { return !frozen && (held || kind == BodyKind::Kinematic); }
  double dragCoefficient() const;
};

/// Whether two bodies may collide at all: at least one moves, and their groups and masks allow it.
inline bool mayCollide(const Traits& a, const Traits& b) {
  const bool moving = a.moved_by_forces() || b.moved_by_forces() || (a.asleep && b.is_kinematic()) ||
                      (b.asleep && a.is_kinematic());
  return moving && (a.group & b.mask) && (b.group & a.mask);
}

/// How the last step took a body; see BodyState.
struct Advance {
  const char* method = "";
  BodyId island;
};

struct Bodies {
  std::vector<BodyId> id;
  std::vector<Pose> pose;     ///< q_WB of a body that is `lazy_orientation`: its orientation at `since`
  std::vector<double> since;  ///< s
  std::vector<Twist> twist;
  std::vector<Inertia> inertia;
  std::vector<Traits> traits;
  std::vector<std::string> name;  ///< rename() changes it
  std::vector<Color> color;
  std::vector<Advance> advance;  ///< of a ballistic body: what was before it became one

  Index size() const { return static_cast<Index>(id.size()); }
  Index indexOf(BodyId body) const;              ///< kNone when it is not here
  Index indexOf(const std::string& body) const;  ///< kNone when it is not here

  void append(BodyId new_id, const BodyDef& def);  ///< `def` is sound and has its name
  void erase(Index i);                             ///< keeps the order
  void rename(Index i, const std::string& to);     ///< a name that no other body has
  void clear() { *this = Bodies{}; }

  /// Call it after a change of shape, mass, kind, hold or quarantine of body i, and analyseScene()
  /// afterwards.
  void refresh(Index i);

  /// The pose of body i at `time`.
  Pose poseNow(Index i, double time) const;
  /// Computes the orientation of a lazy_orientation body at `time`, and makes `time` its new reference time.
  void updateOrientation(Index i, double time);

  BodyDescription describe(Index i) const;
  BodyDef define(Index i, double time) const;
  Mat3 R_WB(Index i) const { return pose[i].q_WB.toRotationMatrix(); }
  /// Velocity of the common centre of mass of some, m/s.
  Vec3 meanVelocity(const std::vector<Index>& some) const {
    double mass = 0.0;
    Vec3 momentum = Vec3::Zero();
    for (const Index i : some) mass += traits[i].mass, momentum += traits[i].mass * twist[i].v_WB;
    return momentum / mass;
  }
  /// What no point of a body is faster than, as seen by one that moves at a velocity, m/s. Not of a plane, which has no end.
  double mostSpeed(Index i, const Vec3& seen_from_v_W = Vec3::Zero()) const {
    return (twist[i].v_WB - seen_from_v_W).norm() + traits[i].bounding_radius * twist[i].w_WB.norm();
  }
  /// Kinetic energy of the spin w of a body that is turned by q_WB, J.
  double spinEnergy(Index i, const Quat& q_WB, const Vec3& w_W) const {
    const Vec3 w_B = q_WB.conjugate() * w_W;
    return 0.5 * w_B.dot(inertia[i].moments.cwiseProduct(w_B));
  }
  /// Axis of revolution, of length 1; zero for a sphere, and for a body that has none.
  Vec3 axis_W(Index i) const {
    return traits[i].revolved && !traits[i].round ? Vec3(pose[i].q_WB * Vec3::UnitZ()) : Vec3(Vec3::Zero());
  }

 private:
  NameTable by_name_;
};

/// The colour of a body that is given none.
Color defaultColor(BodyId id, BodyKind kind);

}  // namespace rbs
