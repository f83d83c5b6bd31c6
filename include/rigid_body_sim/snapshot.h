// SPDX-License-Identifier: BSD-3-Clause
// Snapshots of a world: immutable copies, safe to keep and to read from any thread.
#pragma once

#include "rigid_body_sim/scene.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace rbs {

/// Description of a body: the properties that change only by an edit, or when the body is frozen.
struct BodyDescription {
  BodyId id;                          ///< handle of the body
  std::string name;                   ///< name, unique in the world, never empty
  Shape shape;                        ///< shape in B
  BodyKind kind = BodyKind::Dynamic;  ///< how it moves
  double mass = 0.0;                  ///< kg, also for a body that forces do not move; 0 for a plane
  double density = 0.0;               ///< mass over volume, kg/m³; 0 for a plane
  Vec3 inertia = Vec3::Zero();        ///< principal moments about the axes of B, kg m²; 0 for a plane
  Material material;                  ///< friction and so on; the drag coefficient is always given
  Color color{};                      ///< red, green, blue, alpha
  std::uint32_t group = 1,            ///< see BodyDef::group
      mask = 0xffffffffu;             ///< see BodyDef::mask
  /// Whether the body is quarantined: its state was not finite or exceeded Limits. It stands where it was
  /// before that step. World::editBody() with a pose or a kind ends the quarantine.
  bool frozen = false;
};

/// The state of a body, which every step changes.
struct BodyState {
  BodyId id;    ///< handle of the body
  Pose pose;    ///< pose of B in W
  Twist twist;  ///< velocity at the centre of mass, in W; zero for a body that sleeps
  /// What took it through the last step, or through the last division of that. "": nothing yet, or the body is
  /// not moved by forces; "ballistic": gravity alone; "flight": it touched nothing; "asleep"; else
  /// IslandResiduals::method of its island.
  const char* method = "";
  /// Its island in that step, by the oldest body in it. A sleeping body has that with which it fell asleep.
  /// Not valid where `method` is "" or "ballistic".
  BodyId island;
};

/// One contact point: two bodies a and b touch or nearly touch there.
///
/// Points are those at the end of the step, and those that have opened in it after they had pushed. Impulses
/// are over the whole step, impacts included: a body's momentum changes by its loads and by these, to
/// rounding. The exceptions are bodies that overlap deeply, and at the fast settings those that turn by more
/// than 128 rad in a step or travel 128 times their size: they are kept from gaining energy. Of a body that meets a heap
/// of many others in that step the loads may act for longer than the step, by no more than its length
/// (docs/performance.md).
/// `normal_impulse n_W + friction_impulse` is the whole impulse from a to b at the point, also where the
/// normal has turned within the step. A contact of sleeping bodies reports the forces with which they fell
/// asleep, times the step.
struct ContactPoint {
  BodyId a,                              ///< first body; it was created before b
      b;                                 ///< second body
  Vec3 p_W = Vec3::Zero();               ///< position in W, midway between the two surfaces, m
  Vec3 n_W = Vec3::UnitZ();              ///< unit normal in W, from a to b
  double separation = 0.0;               ///< along the normal, when last found, m; negative is penetration
  double normal_impulse = 0.0;           ///< sum over the step, N s, >= 0
  Vec3 friction_impulse = Vec3::Zero();  ///< on b, sum over the step, in W, N s
  /// For how many steps the two bodies have touched, up to this one; the same for all points of the two. They touch in a
  /// step in which one of these points pushes with more than a millionth of the lighter body's weight. Two pushes with a gap
  /// between are two touches: what bounces in each step has 1 each time. 1: they began in this step; 0: they do not touch.
  std::uint64_t touching_steps = 0;
};

/// One row of the pipeline: a stage of the step, whether it runs, why, and what it costs.
struct StageInfo {
  std::string name;         ///< "forces.drag"
  bool active = false;      ///< whether the scene needs it
  std::string reason;       ///< why it is or is not needed, in words and numbers
  std::uint64_t items = 0;  ///< number of its items (see `unit`) in the last step
  /// What its items are: "bodies", "pairs", "points", …, "body" where there is one. Empty: they are not counted.
  std::string unit;
  /// Wall time in the last step, s. 0 for a stage that did not run, and for a part of another stage that is
  /// not timed by itself. That of islands.advance includes its parts, which follow it.
  double seconds = 0.0;
  std::string part_of;  ///< name of the stage that it is a part of; empty: it is a stage of the step itself
};

