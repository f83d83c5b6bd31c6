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

/// Changes to a body, for World::editBody(). An empty field leaves its property as it is. Ranges are those of
/// BodyDef and Material.
struct BodyEdit {
  std::optional<Shape> shape;  ///< the mass follows from the density, unless `mass` is given too
  std::optional<Pose> pose;    ///< pose of B in W; the velocity stays
  std::optional<Twist> twist;  ///< velocity at the centre of mass, in W; zero for a static body
  /// How the body moves. Static or kinematic stops it, unless `twist` is given. A frozen body stays frozen
  /// until `kind` or `pose` is given.
  std::optional<BodyKind> kind;
  std::optional<double> mass;          ///< kg; the density follows. At most one of mass and density
  std::optional<double> density;       ///< kg/m³; the mass follows
  std::optional<double> friction,      ///< Coulomb coefficient
      restitution,                     ///< Newton's coefficient
      drag_coefficient,                ///< drag coefficient; an edit cannot bring the default back
      rolling_resistance,              ///< rolling resistance c
      torsional_resistance;            ///< torsional resistance s
  std::optional<Color> color;          ///< red, green, blue, alpha, each 0 to 1
  std::optional<std::uint32_t> group,  ///< see BodyDef::group
      mask;                            ///< see BodyDef::mask
};

/// A user force, as of a mouse (a mouse constraint): a critically damped spring from a point of a body to a
/// point of the world. It damps rotation, too: as much as lets the body swing to where it hangs, without
/// swinging beyond.
struct Grab {
  Vec3 p_B = Vec3::Zero();          ///< point of the body that it holds, in B, m
  Vec3 p_W = Vec3::Zero();          ///< point that it pulls it to, in W, m
  double frequency = 4.0;           ///< natural frequency of the spring, Hz, above 0 to 1e4
  double max_acceleration = 300.0;  ///< cap on the spring's force over the mass, m/s², above 0 to 1e9
};

/// What a saved state holds beyond the definitions of its bodies. Together with World::capture() it resumes a
/// run bit for bit, but for grabs and holds, which are not saved. Indices are those of
/// SceneDef::bodies.
struct SavedState {
  double time = 0.0;        ///< physics time, s, >= 0
  std::uint64_t steps = 0;  ///< steps since the scene began
  /// Contact forces of one pair of bodies, which warm-start the next step.
  struct Contact {
    std::uint32_t a = 0,  ///< index of the first body, the smaller one
        b = 0;            ///< index of the second body
    /// Forces at one contact point.
    struct Point {
      std::uint32_t feature = 0;      ///< feature id: which features of the two shapes meet
      double normal = 0.0;            ///< normal force, N, >= 0
      Vec3 tangent_W = Vec3::Zero();  ///< friction force on b, in W, N
    };
    std::vector<Point> points;  ///< at most 32
    bool exact = false;  ///< solved by the exact step, which Fidelity::Interactive then keeps for longer
  };
  std::vector<Contact> contacts;  ///< pairs that had contact points in the last step
  /// Orientation of a body at an earlier time. Where nothing can change the angular velocity of a body, its
  /// orientation is not integrated. It is computed from this one when it is read.
  struct Attitude {
    std::uint32_t body = 0;        ///< index of the body
    double since = 0.0;            ///< physics time of that orientation, s, 0 to SavedState::time
    Quat q_WB = Quat::Identity();  ///< unit quaternion from B to W at that time
  };
  std::vector<Attitude> attitudes;  ///< of rotating bodies whose orientation is not integrated
  /// A body at rest, in a scene whose bodies may sleep.
  struct Rest {
    std::uint32_t body = 0;  ///< index of the body
    /// Solver steps (divisions of steps) that it has been at rest; counting ends at 0.5 s.
    std::uint32_t steps = 0;
    /// Index of the first body of the island that it sleeps with; empty: it is awake.
    std::optional<std::uint32_t> asleep_with;
  };
  std::vector<Rest> rest;  ///< bodies at rest; empty unless Effect::Sleeping is on
  /// A wrench that still acts (World::applyWrench(), World::commandWrench()).
  struct Wrench {
    std::uint32_t body = 0;       ///< index of the body
    Vec3 force_W = Vec3::Zero(),  ///< force, in W, N
        torque_W = Vec3::Zero(),  ///< torque beside that of the force, in W, N m
        point_B = Vec3::Zero();   ///< where the force acts, in B, m
    double until = 0.0;           ///< physics time at which it ends, s
    bool commanded = false;       ///< the next command replaces it
  };
  std::vector<Wrench> wrenches;  ///< in the order in which they were applied
};

