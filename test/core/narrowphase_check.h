// SPDX-License-Identifier: BSD-3-Clause
// What is wrong with the gap that the code finds for a pair: the figures it has to meet.
#pragma once

#include "core/hard_pairs.h"
#include "narrowphase/collide.h"

namespace rbs::oracle {

/// The worst that was met, as fractions of the size.
struct Worst {
  double distance = 0, depth = 0, normal = 0, along = 0, symmetry = 0;
  int apart = 0, overlapping = 0;
  int undecided = 0;  ///< normals that look off by more than asked, but by no more than the oracle may be
};

/// A direction in which the two shapes are apart, and how far off the true normal it may be at most: with d
/// the distance and s the separation along it, 1 - s/d >= 1 - cos of that angle.
struct Normal {
  Vec n;
  Real uncertainty;
};

/// The direction of the largest separation near `start`, by a golden section in a golden section. An oracle
/// that knows the distance to its last digit may know the normal to half of its digits only, and this may
/// know it better, in particular where features with corners meet.
inline Normal normalNear(const Pair& pair, const Vec& start, Real distance) {
  const RoundedCore a = coreOfShape(pair.a), b = coreOfShape(pair.b);
  const Vec3 origin = pair.X_WA.p_WB;
  return std::visit(
      [&](const auto& core_a, const auto& core_b) -> Normal {
        const auto x = placed(core_a, pair.X_WA, origin);
        const auto y = placed(core_b, pair.X_WB, origin);
        const Vec t1 = start.unitOrthogonal(), t2 = start.cross(t1);
        const auto direction = [&](Real u, Real v) { return Vec((start + u * t1 + v * t2).normalized()); };
        const auto separation = [&](Real u, Real v) { return separationAlong(x, y, direction(u, v)); };
        const auto best = [](const auto& value, Real reach) {
          const Real golden = (std::sqrt(Real(5)) - 1) / 2;
          Real lo = -reach, hi = reach, p = hi - golden * (hi - lo), q = lo + golden * (hi - lo);
          Real at_p = value(p), at_q = value(q);
          while (hi - lo > Real(1e-12)) {
            if (at_p > at_q)
              hi = q, q = p, at_q = at_p, p = hi - golden * (hi - lo), at_p = value(p);
            else
              lo = p, p = q, at_p = at_q, q = lo + golden * (hi - lo), at_q = value(q);
          }
          return (lo + hi) / 2;
        };
        constexpr Real kReach = 1e-3;
        const auto across = [&](Real u) { return best([&](Real v) { return separation(u, v); }, kReach); };
        const Real u = best([&](Real at) { return separation(at, across(at)); }, kReach);
        const Real v = across(u);
        const auto uncertainty = [&](Real proved) {
          return std::sqrt(2 * std::max(distance - proved, Real(1e-19) * distance) / distance);
        };
        const Real before = separation(0, 0), after = separation(u, v);
        if (before >= after) return {start, uncertainty(before)};
        return {direction(u, v), uncertainty(after)};
      },
      a.core, b.core);
}

/// How far off the true normal of two cores apart a direction may be, by a proof: with d the way between
/// their points farthest towards each other along n, s = n.d is at most the distance and |d| at least, so
/// that d is no farther off than n is from d. Much where features with corners meet, and without loss near
/// contact where they have none.
inline Real provenAngle(const Pair& pair, const Vec& n) {
  const RoundedCore a = coreOfShape(pair.a), b = coreOfShape(pair.b);
  const Vec3 origin = pair.X_WA.p_WB;
  return std::visit(
      [&](const auto& core_a, const auto& core_b) -> Real {
        const Vec d = supportOf(placed(core_b, pair.X_WB, origin), -n) -
                      supportOf(placed(core_a, pair.X_WA, origin), n);
        const Real angle = std::atan2(n.cross(d).norm(), n.dot(d));
        return 2 * angle;
      },
      a.core, b.core);
}

/// What is wrong with a pair, or nothing.
inline std::string faultOf(const Pair& pair, double depth_tolerance, Worst& worst) {
  const double size = sizeOf(pair);
  const Gap found = gap(pair.a, pair.X_WA, pair.b, pair.X_WB);
  if (!std::isfinite(found.distance) || !found.n_W.allFinite()) return "not finite";
  if (std::abs(found.n_W.norm() - 1.0) > 1e-13) return "length: normal of " + number(found.n_W.norm());
  const Judged judged = judge(pair, found.n_W);
  const double truth = static_cast<double>(judged.truth.gap);
  const std::string values = number(found.distance) + ", truth " + number(truth) + ", along its normal " +
                             number(static_cast<double>(judged.along)) + ", size " + number(size);

  const double least = truth - static_cast<double>(judged.slack);
  if (found.distance > 0.0 ? truth < -1e-13 * size : least > 1e-13 * size) return "class: " + values;
  const double error =
      found.distance > truth ? found.distance - truth : std::max(0.0, least - found.distance);
  if (truth > 0.0) {
    ++worst.apart;
    const double beyond = error / (size + 100.0 * truth);
    worst.distance = std::max(worst.distance, beyond);
    if (beyond > 1e-14) return "distance: " + values;
  } else {
    ++worst.overlapping;
    worst.depth = std::max(worst.depth, error / size);
    if (error > depth_tolerance * size) return "depth: " + values;
  }
  // The normal is that of the cores. It must prove the gap, as far as the rounding of their nearest points
  // lets it, and be the true one where there is but one.
  const double core_gap = truth + static_cast<double>(judged.radius);
  const double along = std::abs(static_cast<double>(judged.along - judged.truth.gap));
  const double turned = 1e-15 * size / std::abs(core_gap);
  const double allowed =
      (truth > 0.0 ? 1e-12 * truth : 0.0) + depth_tolerance * size + turned * (size + core_gap);
  worst.along = std::max(worst.along, along / allowed);
  if (along > allowed) return "normal: the gap along it is off by " + number(along) + "; " + values;
  const bool unique =
      core_gap > 1e-6 * size ||
      (core_gap<-1e-6 * size&& static_cast<double>(judged.truth.runner_up) + truth> 1e-6 * size);
  if (unique) {
    double angle = static_cast<double>((judged.truth.n - found.n_W.cast<Real>()).norm());
    if (angle > 1e-9 && core_gap > 0.0)
      angle = std::min(angle, static_cast<double>(provenAngle(pair, found.n_W.cast<Real>().normalized())));
    if (angle > 1e-9 && core_gap > 0.0) {
      const Normal normal = normalNear(pair, judged.truth.n, judged.truth.gap + judged.radius);
      angle = static_cast<double>((normal.n - found.n_W.cast<Real>()).norm());
      const bool off = angle > 1e-9;
      angle -= static_cast<double>(normal.uncertainty);
      if (off && angle <= 1e-9) ++worst.undecided;
    }
    worst.normal = std::max(worst.normal, angle);
    if (angle > 1e-9) return "normal: off by " + number(angle) + "; " + values;
  }
  // The points span the gap along the normal, and lie on the surfaces.
  const double span = (found.p_WB - found.p_WA - found.distance * found.n_W).norm();
  const double reach = size + std::abs(truth) + pair.X_WA.p_WB.norm();
  if (span > 1e-13 * reach)
    return "points: their difference is off the normal by " + number(span) + "; " + values;
  const Gap swapped = gap(pair.b, pair.X_WB, pair.a, pair.X_WA);
  const double asymmetry = std::abs(swapped.distance - found.distance) / (size + std::abs(truth));
  worst.symmetry = std::max(worst.symmetry, asymmetry);
  if (!(asymmetry <= 1e-14)) return "swapped: " + number(swapped.distance) + " for " + values;
  return "";
}

}  // namespace rbs::oracle
