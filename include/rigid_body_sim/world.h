// SPDX-License-Identifier: BSD-3-Clause
// World: build it from a scene, edit it, step it, read it. Not thread-safe: one thread owns it.
//
// An edit does all that it was asked or throws InvalidInput and changes nothing.
#pragma once

#include "rigid_body_sim/scene.h"
#include "rigid_body_sim/snapshot.h"

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace rbs {

struct Command;

/// Changes to a body, for World::editBody(). An empty field leaves its property as it is. Ranges are those of
/// BodyDef and Material.
struct BodyEdit {
  std::optional<std::string> name;  ///< see BodyDef::name; no other body may have it
  std::optional<Shape> shape;       ///< the mass follows from the density, unless `mass` is given too
  std::optional<Pose> pose;         ///< pose of B in W; the velocity stays
  std::optional<Twist> twist;       ///< velocity at the centre of mass, in W; zero for a static body
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

/// A user force, as from a mouse (a mouse constraint): a critically damped spring from a point of a body to a
/// point of the world. It damps rotation too, critically: the body swings to where it hangs and not beyond.
struct Grab {
  Vec3 p_B = Vec3::Zero();          ///< point of the body that the spring holds, in B, m
  Vec3 p_W = Vec3::Zero();          ///< point that the spring pulls p_B to, in W, m
  double frequency = 4.0;           ///< natural frequency of the spring, Hz, above 0 to 1e4
  double max_acceleration = 300.0;  ///< cap on the spring's force over the mass, m/s², above 0 to 1e9
};

/// What a saved state holds beyond the definitions of its bodies. Together with World::capture() it resumes a
/// run bit for bit; without grabs, holds and frozen bodies where World::captureState() made it. Indices are those
/// of SceneDef::bodies.
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
    Vec3 n_W = Vec3::UnitZ();  ///< its normal, unit, in W, from a to b
    /// Largest penetration depth of its points when last found, m, >= 0. It decides whether depenetration
    /// parts the two in the next step, and whether contacts keep the side that n_W says.
    double depth = 0.0;
    /// ContactPoint::touching_steps, up to that step.
    std::uint64_t touching_steps = 0;
  };
  std::vector<Contact> contacts;  ///< pairs that had contact points in the last step
  /// Orientation of a body at an earlier time. Where nothing can change the angular velocity of a body, its
  /// orientation is not integrated. It is computed from this one when it is read.
  struct Orientation {
    std::uint32_t body = 0;        ///< index of the body
    double since = 0.0;            ///< physics time of that orientation, s, 0 to SavedState::time
    Quat q_WB = Quat::Identity();  ///< unit quaternion from B to W at that time
  };
  std::vector<Orientation> orientations;  ///< of rotating bodies whose orientation is not integrated
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

  // What World::captureState() leaves empty and World::captureExactState() fills:

  /// A grab that pulls a body.
  struct Grabbed {
    std::uint32_t body = 0;  ///< index of the body
    Grab grab;               ///< the spring
  };
  std::vector<Grabbed> grabs;  ///< in the order in which they began
  /// A hold that moves a body.
  struct Held {
    std::uint32_t body = 0;  ///< index of the body
    Pose target;             ///< kinematic target
    Twist twist;             ///< velocity of the body in the last step, in W; also of a static one
  };
  std::vector<Held> holds;  ///< in the order in which they began
  /// A frozen body, which World::capture() makes static.
  struct Frozen {
    std::uint32_t body = 0;  ///< index of the body
    bool kinematic = false;  ///< its own kind: kinematic, else dynamic
  };
  std::vector<Frozen> frozen;  ///< in the order of the bodies
};

/// A simulated world: bodies, surroundings, solver settings and the state of motion. It is not thread-safe:
/// one thread owns it, as Simulator does.
///
/// Errors: an edit does all that it was asked or throws InvalidInput and changes nothing. Every function that
/// takes a handle throws InvalidInput for a handle of no body of this world. Every edit throws InvalidInput
/// for a number out of range.
///
/// An edit to what is already so changes nothing: it wakes nothing, does not count in edits() and gives no
/// Command. That goes for a body edited to be as it is, for the surroundings and effects, for no bodies added,
/// and for an empty world cleared.
///
/// Sleep: an edit wakes all sleeping bodies, unless its description says otherwise. Reading wakes nothing.
///
/// Cost: n is the number of bodies. A handle is found by binary search. An edit that wakes sleeping bodies,
/// and one that switches an effect, analyses all n bodies again for the effects that they need. Each
/// description gives the cost besides.
///
/// Equal worlds under equal edits stay equal, bit for bit, unless Setting::max_solve_ms cuts solves short.
class World {
 public:
  /// A world of this scene; `saved` resumes a saved state. Throws InvalidInput with every fault of the scene,
  /// or of the state. Cost: n bodies, and `saved`.
  explicit World(SceneDef scene, const std::optional<SavedState>& saved = std::nullopt);
  ~World();
  World(const World&);                 ///< another world with the same future, bit for bit, but no journal
  World(World&&) noexcept;             ///< the source may only be destroyed or assigned to
  World& operator=(World&&) noexcept;  ///< the source may only be destroyed or assigned to

