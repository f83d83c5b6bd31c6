// SPDX-License-Identifier: BSD-3-Clause
#include "base/checks.h"

#include "base/text.h"

namespace rbs {

void throwIfAny(const std::vector<Problem>& problems) {
  if (!problems.empty()) throw InvalidInput(problems);
}

bool isOrientation(const Quat& q) {
  const double norm = q.norm();
  return norm >= kMinQuaternionNorm && norm <= kMaxQuaternionNorm;
}

std::string textOf(const Vec3& v) {
  return '[' + text(v.x()) + ", " + text(v.y()) + ", " + text(v.z()) + ']';
}

void checkVector(const Vec3& v, double limit, const std::string& path, const char* unit,
                 std::vector<Problem>& problems) {
  if (v.allFinite() && v.cwiseAbs().maxCoeff() <= limit) return;
  problems.push_back({path, textOf(v), "finite, each component at most " + text(limit) + ' ' + unit});
}

void checkPositive(double value, double limit, const std::string& path, const char* unit,
                   std::vector<Problem>& problems) {
  if (value > 0.0 && value <= limit) return;
  problems.push_back({path, text(value), "above 0 and at most " + text(limit) + ' ' + unit});
}

}  // namespace rbs
