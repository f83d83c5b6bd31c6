// SPDX-License-Identifier: BSD-3-Clause
// Checks of the numbers of a request: each adds its faults to a list, so that all are reported at once.
#pragma once

#include "rigid_body_sim/types.h"

#include <string>
#include <vector>

namespace rbs {

void throwIfAny(const std::vector<Problem>& problems);

/// Every component finite and at most `limit` in magnitude.
void checkVector(const Vec3& v, double limit, const std::string& path, const char* unit,
                 std::vector<Problem>& problems);

/// Above 0 and at most `limit`.
void checkPositive(double value, double limit, const std::string& path, const char* unit,
                   std::vector<Problem>& problems);

/// Norms of a quaternion that is taken for an orientation. It need not be normalised, since numbers typed by hand never quite are. It
/// must have a direction beyond doubt, and is normalised on use.
inline constexpr double kMinQuaternionNorm = 1e-3, kMaxQuaternionNorm = 1e3;
/// False for NaN.
bool isOrientation(const Quat& q);

/// "[1, 0, 2.5]"
std::string textOf(const Vec3& v);

}  // namespace rbs