/// Trouble at run time, with its remedy.
struct Warning {
  /// "non_finite": a body was frozen. "too_fast": a body was slowed down to Limits::max_speed or
  /// Limits::max_spin. "impact_budget": too many impacts in a step. "overlap": bodies overlap deeply after an
  /// edit. "unsolved": no contact forces obey Coulomb's law; soft contacts take their place. "solve_budget":
  /// the exact solves of an island take more work than a step may, and it ends by the best impulses found, or
  /// by soft contacts. The work is counted and not timed, so equal worlds stay equal. "missed_contact": at the exact
  /// settings, contacts push a body into or through another, however often the step is taken.
  std::string kind;
  std::string text;  ///< what happened, to which body, and what to do

  /// Of equal kind and text.
  friend bool operator==(const Warning& a, const Warning& b) { return a.kind == b.kind && a.text == b.text; }
};

/// Solver residuals of one island (dynamic bodies that contacts connect), and how it went through the last
/// step. With Setting::divisions above 1 it covers the last division, of length h.
///
/// Residuals are the worst over all solves, dimensionless. The soft step gives them as fractions of g h,
/// where 9.81 m/s² stands in for g without gravity. The exact step gives them as fractions of the largest
/// speed that the loads add in h, or of the fastest closing speed where that is larger.
struct IslandResiduals {
  std::uint32_t bodies = 0,  ///< dynamic bodies
      contacts = 0;          ///< contact points, also those that nearly touch
  /// The solver: "soft_step", or the most expensive one that the exact step took: "warm_start" (the forces of
  /// the last step still held), "gauss_seidel", "newton", "interior_point", "admm".
  const char* method = "";
  /// Iterations of the exact step's solvers, trials included; 0: the forces of the last step still held.
  /// Always 0 for the soft step.
  std::uint32_t iterations = 0;
  double signorini = 0.0;    ///< closing speed at closed points, and normal speed at loaded ones
  double coulomb = 0.0;      ///< friction beyond the cone, as the speed that it makes
  double dissipation = 0.0;  ///< slip that friction does not oppose, or slip where it sticks
  /// Whether the exact solvers reached their tolerance. The soft step is true at the fast settings, which ask
  /// nothing of it, and false at the exact ones, where it stands in for them.
  bool converged = true;
  double deepest_penetration = 0.0;  ///< largest penetration depth, m, >= 0
  double energy_change = 0.0;        ///< change of kinetic and potential energy over h, J
  double turn = 0.0;                 ///< largest |w| h of its bodies, rad
};

/// Report of the last step. With Setting::divisions above 1, times, tests, impacts and warnings are those of
/// all divisions together, and the rest is that of the last one.
struct StepReport {
  double seconds = 0.0;             ///< wall time of the step, s
  std::uint32_t pairs = 0;          ///< candidate pairs of the broad phase
  std::uint64_t overlap_tests = 0;  ///< pairs of bounds that the broad phase compared to find them
  /// Queries of the narrow phase for pairs without a closed form. Those of bodies that took the step once more count each
  /// time; those that predict impacts after an impact do not count.
  std::uint64_t axis_queries = 0;
  std::uint64_t axes_kept = 0;  ///< those that the separating axis of the pair's last query answered
  std::uint32_t contacts = 0;   ///< contact points, also those that nearly touch
  std::uint32_t islands = 0;  ///< islands that the contact solver handled; bodies in free flight are in none
  std::uint32_t flying = 0;   ///< dynamic bodies in free flight
  std::uint32_t impacts = 0;  ///< impacts located in time and resolved in order
  /// Located impacts left to the contact solver: contacts stop the body as well, cutting a large island for them would cost too much,
  /// or the pair meets again and again with hardly any time between (inelastic collapse). Those beyond the budget of the warning
  /// "impact_budget" are not counted.
  std::uint32_t deferred_impacts = 0;
  /// Dynamic bodies that the step took once more, because contacts had pushed one into another that it was
  /// predicted to pass; each time counts. Where a sleeping body is reached, all dynamic bodies that are awake take the step once
  /// more.
  std::uint32_t repeated = 0;
  double deepest_penetration = 0;  ///< largest penetration depth at the end of the step, m, >= 0
  /// Residuals of the islands that have contact points, in the order of their first bodies.
  std::vector<IslandResiduals> residuals;
  std::vector<Warning> warnings;  ///< trouble of this step; empty: none
};

/// Energy and momentum, summed over the dynamic bodies that are not frozen.
struct Totals {
  double kinetic_energy = 0.0;           ///< J
  double potential_energy = 0.0;         ///< energy in the field of gravity, J, zero at the origin of W
  Vec3 momentum = Vec3::Zero();          ///< in W, kg m/s
  Vec3 angular_momentum = Vec3::Zero();  ///< about the origin of W, in W, kg m²/s
};

/// The air at the time of the snapshot.
struct AirState {
  bool air = false;              ///< whether the scene has air
  bool wind = false;             ///< whether the air moves
  double density = 0.0;          ///< kg/m³; 0 without air
  Vec3 mean = Vec3::Zero();      ///< mean velocity in W, m/s; zero without wind
  double gust = 0.0;             ///< standard deviation of each horizontal component, m/s; 0 is steady
  Vec3 velocity = Vec3::Zero();  ///< velocity now, gust included, in W, m/s; zero without wind
};