  // --- bodies

  /// Adds a body and returns its handle. Throws InvalidInput for a faulty body or a name that is taken.
  /// Wakes all.
  BodyId addBody(const BodyDef& body);
  /// Adds all bodies or none, and returns their handles in the same order. Throws InvalidInput with every
  /// fault: faulty bodies, and names that are taken or given twice. Wakes all.
  std::vector<BodyId> addBodies(const std::vector<BodyDef>& bodies);
  /// Removes a body, with its contacts and with the wrenches, grab or hold that act on it. Its handle is
  /// never used again. Wakes all. Cost: n bodies and all contacts.
  void removeBody(BodyId id);
  /// Removes all bodies, contacts, wrenches, grabs and holds, and releases their memory. Time, steps() and
  /// settings stay. The report of the last step is empty afterwards. Cost: n bodies.
  void clear();
  /// Changes properties of a body. A new pose, shape or mass drops the contact forces that would warm-start
  /// its next step. Throws InvalidInput for mass and density together, for a name that another body has, and
  /// where the changed body would be faulty. Wakes all. Cost: all contacts where the pose, shape or mass
  /// changes.
  void editBody(BodyId id, const BodyEdit& edit);
  /// The body of this name; no body when there is none. Cost: a look into a hash table.
  BodyId find(const std::string& name) const;
  /// The pose of B in W now. Cost: the search for the handle; far less than a snapshot.
  Pose pose(BodyId id) const;
  /// The lowest free position of the centre of mass above (x, y) = (0, 0), in W, m, for this shape rotated by
  /// q_WB, a unit quaternion. Its lowest point is then at least `clearance` above z = 0, m, and 0.02 of its
  /// bounding radius away from every body. Zero for a plane. Never throws: shape, q_WB and clearance are not
  /// checked. Cost: n bodies for each obstacle that is passed on the way up, at most 100,000 times.
  Vec3 freePlace(const Shape& shape, const Quat& q_WB, double clearance = 0.5) const;

  // --- forces

  /// Changes the velocity of a body at once by an impulse (in W, N s) at a point (in W, m). Throws
  /// InvalidInput unless the body is dynamic and neither held nor frozen. Components are at most
  /// Limits::max_impulse and Limits::max_position; the new velocity is at most Limits::max_speed and
  /// Limits::max_spin. Wakes all.
  void applyImpulse(BodyId id, const Vec3& impulse_W, const Vec3& point_W);
  /// Applies a force (N) at a point (m) and a torque (N m), all in W, from now on for `seconds` of physics
  /// time, above 0 to 1e9 s. Force and torque keep their directions in W; the point moves with the body. It
  /// adds to the wrenches that already act. Throws InvalidInput unless the body is dynamic and neither held
  /// nor frozen. Components are at most Limits::max_impulse and Limits::max_position. Wakes all. The island
  /// of the body cannot go to sleep while it acts.
  void applyWrench(BodyId id, const Vec3& force_W, const Vec3& torque_W, const Vec3& point_W, double seconds);
  /// Replaces the last commanded wrench of the body by another, with the arguments, ranges and errors of
  /// applyWrench(). A body has one commanded wrench, beside whatever applyWrench() has added, so a controller
  /// may send as often as it likes. `seconds` is its time-out. The first command wakes all. A command that
  /// replaces another wakes nothing: the first one keeps the island awake. Cost: a search of all wrenches.
  void commandWrench(BodyId id, const Vec3& force_W, const Vec3& torque_W, const Vec3& point_W,
                     double seconds);
  /// Pulls a body by a user force until release(). It replaces the grab or hold of the body. Throws
  /// InvalidInput unless the body is dynamic and `grab` is within its ranges. The first grab wakes all, and
  /// keeps the island of the body awake. Another grab of a grabbed body wakes nothing. Cost: a search of all
  /// grabs.
  void grab(BodyId id, const Grab& grab);
  /// Moves a body of any kind to a kinematic target until release(), whatever it meets. The distance decays
  /// with a time constant of 1/30 s. A frozen body stays. It replaces the grab of the body. Throws
  /// InvalidInput for a target beyond Limits::max_position and for a quaternion whose norm is not 1e-3 to
  /// 1e3. The first target wakes all. Another target for a held body wakes nothing. Cost: a search of all
  /// holds.
  void hold(BodyId id, const Pose& target);
  /// Ends the grab or hold of a body. A grabbed body keeps its velocity; a held one is at rest. It is an edit
  /// also for a body that is neither. Wakes all. Cost: a search of all grabs and holds.
  void release(BodyId id);
  /// Ends all grabs and holds, each as release() does. No edit where there are none.
  void releaseAll();

  // --- surroundings