/// A simulated world: bodies, surroundings, solver settings and the state of motion. It is not thread-safe:
/// one thread owns it, as Simulator does.
///
/// An edit does all that it was asked or throws InvalidInput and changes nothing. It throws for a handle of
/// no body of this world, and for numbers out of range. Every edit wakes all sleeping bodies, unless its
/// description says otherwise. Equal worlds under equal edits stay equal, bit for bit, unless
/// Setting::max_solve_ms cuts solves short.
class World {
 public:
  /// A world of this scene; `saved` resumes a saved state. Throws InvalidInput with every fault of the scene,
  /// or of the state.
  explicit World(SceneDef scene, const std::optional<SavedState>& saved = std::nullopt);
  ~World();
  World(const World&);                 ///< another world with the same future, bit for bit
  World(World&&) noexcept;             ///< the source may only be destroyed or assigned to
  World& operator=(World&&) noexcept;  ///< the source may only be destroyed or assigned to

  // --- bodies

  /// Adds a body and returns its handle. Throws InvalidInput for a faulty body or a name that is taken. It
  /// looks at the names of all bodies: to add many, addBodies() is faster.
  BodyId addBody(const BodyDef& body);
  /// Adds all bodies or none, and returns their handles in the same order. Throws InvalidInput as addBody()
  /// does.
  std::vector<BodyId> addBodies(const std::vector<BodyDef>& bodies);
  /// Removes a body, with the wrenches, grab or hold that act on it.
  void removeBody(BodyId id);
  /// Removes all bodies, wrenches, grabs and holds, and gives their memory back. Time and settings stay; what
  /// the last step has reported is forgotten.
  void clear();
  /// Changes properties of a body. A new pose, shape or mass drops the contact forces that would warm-start
  /// its next step. Throws InvalidInput for mass and density together, and where the changed body would be
  /// faulty.
  void editBody(BodyId id, const BodyEdit& edit);
  /// The body of this name; no body when there is none. It searches all bodies.
  BodyId find(const std::string& name) const;
  /// Where the body is now. Throws InvalidInput where there is none. Costs far less than a snapshot.
  Pose pose(BodyId id) const;
  /// The lowest free position of the centre of mass above (x, y) = (0, 0), in W, m, for this shape rotated by
  /// q_WB, a unit quaternion. Its lowest point is then at least `clearance` above z = 0, m, and 0.02 of its
  /// bounding radius away from every body. Zero for a plane.
  Vec3 freePlace(const Shape& shape, const Quat& q_WB, double clearance = 0.5) const;

  // --- forces