/// Error of solver settings, per second simulated.
struct ErrorRate {
  double distance = 0.0;  ///< error of the position of the worst body, m/s
  double angle = 0.0;     ///< error of the orientation of the worst body, rad/s
  double energy = 0.0;    ///< error of the total energy as a fraction (see Difference::energy), 1/s
};

/// The deviation between a world and a second run beside it with other solver settings, over one window of
/// time. The second run is finer, except where a Goal::max_error tries coarser settings.
struct ErrorEstimate {
  ErrorRate error;         ///< deviation of the two runs over `window`
  double window = 0.0;     ///< physics time that the two ran from a common state, s
  Setting setting,         ///< solver settings of the world
      beside;              ///< solver settings of the second run
  double beside_ms = 0.0;  ///< mean wall time that the second run adds to a step, ms
};

/// A warning of a step of a Simulator, with its number among all of them.
struct NumberedWarning {
  std::uint64_t number = 0;  ///< from 1 on; it goes on from world to world
  Warning warning;           ///< what the step said
};

/// A world at one instant between two steps: an immutable copy, which any thread may keep and read. Before
/// the first step, fields about the last step are empty or 0.
struct Snapshot {
  std::string scene;        ///< name of the scene
  double time = 0.0;        ///< physics time since the scene began, s
  std::uint64_t steps = 0;  ///< steps since the scene began
  double step = 0.0;        ///< length of a step, s
  /// Edit counter. It grows with every edit, load, reset, undo and redo. Changes of the solver settings and of
  /// the goal do not count, nor does what a step does by itself: the end of a wrench, a body that is frozen.
  std::uint64_t edits = 0;
  std::uint64_t description_version = 0;                       ///< grows when `bodies` changes
  std::shared_ptr<const std::vector<BodyDescription>> bodies;  ///< in canonical order; not null
  std::vector<BodyState> states;                               ///< same order as `bodies`
  /// Contact points of the last step, also those that nearly touch. Those between sleeping bodies are of the
  /// last step before their sleep. After a saved state is restored they have no geometry until the first
  /// step.
  std::vector<ContactPoint> contacts;
  std::vector<StageInfo> pipeline;  ///< stages of the step, in their order
  StepReport report;                ///< what the last step did
  Totals totals;                    ///< energy and momentum
  AirState air;                     ///< air and wind
  std::optional<Fluid> fluid;       ///< empty: there is none
  Vec3 gravity = Vec3::Zero();      ///< m/s², in W; also where Effect::Gravity is forced off
  EffectOverrides effects;          ///< effects forced on or off; the others are detected
  Setting fidelity;                 ///< solver settings
  std::optional<Goal> goal;         ///< goal by which they change; empty: they stay
  /// Governor::reason(): why the solver settings are what they are. Only a Simulator fills it; empty: no goal
  /// has changed them.
  std::string dial_reason;
  /// Governor::estimate(): error in the last window. Only a Simulator fills it; empty: there is none yet, or
  /// errors are not estimated.
  std::optional<ErrorEstimate> estimate;
  View view;               ///< where a viewer should stand
  std::uint64_t hash = 0;  ///< World::stateHash()

  // What the Simulator adds.
  bool paused = false;         ///< true also while a step request is under way
  std::uint64_t world = 0;     ///< number of the world, from 0: grows with every load, reset, undo and redo
  std::uint64_t recorded = 0;  ///< entries of a recording that it shows: Recorded::sequence of the next one
  double elapsed = 0.0;        ///< physics time simulated in all its worlds, s; never goes back
  std::string undo,            ///< the edit that Simulator::undo() takes back, in words; empty: none
      redo;                    ///< the undone edit that Simulator::redo() makes again; empty: none
  std::uint64_t revision = 0;  ///< number of the last edit of Simulator::apply(), load() or reset(). An
                               ///< undo goes back to an earlier number
  bool unsaved = false;        ///< whether no file holds the bodies as that edit has left them
  /// The last warnings of this world, the oldest first, 100 at most; not null. A warning that repeats in consecutive steps is
  /// listed once.
  std::shared_ptr<const std::vector<NumberedWarning>> warnings =
      std::make_shared<std::vector<NumberedWarning>>();
  double step_cpu_seconds = 0.0;  ///< CPU time of the last step, without what a Governor runs beside it, s

  /// Index of the body of this name in `bodies` and `states`, or -1. It searches all bodies.
  int find(const std::string& name) const;
  /// Index of this body in `bodies` and `states`, or -1. A binary search.
  int find(BodyId id) const;
};

}  // namespace rbs
