// SPDX-License-Identifier: BSD-3-Clause
// What a scene is: plain definitions with their defaults, and the check that finds every fault.
//
// A default stands here and nowhere else. What a scene does not mention is not simulated: an empty
// optional is an effect that is not there.
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

/// Surface and air properties of a body.
struct Material {
  /// Coulomb coefficient, >= 0; 0 is frictionless. A pair uses the geometric mean of its two.
  double friction = 0.6;
  /// Newton's coefficient, 0 (no rebound) to 1 (elastic). A pair uses the larger of its two.
  double restitution = 0.0;
  /// Dimensionless, >= 0. Empty means defaultDragCoefficient(): 0.47 (sphere, capsule) or 1.05.
  std::optional<double> drag_coefficient;
  /// What resists rolling and spinning on the spot, >= 0, as shares of a lever arm: a pair under the normal
  /// force N resists rolling with a torque of up to (c_a + c_b) R N and spinning with up to (s_a + s_b) R N,
  /// where 1/R = 1/R_a + 1/R_b; R_a is the radius of a sphere, capsule, cylinder or cone, and infinite for
  /// other shapes. A pair without a round body does not roll and feels neither. 0: none.
  double rolling_resistance = 0.0, torsional_resistance = 0.0;
};

enum class BodyKind {
  Dynamic,    ///< moved by forces
  Static,     ///< never moves
  Kinematic,  ///< moves with its given twist, whatever it meets
};

/// "dynamic", "static" or "kinematic".
const char* kindName(BodyKind kind);

/// The name of the frame W that nothing else may have, whatever nameFrames() says.
inline constexpr const char* kWorldName = "world";

/// The names that frames have outside of the core, in tf: that of W, and what stands in front of the names of
/// bodies. To be called before any thread reads a scene. Throws InvalidInput for what tf would not take.
void nameFrames(const std::string& world, const std::string& prefix);
const std::string& worldFrame();   ///< "world" unless nameFrames() said otherwise
const std::string& framePrefix();  ///< "" unless nameFrames() said otherwise

/// Red, green, blue, alpha, each 0 to 1.
using Color = std::array<float, 4>;

/// A body to be made.
struct BodyDef {
  /// Letters, digits, '_', '-' and '/', at most 64. First a letter or '_'; '/' parts it into names that are
  /// not empty. Not the name of the world's frame. Unique in the world. Empty: the world names it after its
  /// shape ("box_3").
  std::string name;
  Shape shape = Box{};
  Pose pose;
  Twist twist;  ///< must be zero for a static body
  BodyKind kind = BodyKind::Dynamic;
  std::optional<double> mass;     ///< kg, > 0. At most one of mass and density is given;
  std::optional<double> density;  ///< kg/m³, > 0. with neither, the density is kDefaultDensity.
  Material material;
  std::optional<Color> color;  ///< empty: chosen from the body's creation number
  /// Bodies i and j may collide when (i.group & j.mask) and (j.group & i.mask) are both non-zero.
  /// A mask of 0 collides with nothing and costs no broad phase.
  std::uint32_t group = 1;
  std::uint32_t mask = 0xffffffffu;
};

inline constexpr double kDefaultDensity = 1000.0;  ///< kg/m³, water
inline constexpr double kRoundedDrag = 0.47;       ///< drag coefficient of a sphere; taken for a capsule too
inline constexpr double kEdgedDrag = 1.05;  ///< drag coefficient of a box face; taken for all with edges

/// The drag coefficient of a body that is given none; 0 for a plane.
double defaultDragCoefficient(const Shape& shape);

/// Air at rest unless there is wind; its presence asks for drag.
struct Air {
  double density = 1.2;  ///< kg/m³, > 0
};

/// The velocity of the air. Needs air.
struct Wind {
  Vec3 velocity{4.0, 0.0, 0.0};  ///< mean, m/s, in W
  /// Standard deviation of the seeded fluctuation of each horizontal component, m/s, >= 0; 0 is steady.
  double gust = 0.0;
};

/// Still water, or any other fluid, that fills all space below a level. Bodies feel its weight (Archimedes)
/// and its drag; it is not moved by them, and the mass it would add to theirs is neglected.
struct Fluid {
  double density = 1000.0;  ///< kg/m³, > 0
  double level = 0.0;       ///< z of its surface in W, m
};

/// How finely contacts are solved: the dial from fast to exact.
enum class Fidelity {
  Preview,      ///< soft contacts, one sub-step: thousands of bodies on a laptop
  Interactive,  ///< soft contacts, eight sub-steps: dragging things in RViz
  Accurate,     ///< Coulomb's law on the exact cone to 1e-6, stops of sliding located in time: studies
  Reference,    ///< the same to 1e-12: what the others are compared with
};

/// All of them, from fast to exact.
inline constexpr std::array kFidelities{Fidelity::Preview, Fidelity::Interactive, Fidelity::Accurate,
                                        Fidelity::Reference};

