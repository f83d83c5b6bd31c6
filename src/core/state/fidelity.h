// SPDX-License-Identifier: BSD-3-Clause
// The solver settings behind each quality level: THE table of settings.
#pragma once

#include "rigid_body_sim/scene.h"

namespace rbs {

struct SolverSettings {
  bool exact = false;             ///< contacts by the exact step, else by the soft step
  bool promotes = false;          ///< hands small islands that the soft step does badly to the exact step
  std::uint32_t sub_steps = 1;    ///< of the soft step
  bool all_points = true;         ///< solves every point of a manifold, else the four that span most of it
  double tolerance = 0.0;         ///< of the exact step: residuals in impulse and velocity, as Setting says
  double wanted_tolerance = 0.0;  ///< what a few iterations more may reach, at most `tolerance`
  int corrections = 0;  ///< of the exact step: solves that the curvature of a drift may ask for anew
  /// Of the exact step: contact points, summed over the times that stops of sliding may cut a step.
  int cuts = 0;
  /// Closing speed below which an impact is left to the contact solver, as a fraction of what gravity adds in
  /// a step.
  double slowest_impact = 0.0;
  double smallest_gap = 0.0;  ///< gap too small to matter, as a fraction of the smaller length
  double collapse_interval =
      0.0;  ///< share of the step in which further impacts of a pair count as inelastic collapse
};

/// Four sub-steps, and four points of a manifold. With fewer, a wall of 60 rows comes down and takes longer, since
/// its bodies then drift so far in a step that their points are found anew (docs/performance.md).
constexpr SolverSettings previewSettings() {
  SolverSettings s;
  s.exact = false;
  s.promotes = false;
  s.sub_steps = 4;
  s.all_points = false;
  s.tolerance = 1e-6;
  s.wanted_tolerance = 1e-6;
  s.corrections = 0;
  s.cuts = 0;
  s.slowest_impact = 0.5;
  s.smallest_gap = 1e-6;
  s.collapse_interval = 1e-3;
  return s;
}

/// Eight sub-steps, and the exact step for small islands that need it.
constexpr SolverSettings interactiveSettings() {
  SolverSettings s;
  s.exact = false;
  s.promotes = true;
  s.sub_steps = 8;
  s.all_points = true;
  s.tolerance = 1e-9;
  s.wanted_tolerance = 1e-9;
  s.corrections = 0;
  s.cuts = 0;
  s.slowest_impact = 0.5;
  s.smallest_gap = 1e-6;
  s.collapse_interval = 1e-3;
  return s;
}

/// The exact step to a millionth, and further where that is quick.
constexpr SolverSettings accurateSettings() {
  SolverSettings s;
  s.exact = true;
  s.promotes = false;
  s.sub_steps = 8;
  s.all_points = true;
  s.tolerance = 1e-6;
  s.wanted_tolerance = 1e-9;
  s.corrections = 1;
  s.cuts = 400;
  s.slowest_impact = 1e-5;
  s.smallest_gap = 1e-12;
  s.collapse_interval = 1e-6;
  return s;
}

/// The exact step to what doubles can tell.
constexpr SolverSettings referenceSettings() {
  SolverSettings s;
  s.exact = true;
  s.promotes = false;
  s.sub_steps = 8;
  s.all_points = true;
  s.tolerance = 1e-12;
  s.wanted_tolerance = 1e-12;
  s.corrections = 4;
  s.cuts = 10000;
  s.slowest_impact = 1e-7;
  s.smallest_gap = 1e-12;
  s.collapse_interval = 1e-6;
  return s;
}

constexpr SolverSettings settingsNamed(Fidelity fidelity) {
  switch (fidelity) {
    case Fidelity::Preview:
      return previewSettings();
    case Fidelity::Interactive:
      return interactiveSettings();
    case Fidelity::Accurate:
      return accurateSettings();
    case Fidelity::Reference:
      break;
  }
  return referenceSettings();
}

/// The numbers of its quality level, but for those that the setting gives itself.
inline SolverSettings resolved(const Setting& setting) {
  SolverSettings settings = settingsNamed(setting.preset);
  settings.sub_steps = setting.sub_steps.value_or(settings.sub_steps);
  if (setting.tolerance) settings.tolerance = settings.wanted_tolerance = *setting.tolerance;
  return settings;
}

}  // namespace rbs
