// SPDX-License-Identifier: BSD-3-Clause
// The solver settings behind each quality level: THE table of settings.
#pragma once

#include "rigid_body_sim/scene.h"

#include <array>
#include <cstddef>

namespace rbs {

struct SolverSettings {
  bool exact;               ///< contacts by the exact step, else by the soft step
  bool promotes;            ///< hands small islands that the soft step does badly to the exact step
  std::uint32_t sub_steps;  ///< of the soft step
  bool all_points;          ///< solves every point of a manifold, else the four that span most of it
  double tolerance;         ///< of the exact step: residuals in impulse and velocity, as Setting says
  double wanted_tolerance;  ///< what a few iterations more may reach, at most `tolerance`
  /// Of the exact step: solves that the curvature of a drift may ask for anew. Bodies that touch no other have at least one.
  int corrections;
  /// Of the exact step: contact points, summed over the times that jumps of a force may cut a step. Where it `promotes`, of
  /// bodies that are alone.
  int cuts;
  /// Closing speed below which an impact is left to the contact solver, as a share of what gravity adds in a step.
  double slowest_impact;
  double smallest_gap;  ///< gap too small to matter, as a share of the smaller length
  /// Share of the step in which further impacts of a pair count as inelastic collapse.
  double collapse_interval;
};

/// By Fidelity: fast; fast, with the exact step for small islands that need it; exact to a millionth, and further where that
/// is quick; exact to what doubles can tell. With fewer than four sub-steps a wall of 60 rows comes down and takes longer,
/// since its bodies then drift so far in a step that their points are found anew (docs/performance.md).
// clang-format off
inline constexpr std::array<SolverSettings, 4> kSettings{{
    // exact promotes sub_steps all_points tolerance wanted corrections  cuts slowest_impact smallest_gap collapse_interval
    {  false,   false,        4,     false,     1e-6,  1e-6,          0,    0,           0.5,        1e-6,             1e-3},  // Preview
    {  false,    true,        8,      true,     1e-9,  1e-9,          0,  400,           0.5,        1e-6,             1e-3},  // Interactive
    {   true,   false,        8,      true,     1e-6,  1e-9,          1,  400,          1e-5,       1e-12,             1e-6},  // Accurate
    {   true,   false,        8,      true,    1e-12, 1e-12,          4, 10000,         1e-7,       1e-12,             1e-6},  // Reference
}};
// clang-format on

constexpr const SolverSettings& settingsNamed(Fidelity fidelity) {
  return kSettings[static_cast<std::size_t>(fidelity)];
}

/// The numbers of its quality level, but for those that the setting gives itself.
inline SolverSettings resolved(const Setting& setting) {
  SolverSettings settings = settingsNamed(setting.preset);
  settings.sub_steps = setting.sub_steps.value_or(settings.sub_steps);
  if (setting.tolerance) settings.tolerance = settings.wanted_tolerance = *setting.tolerance;
  return settings;
}

}  // namespace rbs
