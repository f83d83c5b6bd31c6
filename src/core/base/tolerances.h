// SPDX-License-Identifier: BSD-3-Clause
// Tolerances of contacts that several solvers share; docs/tolerances.md has all of them.
#pragma once

namespace rbs {

/// Share of the smaller length of a pair within which points are kept whatever the speeds, so that resting
/// contacts do not flicker.
inline constexpr double kMargin = 0.01;
/// A gap below this share of the smaller length of its pair is closed in the exact step.
inline constexpr double kTouch = 1e-7;
/// Share of the smaller length from which an overlap is deep: no contact makes one, but edits and user forces
/// do.
inline constexpr double kDeep = 0.1;

}  // namespace rbs
