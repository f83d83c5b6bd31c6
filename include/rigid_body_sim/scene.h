// SPDX-License-Identifier: BSD-3-Clause
// The definition of a scene: plain structs with their defaults, and the check that finds every fault.
//
// Defaults stand here and nowhere else. An empty optional means that the scene does not have the thing, and
// that nothing is simulated for it.
#pragma once

#include "rigid_body_sim/effect.h"
#include "rigid_body_sim/shape.h"
#include "rigid_body_sim/types.h"

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace rbs {

/// Surface and drag properties of a body.
///
/// Rolling and torsional resistance: a pair under the normal force N resists rolling with a torque of up to
/// (c_a + c_b) R N, and spinning about the contact normal with a torque of up to (s_a + s_b) R N, where
/// 1/R = 1/R_a + 1/R_b. R_a is the radius of a sphere or capsule, and of a cylinder or cone that lies on its
/// side. It is infinite for other shapes, and for a cylinder or cone on its base. A pair without a round side
/// feels neither torque.
struct Material {
  /// Coulomb coefficient, 0 to Limits::max_friction; 0 is frictionless. A pair uses the geometric mean of its
  /// two, 1e4 at most: more holds no more.
  double friction = 0.6;
  /// Newton's coefficient, 0 (no rebound) to 1 (elastic). A pair uses the larger of its two.
  double restitution = 0.0;
  /// Drag coefficient, dimensionless, 0 to Limits::max_drag. It refers to the cross-section of a sphere, to
  /// the faces of a box, and to the mean projected area of other shapes. Empty means
  /// defaultDragCoefficient(): 0.47 (sphere, capsule) or 1.05.
  std::optional<double> drag_coefficient;
  double rolling_resistance = 0.0,  ///< c, dimensionless, 0 to Limits::max_resistance; 0 is none
      torsional_resistance = 0.0;   ///< s, dimensionless, 0 to Limits::max_resistance; 0 is none
};

/// How a body moves.
enum class BodyKind {
  Dynamic,    ///< moved by forces; never a plane
  Static,     ///< never moves, unless World::hold() moves it
  Kinematic,  ///< moves with its given twist, whatever it meets; forces and contacts do not change it
};

/// "dynamic", "static" or "kinematic".
const char* kindName(BodyKind kind);

/// The default name of the frame W. No body may have this name, whatever nameFrames() says.
inline constexpr const char* kWorldName = "world";

/// Sets the names that frames have outside of the core, in tf: the name of W, and the prefix of the names of
/// bodies. To be called before any thread reads a scene. Throws InvalidInput for a name that tf would not
/// take.
void nameFrames(const std::string& world, const std::string& prefix);
const std::string& worldFrame();   ///< name of W in tf: "world" unless nameFrames() set another
const std::string& framePrefix();  ///< prefix of body names in tf: "" unless nameFrames() set another

/// Red, green, blue, alpha, each 0 to 1.
using Color = std::array<float, 4>;

/// The definition of a body. validate() finds its faults.
struct BodyDef {
  /// Letters, digits, '_', '-' and '/', at most 64. First a letter or '_'; '/' parts it into names that are
  /// not empty. Not the name of the world's frame. Unique in the world. Empty: the world names it after its
  /// shape ("box_3").
  std::string name;
  Shape shape = Box{};  ///< shape in B; default: a cube of 0.5 m
  /// Pose of B in W. The position is at most Limits::max_position from the origin. The quaternion is
  /// normalised, and may have a norm of 1e-3 to 1e3.
  Pose pose;
  /// Velocity at the centre of mass, in W, at most Limits::max_speed and Limits::max_spin. It must be zero
  /// for a static body.
  Twist twist;
  BodyKind kind = BodyKind::Dynamic;  ///< how it moves; a plane must not be dynamic
  /// Mass, kg, Limits::min_mass to Limits::max_mass. At most one of mass and density is given, and neither
  /// for a plane.
  std::optional<double> mass;
  /// Density, kg/m³, Limits::min_density to Limits::max_density. With neither it is kDefaultDensity.
  std::optional<double> density;
  Material material;           ///< friction, restitution, drag and resistances
  std::optional<Color> color;  ///< empty: grey for a static body, else chosen from the creation number
  /// Collision groups that the body is in, one per bit. Bodies i and j may collide when (i.group & j.mask)
  /// and (j.group & i.mask) are both non-zero.
  std::uint32_t group = 1;
  /// Groups that the body may collide with, one per bit; see `group`. A mask of 0 collides with nothing and
  /// costs no broad phase.
  std::uint32_t mask = 0xffffffffu;
};

inline constexpr double kDefaultDensity = 1000.0;  ///< density of a body that is given none, kg/m³: water
inline constexpr double kRoundedDrag = 0.47;       ///< drag coefficient of a sphere; taken for a capsule too
inline constexpr double kEdgedDrag = 1.05;  ///< drag coefficient of a box face; taken for all with edges

/// The drag coefficient of a body that is given none; 0 for a plane.
double defaultDragCoefficient(const Shape& shape);

/// The air of a scene. It is at rest unless there is wind. Where there is air, drag is simulated.
struct Air {
  double density = 1.2;  ///< kg/m³, Limits::min_density to Limits::max_density

  /// Whether every field is equal.
  friend bool operator==(const Air& a, const Air& b) { return a.density == b.density; }
};

/// The velocity of the air. Needs Air.
struct Wind {
  Vec3 velocity{4.0, 0.0, 0.0};  ///< mean velocity in W, m/s, at most Limits::max_wind
  /// Standard deviation of the seeded fluctuation of each horizontal component, m/s, 0 to Limits::max_wind;
  /// 0 is steady.
  double gust = 0.0;

  /// Whether every field is equal.
  friend bool operator==(const Wind& a, const Wind& b) {
    return a.velocity == b.velocity && a.gust == b.gust;
  }
};

/// Still water, or any other fluid, that fills all space below a level. It acts on bodies by buoyancy and
/// drag. Bodies do not move it, and its added mass is neglected.
struct Fluid {
  double density = 1000.0;  ///< kg/m³, Limits::min_density to Limits::max_density
  double level = 0.0;       ///< z of its surface in W, m

  /// Whether every field is equal.
  friend bool operator==(const Fluid& a, const Fluid& b) {
    return a.density == b.density && a.level == b.level;
  }
};

/// The quality level of the solver, from fast to exact.
enum class Fidelity {
  Preview,  ///< soft contacts, four sub-steps: thousands of bodies on a laptop
  /// Soft contacts, eight sub-steps: dragging things in RViz. Small islands that are tall, slender, of large
  /// mass ratio or about to tip or slide go to the exact step while they move little.
  Interactive,
  Accurate,   ///< Coulomb's law on the exact cone to 1e-6, stops of sliding located in time: studies
  Reference,  ///< Coulomb's law to 1e-12, with more corrections: the reference for the others
};

/// All quality levels, from fast to exact.
inline constexpr std::array kFidelities{Fidelity::Preview, Fidelity::Interactive, Fidelity::Accurate,
                                        Fidelity::Reference};

/// "preview", "interactive", "accurate" or "reference".
const char* fidelityName(Fidelity fidelity);
/// The quality level of this name. Throws InvalidInput for any other name.
Fidelity fidelityNamed(const std::string& name);

/// Solver settings: a quality level, and numbers that override those behind its name.
struct Setting {
  Fidelity preset = Fidelity::Interactive;  ///< quality level, which gives the numbers that are left empty
  std::uint32_t divisions = 1;              ///< equal solver steps that each step is divided into, 1 to 1000
  /// Sub-steps (small steps) of the soft step in each division, 1 to 1000. Empty: 4 for preview, 8 for the
  /// others. Islands in which bodies move or turn fast take more.
  std::optional<std::uint32_t> sub_steps;
  /// Residuals in impulse and velocity at which the exact step stops, 1e-15 to 0.1. They are fractions of the
  /// speed that the loads add in a division, or of the fastest closing speed where that is larger. Empty:
  /// 1e-6 for accurate, and on to 1e-9 where that is quick; 1e-12 for reference; 1e-9 for interactive.
  std::optional<double> tolerance;
  /// Wall time after the start of a step at which its exact solves end, ms, 1e-6 to 1e6. Empty: they take as
  /// long as they need. What is not solved by then keeps the best impulses found, and its IslandResiduals
  /// have `converged` false. Results then differ from run to run.
  std::optional<double> max_solve_ms;

  /// The default settings: interactive.
  Setting() = default;
  /// The settings behind the name of a quality level.
  Setting(Fidelity named) : preset(named) {}
  /// Whether every field is equal. An empty field differs from the preset's own number.
  friend bool operator==(const Setting& a, const Setting& b) {
    return a.preset == b.preset && a.divisions == b.divisions && a.sub_steps == b.sub_steps &&
           a.tolerance == b.tolerance && a.max_solve_ms == b.max_solve_ms;
  }
  /// Whether some field differs.
  friend bool operator!=(const Setting& a, const Setting& b) { return !(a == b); }
};

/// The goal of adaptive accuracy control: a Governor changes the solver settings by it. Exactly one of the
/// two is given.
struct Goal {
  /// Largest error of the position of any body, m per second simulated, Limits::min_goal to Limits::max_goal.
  std::optional<double> max_error;
  /// Longest mean wall time of a step, ms, Limits::min_goal to Limits::max_goal. Results then differ from run
  /// to run.
  std::optional<double> max_step_ms;

  /// Whether both fields are equal.
  friend bool operator==(const Goal& a, const Goal& b) {
    return a.max_error == b.max_error && a.max_step_ms == b.max_step_ms;
  }
};

/// "interactive", or "interactive, 2 divisions, 16 sub-steps, tolerance 1e-09".
std::string settingName(const Setting& setting);

/// Where a viewer should stand and look. Pictures use it, and RViz is offered it. The two points must differ.
struct View {
  Vec3 eye{8.0, -8.0, 5.0};    ///< where the viewer stands, in W, m
  Vec3 target{0.0, 0.0, 0.5};  ///< where the viewer looks, in W, m
};

/// The definition of a scene, which a World is made of. validate() finds its faults.
struct SceneDef {
  std::string name = "untitled";  ///< name of the scene; readScene() puts the file's in place of the default
  std::string property;           ///< one sentence: what the scene shows and how to see that it is right
  Vec3 gravity{0.0, 0.0, -9.81};  ///< m/s², in W, at most Limits::max_gravity; zero means no gravity
  double step = 1.0 / 60.0;       ///< length of a step, s, 1e-6 to 1
  Setting fidelity;               ///< solver settings to begin with
  std::optional<Goal> goal;       ///< goal by which a Governor changes them; empty: they stay
  std::uint64_t seed = 1;         ///< seed of the gusts, and of random placement in a scene file
  std::optional<Air> air;         ///< empty: vacuum, no drag by air
  std::optional<Wind> wind;       ///< empty: air at rest; given without air is refused
  std::optional<Fluid> fluid;     ///< empty: no buoyancy
  EffectOverrides effects;        ///< effects forced on or off; empty: every effect is detected
  View view;                      ///< where a viewer should stand
  std::vector<BodyDef> bodies;    ///< in canonical order: they are created in this order
};

/// Limits beyond which a number is refused as absurd. They keep squares and products finite.
struct Limits {
  static constexpr double min_size = 1e-6,     ///< smallest full extent of a shape, m
      max_size = 1e6;                          ///< largest full extent of a shape, m
  static constexpr double min_density = 1e-6,  ///< smallest density of a body, the air or a fluid, kg/m³
      max_density = 1e9;                       ///< largest density of a body, the air or a fluid, kg/m³
  static constexpr double min_mass = 1e-18,    ///< smallest mass of a body, kg
      max_mass = 1e18;                         ///< largest mass of a body, kg
  static constexpr double max_position = 1e9;  ///< largest coordinate or distance from the origin, m
  static constexpr int max_hull_points = 1'000'000,  ///< most points that a convex hull is made of
      max_hull_vertices = 4096;                      ///< most vertices of a convex hull
  static constexpr double max_speed = 1e6;           ///< largest linear velocity, m/s
  static constexpr double max_spin = 1e6;            ///< largest angular velocity, rad/s
  static constexpr double max_friction = 1e9;        ///< largest Material::friction
  static constexpr double max_drag = 1e6;            ///< largest Material::drag_coefficient
  static constexpr double max_resistance = 1e6;  ///< largest rolling or torsional resistance of a Material
  static constexpr double max_wind = 1e4;        ///< largest mean wind and largest gust, m/s
  static constexpr double max_gravity = 1e7;     ///< largest gravity, m/s²
  /// Largest component of an impulse (N s), force (N) or torque (N m).
  static constexpr double max_impulse = 1e15;
  static constexpr double min_step = 1e-6,        ///< shortest step, s
      max_step = 1.0;                             ///< longest step, s
  static constexpr int max_divisions = 1000,      ///< most divisions of a step, Setting::divisions
      max_sub_steps = 1000;                       ///< most sub-steps, Setting::sub_steps
  static constexpr double min_tolerance = 1e-15,  ///< smallest Setting::tolerance
      max_tolerance = 0.1;                        ///< largest Setting::tolerance
  static constexpr double min_goal = 1e-12,       ///< smallest number of a Goal, m/s or ms
      max_goal = 1e6;                             ///< largest number of a Goal, m/s or ms
  static constexpr double min_solve_ms = 1e-6,    ///< smallest Setting::max_solve_ms, ms
      max_solve_ms = 1e6;                         ///< largest Setting::max_solve_ms, ms
};

/// Every fault of solver settings. Empty when they are sound.
std::vector<Problem> validate(const Setting& setting);
/// Every fault of a goal. Empty when it is sound.
std::vector<Problem> validate(const Goal& goal);
/// Every fault of one body by itself, with `path` in front. Empty when it is sound.
std::vector<Problem> validate(const BodyDef& body, const std::string& path);
/// Every fault of a scene, duplicate names among them. Empty when it is sound. Cost: all bodies.
std::vector<Problem> validate(const SceneDef& scene);

}  // namespace rbs
