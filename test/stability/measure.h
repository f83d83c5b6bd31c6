// SPDX-License-Identifier: BSD-3-Clause
// How the cases measure: sums over bodies, a world that is watched while it runs, and the free top by itself.
#pragma once

#include "make_scene.h"
#include "suite.h"

#include <array>
#include <functional>

namespace rbs::stability {

using test::kGravity;

inline constexpr double kFrame = 1.0 / 60.0;  ///< the step of the fast settings' figures, s

/// A scene of the catalogue.
SceneDef fromCatalogue(const std::string& name);

/// The text of a number in a format of printf.
std::string named(const char* format, double value);

BodyDef fixedBox(const std::string& name, const Vec3& size, const Vec3& p_W);

/// Six fixed boxes of thickness 0.5 m around an empty cube of this side, without gravity.
SceneDef room(double side);

/// Kinetic and potential energy, zero at the origin of W, summed in long double, J.
long double energyOf(const World& world);
/// Kinetic energy alone, J.
long double kineticEnergyOf(const World& world);
/// The scale of energy of a scene: its kinetic energy and its weight times the range of its heights, m g of
/// its highest body's size at least, J.
double energyScaleOf(const World& world);

/// The largest root-mean-square speed of a dynamic body's corners: |v| + |w| times its bounding radius, m/s.
double fastestPoint(const World& world);

/// A world that runs, and what it did at its worst meanwhile.
class Watch {
 public:
  Watch(SceneDef scene, Fidelity setting);

  World& world() { return world_; }
  void step();
  void run(double seconds);
  /// Steps until `until(world)` or for `seconds`; whether it came to hold.
  bool runUntil(double seconds, const std::function<bool(const World&)>& until);

  BodyState operator[](const std::string& name) const { return test::stateOf(world_, name); }

  double deepest() const { return deepest_; }            ///< m
  double growthInAStep() const { return step_growth_; }  ///< of the energy, of its scale
  double growthInAll() const { return total_growth_; }   ///< likewise, above the start
  std::uint64_t impacts() const { return impacts_; }
  bool finite() const { return finite_; }

  /// Writes what every setting promises of a passive scene: finite numbers, and energy that does not grow.
  void writePromises(Sheet& sheet) const;
  /// The first of them alone, for scenes on which something works.
  void writeFinite(Sheet& sheet) const;

 private:
  World world_;
  double scale_, start_, before_;
  double deepest_ = 0.0, step_growth_ = 0.0, total_growth_ = 0.0;
  std::uint64_t impacts_ = 0;
  bool finite_ = true;
};

/// A free rigid body in long double, by the classical Runge-Kutta method in many small steps: independent of
/// the simulator's own method, and exact for our purpose.
class FreeTop {
 public:
  /// Principal moments, orientation and angular velocity in W.
  FreeTop(const Vec3& moments, const Quat& q_WB, const Vec3& w_WB);

  void run(long double seconds, long double step);
  Quat orientation() const;
  Vec3 spinInBody() const;  ///< rad/s

 private:
  using Real3 = Eigen::Matrix<long double, 3, 1>;
  using Real4 = Eigen::Matrix<long double, 4, 1>;  // w, x, y, z
  Real3 bodySpin(const Real4& q) const;
  Real4 rate(const Real4& q) const;

  Real3 moments_, momentum_W_;
  Real4 q_;
};

/// The angle between two orientations, to full precision near zero, rad.
double angleBetween(const Quat& a, const Quat& b);

}  // namespace rbs::stability