  /// Changes the velocity of a body at once by an impulse (in W, N s) at a point (in W, m). Throws
  /// InvalidInput unless the body is dynamic and neither held nor frozen. Components are at most
  /// Limits::max_impulse and Limits::max_position, and those of the new velocity Limits::max_speed and
  /// Limits::max_spin.
  void applyImpulse(BodyId id, const Vec3& impulse_W, const Vec3& point_W);
  /// Applies a force (N) at a point (m) and a torque (N m), all in W, from now on for `seconds` of physics
  /// time, above 0 to 1e9 s. Force and torque keep their directions in W; the point moves with the body. It
  /// adds to the wrenches that already act. Throws InvalidInput unless the body is dynamic and neither held
  /// nor frozen. Components are at most Limits::max_impulse and Limits::max_position.
  void applyWrench(BodyId id, const Vec3& force_W, const Vec3& torque_W, const Vec3& point_W, double seconds);
  /// Does what applyWrench() does, but replaces the body's last commanded wrench. A body has one slot for
  /// commands, beside whatever applyWrench() has added, so a controller may send as often as it likes.
  /// `seconds` is its time-out. A command that replaces another wakes nothing.
  void commandWrench(BodyId id, const Vec3& force_W, const Vec3& torque_W, const Vec3& point_W,
                     double seconds);
  /// Pulls a body by a user force until release(). It replaces the grab or hold of the body. Another grab of
  /// a grabbed body wakes nothing. Throws InvalidInput unless the body is dynamic and `grab` is within its
  /// ranges.
  void grab(BodyId id, const Grab& grab);
  /// Moves a body of any kind to a kinematic target until release(), whatever it meets. The distance decays
  /// with a time constant of 1/30 s. A frozen body stays. It replaces the grab of the body. Another target
  /// for a held body wakes nothing. Throws InvalidInput for a component beyond Limits::max_position and for a
  /// quaternion whose norm is not 1e-3 to 1e3.
  void hold(BodyId id, const Pose& target);
  /// Ends the grab or hold of a body. A grabbed body keeps its velocity; a held one is at rest.
  void release(BodyId id);

  // --- surroundings

  /// Sets the gravity in W, m/s², at most Limits::max_gravity; zero is none.
  void setGravity(const Vec3& gravity_W);
  /// Sets the air. Empty takes it away, and the wind with it.
  void setAir(const std::optional<Air>& air);
  /// Sets the wind. Empty is air at rest. Throws InvalidInput for wind in a world without air.
  void setWind(const std::optional<Wind>& wind);
  /// Changes the solver settings. Bodies keep their state, bit for bit. It does not count in edits().
  void setFidelity(const Setting& setting);
  /// Sets the goal by which a Governor changes the solver settings; empty: none. The world itself does not
  /// follow it. It wakes nothing and does not count in edits().
  void setGoal(const std::optional<Goal>& goal);
  /// Sets the fluid. Empty takes it away.
  void setFluid(const std::optional<Fluid>& fluid);
  /// Replaces all overrides of effects. Effects that are not in it are detected. Bodies keep their state, bit
  /// for bit.
  void setEffects(const EffectOverrides& effects);

  // --- time

  /// Advances by the scene's step. Never throws: trouble is in the report. The report is valid until the next
  /// step.
  const StepReport& step();

  // --- reading

  double time() const;          ///< physics time since the scene began, s
  std::uint64_t steps() const;  ///< steps since the scene began; divisions do not count
  /// Edit counter, 1 for a new world. It grows with every edit. Changes of the solver settings and of the
  /// goal do not count, nor does what a step does by itself: the end of a wrench, a body that is frozen.
  std::uint64_t edits() const;
  /// How many bodies have been analysed so far for the effects that they need. An edit analyses the bodies
  /// that it is about; where it switches an effect, or whom others may meet, all bodies.
  std::uint64_t bodiesAnalysed() const;
  const SceneDef& scene() const;  ///< settings as they are now; `bodies` is empty
  /// The scene as it is now, bodies and velocities included. A frozen body is static in it. Wrenches, grabs
  /// and holds are left out.
  SceneDef capture() const;
  SavedState captureState() const;                                     ///< the rest of a saved state
  std::shared_ptr<const std::vector<BodyDescription>> bodies() const;  ///< in canonical order; never null
  /// The world as it is now, all but what a Simulator adds. It copies the states of all bodies.
  Snapshot snapshot() const;
  std::vector<StageInfo> pipeline() const;  ///< which stages run, and why
  /// Hash of what decides the next steps: bodies, contact forces, wrenches, grabs, holds, sleep, settings,
  /// seed and time. Equal worlds have equal hashes.
  std::uint64_t stateHash() const;
  Totals totals() const;  ///< energy and momentum, computed from all bodies

  struct Impl;  ///< private

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace rbs
