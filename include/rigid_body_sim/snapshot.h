// SPDX-License-Identifier: BSD-3-Clause
// What readers see of a world: immutable copies, safe to keep and to read from any thread.
#pragma once

#include "rigid_body_sim/scene.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace rbs {

/// What changes only by an edit.
struct BodyDescription {
  BodyId id;
  std::string name;
  Shape shape;
  BodyKind kind = BodyKind::Dynamic;
  double mass = 0.0;            ///< kg; 0 where it has no meaning (a plane)
  double density = 0.0;         ///< kg/m³; 0 for a plane
  Vec3 inertia = Vec3::Zero();  ///< principal moments about the axes of B, kg m²
  Material material;
  Color color{};
  std::uint32_t group = 1, mask = 0xffffffffu;  ///< see BodyDef
  bool frozen = false;                          ///< quarantined after it became non-finite
};

/// What changes with every step.
struct BodyState {
  BodyId id;
  Pose pose;
  Twist twist;
};

/// One point where two bodies touch or nearly touch.
struct ContactPoint {
  BodyId a, b;
  Vec3 p_W = Vec3::Zero();               ///< midway between the two surfaces, m
  Vec3 n_W = Vec3::UnitZ();              ///< unit normal, from a to b
  double separation = 0.0;               ///< gap, m; negative is overlap
  double normal_impulse = 0.0;           ///< over the step, N s, >= 0
  Vec3 friction_impulse = Vec3::Zero();  ///< on b, over the step, N s
};

/// One row of the pipeline: a stage, whether it runs, why, and what it costs.
struct StageInfo {
  std::string name;         ///< "forces.wind"
  bool active = false;      ///< whether the scene needs it
  std::string reason;       ///< in words and numbers, for and against
  std::uint64_t items = 0;  ///< what it worked on in the last step
  std::string unit;      ///< what its items are: "bodies", "pairs", "points"; empty if they are not counted
  double seconds = 0.0;  ///< spent in the last step; 0 for one that did not run, or that is part of another
};

/// Trouble at run time, with its remedy.
struct Warning {
  std::string kind;  ///< "non_finite", "impact_budget"
  std::string text;  ///< what happened, to which body, and what to do
};

/// How a group of bodies that contacts tie together went through the last step, and how well it obeys the law
/// of contact at the end of its last solve. Speeds are fractions of g h (without gravity 9.81 m/s² stands in
/// for g).
struct IslandCertificate {
  std::uint32_t bodies = 0, contacts = 0;  ///< dynamic bodies; contact points
  /// What solved it: "soft_step", or of the exact step the dearest solver it took: "guess", "gauss_seidel",
  /// "newton", "interior_point", "admm".
  const char* method = "";
  std::uint32_t iterations =
      0;                   ///< of the solver, all solves of the step together; 0: the last forces still held
  double signorini = 0.0;  ///< closing speed at closed points, and speed at loaded ones
  double coulomb = 0.0;    ///< friction beyond the cone
  double dissipation = 0.0;  ///< slip that friction does not oppose, or slip where it sticks
  bool converged = true;     ///< the exact solvers reached their tolerance; always true for the soft step
  double deepest_penetration = 0.0;  ///< m
  double energy_change = 0.0;        ///< kinetic and potential, from the start of the step, J
  double turn = 0.0;                 ///< largest |w| h of its bodies, rad
};

/// What the last step did.
struct StepReport {
  double seconds = 0.0;                ///< wall time of the whole step
  std::uint32_t pairs = 0;             ///< candidate pairs of the broad phase
  std::uint64_t overlap_tests = 0;     ///< pairs of bounds that the broad phase compared to find them
  std::uint32_t contacts = 0;          ///< contact points given to the solver
  std::uint32_t islands = 0;           ///< groups of bodies that contacts tie together
  std::uint32_t flying = 0;            ///< dynamic bodies advanced in closed form
  std::uint32_t impacts = 0;           ///< impacts located in time and resolved in order
  std::uint32_t deferred_impacts = 0;  ///< impacts left to the contact solver, over budget
  double deepest_penetration = 0;      ///< m, >= 0, at the end of the step
  std::vector<IslandCertificate>
      certificates;  ///< of the groups in contact, in the order of their first bodies
  std::vector<Warning> warnings;
};

/// Sums over the dynamic bodies.
struct Totals {
  double kinetic_energy = 0.0;           ///< J
  double potential_energy = 0.0;         ///< J, zero at the origin of W
  Vec3 momentum = Vec3::Zero();          ///< kg m/s
  Vec3 angular_momentum = Vec3::Zero();  ///< about the origin of W, kg m²/s
};

/// The air as it is now.
struct AirState {
  bool air = false;              ///< whether the scene has air
  bool wind = false;             ///< whether the air moves
  double density = 0.0;          ///< kg/m³
  Vec3 mean = Vec3::Zero();      ///< m/s
  double gust = 0.0;             ///< m/s
  Vec3 velocity = Vec3::Zero();  ///< with the gust, now, m/s
};

/// By how much a setting goes astray for each second that is simulated: of the body with the largest error.
struct ErrorRate {
  double distance = 0.0;  ///< m/s
  double angle = 0.0;     ///< rad/s
  double energy = 0.0;    ///< share of the energy (see Difference), 1/s
};

/// What a second run of the same scene, beside it and more finely, has told of a window of time.
struct ErrorEstimate {
  ErrorRate error;          ///< by which the two went apart
  double window = 0.0;      ///< for how long they ran from a common state, s
  Setting setting, beside;  ///< of the two
  double beside_ms = 0.0;   ///< wall time that the second run adds to a step, ms
};

struct Snapshot {
  std::string scene;
  double time = 0.0;                      ///< physics time since the scene began, s
  std::uint64_t steps = 0;                ///< taken since the scene began
  double step = 0.0;                      ///< s
  std::uint64_t edits = 0;                ///< grows with every edit, load and reset; the dial does not count
  std::uint64_t description_version = 0;  ///< grows when `bodies` changes
  std::shared_ptr<const std::vector<BodyDescription>> bodies;  ///< in canonical order
  std::vector<BodyState> states;                               ///< same order as `bodies`
  std::vector<ContactPoint> contacts;
  std::vector<StageInfo> pipeline;
  StepReport report;
  Totals totals;
  AirState air;
  std::optional<Fluid> fluid;
  Vec3 gravity = Vec3::Zero();
  EffectOverrides effects;  ///< forced on or off; the others are detected
  Setting fidelity;
  std::optional<Goal> goal;               ///< that turns the dial
  std::string dial_reason;                ///< why it stands where it does; empty: nothing has turned it
  std::optional<ErrorEstimate> estimate;  ///< of the last window; empty where errors are not estimated
  View view;
  std::uint64_t hash = 0;  ///< of the state: equal hashes, equal futures

  // What the Simulator adds.
  bool paused = false;
  std::uint64_t world = 0;        ///< which world it is of: grows with every load and reset
  double elapsed = 0.0;           ///< physics time simulated in all its worlds, s; never goes back
  double step_cpu_seconds = 0.0;  ///< CPU time of the last step, without what a Governor runs beside it

  /// Position of this body in `bodies` and `states`, or -1.
  int find(const std::string& name) const;
  int find(BodyId id) const;
};

}  // namespace rbs