  /// Sets the gravity in W, m/s², of a length of at most Limits::max_gravity; zero is none. Wakes all. Cost:
  /// an analysis of n bodies.
  void setGravity(const Vec3& gravity_W);
  /// Sets the air. Empty takes it away, and the wind with it. Throws InvalidInput for a density out of range.
  /// Wakes all. Cost: an analysis of n bodies.
  void setAir(const std::optional<Air>& air);
  /// Sets the wind. Empty is air at rest. Throws InvalidInput for wind in a world without air, and for a
  /// velocity or gust out of range. Wakes all. Cost: an analysis of n bodies.
  void setWind(const std::optional<Wind>& wind);
  /// Changes the solver settings. Bodies keep their state, bit for bit. It does not count in edits(). Throws
  /// InvalidInput for faulty settings. Wakes all. Cost: an analysis of n bodies.
  void setFidelity(const Setting& setting);
  /// Sets the goal by which a Governor changes the solver settings; empty: none. The world itself does not
  /// follow it. Throws InvalidInput for a faulty goal. It wakes nothing and does not count in edits().
  void setGoal(const std::optional<Goal>& goal);
  /// Sets the fluid. Empty takes it away. Throws InvalidInput for a density or level out of range. Wakes all.
  /// Cost: an analysis of n bodies.
  void setFluid(const std::optional<Fluid>& fluid);
  /// Replaces all overrides of effects. Effects that are not in it are detected. Bodies keep their state, bit
  /// for bit. Never throws. Wakes all. Cost: an analysis of n bodies.
  void setEffects(const EffectOverrides& effects);

  // --- journal

  /// Calls `journal` after each change by a function above, with the Command that makes it again: once for each
  /// body that releaseAll() releases. Empty: no journal. A move takes the journal along, a copy has none. It must not change the world. Cost: none without it.
  void setJournal(std::function<void(const Command&)> journal);

  // --- time

  /// Advances by the scene's step, in Setting::divisions equal parts. Never throws: trouble is in the report.
  /// The report is valid until the next step. Wakes the islands that a moving body comes near. Puts islands
  /// to sleep that have been at rest for 0.5 s, where Effect::Sleeping is on. Cost: see StepReport::seconds
  /// and pipeline(). A sleeping body costs its bounds in the broad phase.
  const StepReport& step();

  /// Sets how many threads a step may use, 1 to 256; it is 1 at first, and in a copy. What a step does is the same
  /// for every number, bit for bit. The threads sleep between steps. No edit. Throws InvalidInput for another
  /// number.
  void setThreads(unsigned threads);
  /// The last value given to setThreads(); fewer once the system could not start as many.
  unsigned threads() const;

  // --- reading

  double time() const;          ///< physics time since the scene began, s
  std::uint64_t steps() const;  ///< steps since the scene began; divisions do not count
  /// Edit counter, 1 for a new world. It grows with every edit. Changes of the solver settings and of the
  /// goal do not count, nor does what a step does by itself: the end of a wrench, a body that is frozen.
  std::uint64_t edits() const;
  /// Number of analyses of single bodies so far, each for the effects that the body needs. An edit analyses
  /// the bodies that it changes. It analyses all bodies where it switches an effect, changes which bodies can
  /// collide, or wakes sleeping bodies.
  std::uint64_t bodiesAnalysed() const;
  const SceneDef& scene() const;  ///< settings as they are now; `bodies` is empty. Valid as long as the world
  /// The scene as it is now, bodies and velocities included. A frozen body is static in it. Wrenches, grabs
  /// and holds are left out. Cost: a copy of n definitions.
  SceneDef capture() const;
  /// The rest of a saved state, which capture() leaves out. Cost: n bodies and all contact points.
  SavedState captureState() const;
  /// captureState(), and what that leaves out: grabs, holds and which bodies are frozen. With capture() it makes
  /// a world of the same stateHash(). It is meant for recordings. A saved state that people load again should
  /// have no grab, since who held the body is gone. Cost: that of captureState().
  SavedState captureExactState() const;
  /// The descriptions of all bodies in canonical order; never null. Cost: a copied pointer, or n descriptions
  /// after an edit that changed one.
  std::shared_ptr<const std::vector<BodyDescription>> bodies() const;
  /// The states of all bodies, in the order of bodies(): Snapshot::states alone. Cost: n states.
  std::vector<BodyState> states() const;
  /// The contact points of the last step: Snapshot::contacts alone. Cost: all contact points.
  std::vector<ContactPoint> contacts() const;
  /// The world as it is now, all but what a Simulator adds. Cost: n states, all contact points, and the costs
  /// of bodies(), pipeline(), totals() and stateHash().
  Snapshot snapshot() const;
  /// The stages of the step in their order: whether each runs, why, and the wall time and the items of the
  /// last step. Cost: a few dozen texts, and a count of n bodies and all contacts.
  std::vector<StageInfo> pipeline() const;
  /// Hash of what decides the next steps: bodies, contact forces, wrenches, grabs, holds, sleep, settings,
  /// seed and time. Equal worlds have equal hashes. Cost: n bodies and all contact points.
  std::uint64_t stateHash() const;
  /// Energy (J) and momentum (in W) of the dynamic bodies, computed anew by each call. Cost: n bodies.
  Totals totals() const;

  struct Impl;  ///< private

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace rbs
