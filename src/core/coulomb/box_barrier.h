// SPDX-License-Identifier: BSD-3-Clause
// The barrier of a box for interior point methods: a complementary pair for each finite bound, and Newton's method for them.
//
// With the speeds z of the two bounds, a row has
//   u = z_lo - z_hi,   z_lo, z_hi >= 0,   z_lo (r - lo) = t,   z_hi (hi - r) = t.
// Newton's step for wanted changes c of the two products,
//   dz_lo = (c_lo - z_lo dr)/(r - lo),   dz_hi = (c_hi + z_hi dr)/(hi - r),
// gives dr = e - D du with
//   1/D = z_lo/(r - lo) + z_hi/(hi - r),   e = D (c_lo/(r - lo) - c_hi/(hi - r)).
// A row without bounds has no pair, and u = 0: D is infinite. It is taken large instead, u = -dr/D: a step of the proximal
// point method (Rockafellar 1976; in an interior point, Friedlander and Orban 2012), exact where dr comes to rest, and defined
// where rows are redundant.
#pragma once

#include "coulomb/box_set.h"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rbs::coulomb {

/// Impulses with the speeds of their bounds, or changes of them; a speed is zero where there is no bound.
struct BoxPairs {
  Vec3 r = Vec3::Zero(), z_lo = Vec3::Zero(), z_hi = Vec3::Zero();

  void add(double part, const BoxPairs& change) {
    r += part * change.r, z_lo += part * change.z_lo, z_hi += part * change.z_hi;
  }
};

/// Newton's method for the pairs of one box at a place.
class BoxBarrier {
 public:
  /// @param response of its rows: speed for an impulse, > 0
  BoxBarrier(const BoxSet& set, double response) : set_(set), free_(kFree / response) {}

  /// The number of pairs.
  int count() const {
    int count = 0;
    for (int c = 0; c < 3; ++c) count += hasLo(c) + hasHi(c);
    return count;
  }
  /// A place with products of about `product`: in the middle of two bounds, or a length away from one.
  BoxPairs start(double product) const {
    BoxPairs pairs;
    const double length = std::sqrt(product);
    for (int c = 0; c < 3; ++c) {
      if (isFixed(c)) pairs.r[c] = set_.lo[c];
      if (hasLo(c) && hasHi(c)) pairs.r[c] = 0.5 * (set_.lo[c] + set_.hi[c]);
      if (hasLo(c) != hasHi(c)) pairs.r[c] = hasLo(c) ? set_.lo[c] + length : set_.hi[c] - length;
      if (hasLo(c)) pairs.z_lo[c] = product / (pairs.r[c] - set_.lo[c]);
      if (hasHi(c)) pairs.z_hi[c] = product / (set_.hi[c] - pairs.r[c]);
    }
    return pairs;
  }
  /// The place of impulses of the box and velocities, on the boundary.
  BoxPairs placeOf(const Vec3& impulses, const Vec3& u) const {
    BoxPairs pairs;
    pairs.r = impulses;
    for (int c = 0; c < 3; ++c) {
      if (hasLo(c)) pairs.z_lo[c] = std::max(u[c], 0.0);
      if (hasHi(c)) pairs.z_hi[c] = std::max(-u[c], 0.0);
    }
    return pairs;
  }
  double sumOfProducts(const BoxPairs& pairs) const {
    double sum = 0.0;
    for (int c = 0; c < 3; ++c) sum += loProduct(pairs, c) + hiProduct(pairs, c);
    return sum;
  }

  void linearise(const BoxPairs& pairs) {
    at_ = pairs;
    for (int c = 0; c < 3; ++c) {
      const double slope = (hasLo(c) ? pairs.z_lo[c] / (pairs.r[c] - set_.lo[c]) : 0.0) +
                           (hasHi(c) ? pairs.z_hi[c] / (set_.hi[c] - pairs.r[c]) : 0.0);
      D_[c] = isFixed(c) ? 0.0 : slope > 0.0 ? std::min(1.0 / slope, free_) : free_;
    }
  }
  /// How far the speeds of the pairs are from the velocity u of the rows.
  Vec3 off(const Vec3& u) const {
    Vec3 off = at_.z_lo - at_.z_hi - u;
    for (int c = 0; c < 3; ++c)
      if (isFixed(c)) off[c] = 0.0;
    return off;
  }
  /// How far the products are from t, as a fraction of it.
  double distance(double t) const {
    double worst = 0.0;
    for (int c = 0; c < 3; ++c) {
      if (hasLo(c)) worst = std::max(worst, std::abs(loProduct(at_, c) / t - 1.0));
      if (hasHi(c)) worst = std::max(worst, std::abs(hiProduct(at_, c) / t - 1.0));
    }
    return worst;
  }
  /// -dr/du, row by row.
  const Vec3& stiffness() const { return D_; }

