// SPDX-License-Identifier: BSD-3-Clause
// Free tops of three different moments: no torque, so Euler's equations I w' = I w x w hold in the body's
// frame, and the orientation follows q' = q w / 2.
//
// Both right sides are quadratic, so the Taylor coefficients of a product are a convolution of those of its
// factors, and those of the solution follow one from another. With 24 of them, in long double and with a step
// of |w| h = 0.1, what is cut off is 0.1^24: the rounding of long double is all that remains.
#include "../problem.h"

#include <array>
#include <cmath>

namespace rbs::accuracy {
namespace {

using Real = long double;
constexpr int kTerms = 24;
using Series = std::array<Real, kTerms>;

struct Top {
  std::array<Real, 3> w;  // in the body's frame
  std::array<Real, 4> q;  // x, y, z, w
};

// Coefficient n of the product of two series.
Real product(const Series& a, const Series& b, int n) {
  Real sum = 0;
  for (int k = 0; k <= n; ++k) sum += a[k] * b[n - k];
  return sum;
}

Top advanced(const Top& top, const std::array<Real, 3>& I, Real h) {
  std::array<Series, 3> w{};
  std::array<Series, 4> q{};
  for (int i = 0; i < 3; ++i) w[i][0] = top.w[i];
  for (int i = 0; i < 4; ++i) q[i][0] = top.q[i];
  for (int n = 0; n + 1 < kTerms; ++n) {
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      w[i][n + 1] = (I[j] - I[k]) / I[i] * product(w[j], w[k], n) / (n + 1);
      q[i][n + 1] = (product(q[3], w[i], n) + product(q[j], w[k], n) - product(q[k], w[j], n)) / 2 / (n + 1);
    }
    q[3][n + 1] = -(product(q[0], w[0], n) + product(q[1], w[1], n) + product(q[2], w[2], n)) / 2 / (n + 1);
  }
  const auto sum = [h](const Series& a) {
    Real value = 0;
    for (int n = kTerms - 1; n >= 0; --n) value = value * h + a[n];
    return value;
  };
  return {{sum(w[0]), sum(w[1]), sum(w[2])}, {sum(q[0]), sum(q[1]), sum(q[2]), sum(q[3])}};
}

Quat exactOrientation(const Vec3& spin, const Vec3& moments, double time) {
  const std::array<Real, 3> I{moments.x(), moments.y(), moments.z()};
  Top top{{spin.x(), spin.y(), spin.z()}, {0, 0, 0, 1}};
  const int steps = static_cast<int>(std::ceil(time * spin.norm() / 0.1));
  for (int k = 0; k < steps; ++k) top = advanced(top, I, static_cast<Real>(time) / steps);
  return Quat(static_cast<double>(top.q[3]), static_cast<double>(top.q[0]), static_cast<double>(top.q[1]),
              static_cast<double>(top.q[2]))
      .normalized();
}

Problem freeRotation(const std::string& name, const std::string& sentence, const Vec3& spin,
                     double duration) {
  const Box box{Vec3(0.2, 0.4, 0.6)};
  Problem p;
  p.name = name;
  p.sentence = sentence;
  p.against = "exact";
  p.measure = "angle between the orientations at the end, rad";
  p.duration = duration;
  BodyDef top = body(box, 1.0, Vec3::Zero());
  top.twist.w_WB = spin;
  p.task.scene = scene({top}, Vec3::Zero());
  p.error = [=](double t, const std::vector<Motion>& m) {
    const Quat turn = exactOrientation(spin, momentsPerMass(box), t).conjugate() * m[0].pose.q_WB;
    return 2.0 * std::atan2(turn.vec().norm(), std::abs(turn.w()));
  };
  return p;
}

const RegisterProblem flipping(
    freeRotation("dzhanibekov",
                 "A box spins about its middle axis and flips over and over, for 10 s; "
                 "what is its orientation?",
                 Vec3(0.01, 10, 0.01), 10.0));
const RegisterProblem tumbling(freeRotation("slow_tumble",
                                            "A box tumbles slowly for 5 s; what is its orientation?",
                                            Vec3(1, 2, 3), 5.0));

}  // namespace
}  // namespace rbs::accuracy
