// SPDX-License-Identifier: BSD-3-Clause
// World: build it from a scene, edit it, step it, read it. Not thread-safe: one thread owns it.
//
// Every edit either does all it was asked or throws InvalidInput and changes nothing.
#pragma once

#include "rigid_body_sim/scene.h"
#include "rigid_body_sim/snapshot.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace rbs {

/// Properties to change; what is empty stays.
struct BodyEdit {
  std::optional<Shape> shape;  ///< the mass follows the density, unless `mass` is given too
  std::optional<Pose> pose;
  std::optional<Twist> twist;
  std::optional<BodyKind> kind;   ///< dynamic to static or kinematic stops the body, unless `twist` is given
  std::optional<double> mass;     ///< kg; the density follows. At most one of mass and density
  std::optional<double> density;  ///< kg/m³; the mass follows
  std::optional<double> friction, restitution, drag_coefficient, rolling_resistance, torsional_resistance;
  std::optional<Color> color;
  std::optional<std::uint32_t> group, mask;  ///< see BodyDef
};

/// A user force, as of a mouse: a spring from a point of a body to a point of the world. It damps turning,
/// too: as much as lets the body swing to where it hangs, without swinging beyond.
struct Grab {
  Vec3 p_B = Vec3::Zero();          ///< where it holds the body, in B, m
  Vec3 p_W = Vec3::Zero();          ///< where it pulls that point, m
  double frequency = 4.0;           ///< of the critically damped spring, Hz, > 0
  double max_acceleration = 300.0;  ///< cap on force over mass, m/s², > 0
};

/// What a saved state holds beyond the definitions of its bodies.
struct SavedState {
  double time = 0.0;
  std::uint64_t steps = 0;
  /// Warm-starting forces of one pair of bodies, by their indices in the scene, the first the smaller.
  struct Contact {
    std::uint32_t a = 0, b = 0;
    struct Point {
      std::uint32_t feature = 0;
      double normal = 0.0;            ///< N
      Vec3 tangent_W = Vec3::Zero();  ///< on b, N
    };
    std::vector<Point> points;
    bool exact = false;  ///< solved by the exact step, which a fast setting then keeps for longer
  };
  std::vector<Contact> contacts;
  /// Where the attitude of a body is counted from whose spin is constant (see World::snapshot()).
  struct Attitude {
    std::uint32_t body = 0;        ///< its index in the scene
    double since = 0.0;            ///< s
    Quat q_WB = Quat::Identity();  ///< then
  };
  std::vector<Attitude> attitudes;
  /// A body at rest, in a scene whose bodies may sleep.
  struct Rest {
    std::uint32_t body = 0;                    ///< its index in the scene
    std::uint32_t steps = 0;                   ///< for how many it has been
    std::optional<std::uint32_t> asleep_with;  ///< index of the first body of the group that it sleeps with
  };
  std::vector<Rest> rest;
};

class World {
 public:
  /// Throws InvalidInput with every fault of the scene. `saved` resumes a saved state.
  explicit World(SceneDef scene, const std::optional<SavedState>& saved = std::nullopt);
  ~World();
  World(const World&);  ///< another world with the same future, bit for bit
  World(World&&) noexcept;
  World& operator=(World&&) noexcept;

  // --- bodies
  BodyId addBody(const BodyDef& body);
  std::vector<BodyId> addBodies(const std::vector<BodyDef>& bodies);  ///< all or none
  void removeBody(BodyId id);
  void clear();
  void editBody(BodyId id, const BodyEdit& edit);
  /// The body of this name; no body when there is none.
  BodyId find(const std::string& name) const;
  /// Where the body is now. Throws InvalidInput where there is none. Costs far less than a snapshot.
  Pose pose(BodyId id) const;
  /// The lowest free place for this shape, turned by q_WB, above (x, y) = (0, 0) and at least `clearance`
  /// above 0, m.
  Vec3 freePlace(const Shape& shape, const Quat& q_WB, double clearance = 0.5) const;

  // --- forces
  void applyImpulse(BodyId id, const Vec3& impulse_W, const Vec3& point_W);  ///< N s, m
  /// Force at a point and a couple, from now on for `seconds` of physics time (> 0).
  /// Adds to the wrenches that already act.
  void applyWrench(BodyId id, const Vec3& force_W, const Vec3& torque_W, const Vec3& point_W, double seconds);
  /// The same, but in the place of the body's last commanded wrench: a body has one slot for commands, beside
  /// whatever applyWrench() has added, so a controller may send as often as it likes. `seconds` is its
  /// time-out.
  void commandWrench(BodyId id, const Vec3& force_W, const Vec3& torque_W, const Vec3& point_W,
                     double seconds);
  void grab(BodyId id, const Grab& grab);    ///< from now on, until release()
  void hold(BodyId id, const Pose& target);  ///< leads the body there as if kinematic, until release()
  void release(BodyId id);                   ///< a grabbed body keeps its velocity; a held one is at rest

  // --- surroundings
  void setGravity(const Vec3& gravity_W);
  void setAir(const std::optional<Air>& air);        ///< taking air away takes the wind with it
  void setWind(const std::optional<Wind>& wind);     ///< needs air
  void setFidelity(const Setting& setting);          ///< bodies keep their state, bit for bit
  void setGoal(const std::optional<Goal>& goal);     ///< for a Governor, which turns the dial by it
  void setFluid(const std::optional<Fluid>& fluid);  ///< empty takes it away
  void setEffects(const EffectOverrides& effects);   ///< replaces all overrides; those not in it are detected

  // --- time
  /// Advances by the scene's step. Never throws: trouble is in the report.
  const StepReport& step();

  // --- reading
  double time() const;
  std::uint64_t steps() const;
  std::uint64_t edits() const;    ///< how often the world has been edited; the dial and its goal do not count
  const SceneDef& scene() const;  ///< settings as they are now; `bodies` is not kept up
  SceneDef capture() const;       ///< the scene as it is now, bodies and velocities included
  SavedState captureState() const;                                     ///< what capture() leaves out
  std::shared_ptr<const std::vector<BodyDescription>> bodies() const;  ///< in canonical order
  Snapshot snapshot() const;                ///< all but the pacing, and what a Governor adds
  std::vector<StageInfo> pipeline() const;  ///< which stages run, and why
  std::uint64_t stateHash() const;
  Totals totals() const;

  struct Impl;  ///< private

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace rbs
