// SPDX-License-Identifier: BSD-3-Clause
// What stands behind the names of the dial: THE table of settings.
#pragma once

#include "rigid_body_sim/scene.h"

namespace rbs {

struct FidelitySettings {
  bool exact;               ///< contacts by the exact step, else by the soft step
  bool promotes;            ///< hands small islands that the soft step does badly to the exact step
  std::uint32_t sub_steps;  ///< of the soft step
  bool all_points;          ///< solves every point of a manifold, else the four that span most of it
  double tolerance;  ///< of the exact step: residuals in impulse and velocity, fractions of their units
  double aim;        ///< likewise: where a few iterations more reach it
  int corrections;   ///< of the exact step: solves that the curvature of a drift may ask for anew
  int cuts;          ///< likewise: contact points, summed over the times that stops of sliding may cut a step
  /// Closing speed below which an impact is left to the contact solver, as a fraction of what gravity adds in
  /// a step; and the gap too small to matter, as a fraction of the smaller length.
  double slowest_impact, smallest_gap;
  /// Share of the step within which further meetings of a pair count as inelastic collapse.
  double no_time;
};

constexpr FidelitySettings settingsNamed(Fidelity fidelity) {
  switch (fidelity) {
    case Fidelity::Preview:
      return {false, false, 1, false, 1e-6, 1e-6, 0, 0, 0.5, 1e-6, 1e-3};
    case Fidelity::Interactive:
      return {false, true, 8, true, 1e-9, 1e-9, 0, 0, 0.5, 1e-6, 1e-3};
    case Fidelity::Accurate:
      return {true, false, 8, true, 1e-6, 1e-9, 1, 400, 1e-5, 1e-12, 1e-6};
    case Fidelity::Reference:
      break;
  }
  return {true, false, 8, true, 1e-12, 1e-12, 4, 10000, 1e-7, 1e-12, 1e-6};
}

inline FidelitySettings settingsOf(const Setting& setting) {
  FidelitySettings settings = settingsNamed(setting.preset);
  settings.sub_steps = setting.sub_steps.value_or(settings.sub_steps);
  if (setting.tolerance) settings.tolerance = settings.aim = *setting.tolerance;
  return settings;
}

}  // namespace rbs