  /// Wanted changes of the products.
  struct Wanted {
    Vec3 lo = Vec3::Zero(), hi = Vec3::Zero();
  };
  /// Towards t, with the second order of an earlier step where there is one.
  Wanted towards(double t, const BoxPairs* earlier) const {
    Wanted wanted;
    for (int c = 0; c < 3; ++c) {
      if (hasLo(c)) wanted.lo[c] = t - loProduct(at_, c) - (earlier ? earlier->z_lo[c] * earlier->r[c] : 0.0);
      if (hasHi(c)) wanted.hi[c] = t - hiProduct(at_, c) + (earlier ? earlier->z_hi[c] * earlier->r[c] : 0.0);
    }
    return wanted;
  }
  Wanted alongPath(double t) const {
    Wanted wanted;
    for (int c = 0; c < 3; ++c) wanted.lo[c] = hasLo(c) ? t : 0.0, wanted.hi[c] = hasHi(c) ? t : 0.0;
    return wanted;
  }
  /// e: the part of dr that du does not make.
  Vec3 constant(const Wanted& wanted) const {
    Vec3 e = Vec3::Zero();
    for (int c = 0; c < 3; ++c) {
      if (hasLo(c)) e[c] += D_[c] * wanted.lo[c] / (at_.r[c] - set_.lo[c]);
      if (hasHi(c)) e[c] -= D_[c] * wanted.hi[c] / (set_.hi[c] - at_.r[c]);
    }
    return e;
  }
  /// The change of the pairs for velocities that change by du.
  BoxPairs change(const Wanted& wanted, const Vec3& du) const {
    BoxPairs d;
    d.r = constant(wanted) - D_.cwiseProduct(du);
    for (int c = 0; c < 3; ++c) {
      if (hasLo(c)) d.z_lo[c] = (wanted.lo[c] - at_.z_lo[c] * d.r[c]) / (at_.r[c] - set_.lo[c]);
      if (hasHi(c)) d.z_hi[c] = (wanted.hi[c] + at_.z_hi[c] * d.r[c]) / (set_.hi[c] - at_.r[c]);
    }
    return d;
  }

  /// How many times a change can be added until a gap or a speed is negative.
  double room(const BoxPairs& pairs, const BoxPairs& change) const {
    double t = std::numeric_limits<double>::infinity();
    const auto keep = [&](double x, double d) {
      if (d < 0.0) t = std::min(t, -x / d);
    };
    for (int c = 0; c < 3; ++c) {
      if (hasLo(c)) keep(pairs.r[c] - set_.lo[c], change.r[c]), keep(pairs.z_lo[c], change.z_lo[c]);
      if (hasHi(c)) keep(set_.hi[c] - pairs.r[c], -change.r[c]), keep(pairs.z_hi[c], change.z_hi[c]);
    }
    return t;
  }
  /// A change as a fraction of the gaps and speeds.
  Eigen::Matrix<double, 12, 1> relative(const BoxPairs& pairs, const BoxPairs& change) const {
    Eigen::Matrix<double, 12, 1> fractions = Eigen::Matrix<double, 12, 1>::Zero();
    for (int c = 0; c < 3; ++c) {
      if (hasLo(c))
        fractions.segment<2>(4 * c) << change.r[c] / (pairs.r[c] - set_.lo[c]),
            change.z_lo[c] / pairs.z_lo[c];
      if (hasHi(c))
        fractions.segment<2>(4 * c + 2) << change.r[c] / (set_.hi[c] - pairs.r[c]),
            change.z_hi[c] / pairs.z_hi[c];
    }
    return fractions;
  }

 private:
  static constexpr double kFree = 1e7;  // D of a row without bounds, in units of 1/response

  // Also where no number lies between the two.
  bool isFixed(int c) const {
    const double room = set_.hi[c] - set_.lo[c];
    return room == 0.0 ||
           (std::isfinite(room) && room <= 1e-15 * (std::abs(set_.lo[c]) + std::abs(set_.hi[c])));
  }
  bool hasLo(int c) const { return std::isfinite(set_.lo[c]) && !isFixed(c); }
  bool hasHi(int c) const { return std::isfinite(set_.hi[c]) && !isFixed(c); }
  double loProduct(const BoxPairs& pairs, int c) const {
    return hasLo(c) ? pairs.z_lo[c] * (pairs.r[c] - set_.lo[c]) : 0.0;
  }
  double hiProduct(const BoxPairs& pairs, int c) const {
    return hasHi(c) ? pairs.z_hi[c] * (set_.hi[c] - pairs.r[c]) : 0.0;
  }

  BoxSet set_;
  double free_;
  BoxPairs at_;
  Vec3 D_ = Vec3::Zero();
};

}  // namespace rbs::coulomb