/// "preview", "interactive", "accurate" or "reference".
const char* fidelityName(Fidelity fidelity);
/// The fidelity of this name; throws InvalidInput for any other name.
Fidelity fidelityNamed(const std::string& name);

/// Where the dial stands: one of its names, and numbers in the place of those behind the name.
struct Setting {
  Fidelity preset = Fidelity::Interactive;
  std::uint32_t divisions = 1;  ///< equal parts that a step is taken in, 1 to 1000
  std::optional<std::uint32_t>
      sub_steps;  ///< of the soft step, in each part, 1 to 1000; empty: preview 1, others 8
  /// Of the exact step: residuals in impulse and velocity that it stops at, as fractions of what gravity
  /// gives in a step, 1e-15 to 0.1; empty: accurate 1e-6, and on to 1e-9 where that is quick, reference
  /// 1e-12, others 1e-9.
  std::optional<double> tolerance;
  /// Wall time for the exact solves of a step, ms, 1e-6 to 1e6; empty: as long as they take. What is not
  /// solved by then keeps the best impulses found, and its certificate says so. Gives up equal results from
  /// run to run.
  std::optional<double> max_solve_ms;

  Setting() = default;
  Setting(Fidelity named) : preset(named) {}
  friend bool operator==(const Setting& a, const Setting& b) {
    return a.preset == b.preset && a.divisions == b.divisions && a.sub_steps == b.sub_steps &&
           a.tolerance == b.tolerance && a.max_solve_ms == b.max_solve_ms;
  }
  friend bool operator!=(const Setting& a, const Setting& b) { return !(a == b); }
};

/// What the dial is turned by while the simulation runs: one of the two.
struct Goal {
  std::optional<double> max_error;    ///< of the place of any body, m per second simulated, > 0
  std::optional<double> max_step_ms;  ///< wall time of a step, ms, > 0

  friend bool operator==(const Goal& a, const Goal& b) {
    return a.max_error == b.max_error && a.max_step_ms == b.max_step_ms;
  }
};

/// "interactive", or "interactive, 2 divisions, 16 sub-steps, tolerance 1e-09".
std::string settingName(const Setting& setting);

/// Where a viewer should stand: used by the pictures and offered to RViz.
struct View {
  Vec3 eye{8.0, -8.0, 5.0};    ///< m, in W
  Vec3 target{0.0, 0.0, 0.5};  ///< m, in W
};

/// A world to be made.
struct SceneDef {
  std::string name = "untitled";
  std::string property;           ///< one sentence: what the scene shows and how to see that it is right
  Vec3 gravity{0.0, 0.0, -9.81};  ///< m/s², in W; zero means no gravity
  double step = 1.0 / 60.0;       ///< s, 1e-6 to 1
  Setting fidelity;
  std::optional<Goal> goal;    ///< empty: the dial stays where it is put
  std::uint64_t seed = 1;      ///< of gusts and scattered bodies
  std::optional<Air> air;      ///< empty: no drag
  std::optional<Wind> wind;    ///< empty: air at rest; given without air is refused
  std::optional<Fluid> fluid;  ///< empty: no buoyancy
  EffectOverrides effects;     ///< empty: every effect is detected
  View view;
  std::vector<BodyDef> bodies;  ///< in canonical order
};

/// Limits beyond which a number is refused as absurd. They keep squares and products finite.
struct Limits {
  static constexpr double min_size = 1e-6, max_size = 1e6;        ///< m
  static constexpr double min_density = 1e-6, max_density = 1e9;  ///< kg/m³
  static constexpr double min_mass = 1e-18, max_mass = 1e18;      ///< kg
  static constexpr double max_position = 1e9;                     ///< m
  static constexpr int max_hull_points = 1'000'000, max_hull_vertices = 4096;
  static constexpr double max_speed = 1e6;  ///< m/s
  static constexpr double max_spin = 1e6;   ///< rad/s
  static constexpr double max_friction = 1e9;
  static constexpr double max_drag = 1e6;
  static constexpr double max_resistance = 1e6;
  static constexpr double max_wind = 1e4;                   ///< m/s
  static constexpr double max_gravity = 1e7;                ///< m/s²
  static constexpr double max_impulse = 1e15;               ///< N s, or N, or N m
  static constexpr double min_step = 1e-6, max_step = 1.0;  ///< s
  static constexpr int max_divisions = 1000, max_sub_steps = 1000;
  static constexpr double min_tolerance = 1e-15, max_tolerance = 0.1;
  static constexpr double min_goal = 1e-12, max_goal = 1e6;  ///< m/s, or ms
  static constexpr double min_solve_ms = 1e-6, max_solve_ms = 1e6;
};

/// Every fault of a setting of the dial, or of what turns it; empty when it is sound.
std::vector<Problem> validate(const Setting& setting);
std::vector<Problem> validate(const Goal& goal);
/// Every fault of one body by itself, with `path` in front; empty when it is sound.
std::vector<Problem> validate(const BodyDef& body, const std::string& path);
/// Every fault of a scene, duplicate names among them; empty when it is sound.
std::vector<Problem> validate(const SceneDef& scene);

}  // namespace rbs
