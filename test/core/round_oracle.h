// SPDX-License-Identifier: BSD-3-Clause
// The signed gap where a cylinder or a cone takes part, in long double.
//
// A solid of revolution is told by its profile in the half-plane (distance from the axis, height), so that
// the signed distance of a point is that of a point and a polygon. Against a polytope that is apart, the
// nearest points are on an edge, along which the distance is convex, or over a face, below the support point.
// Two solids of revolution apart are bracketed by a certificate: a point of A - B and a plane beyond which A
// - B lies. Where solids overlap, the depth is the least of the support function of A - B over all
// directions; it is scanned over the families of directions in which a smooth piece of the surface of A - B
// can look.
#pragma once

#include "core/polytope_oracle.h"

#include <functional>

namespace rbs::oracle {

using Vec2 = Eigen::Matrix<Real, 2, 1>;

struct Revolved {
  std::vector<Vec2> profile;  ///< (radius, height), from the top of the axis to its bottom, convex
  Vec p = Vec::Zero();
  Mat R = Mat::Identity();

  Vec support(const Vec& n) const {
    const Vec m = R.transpose() * n;
    const Real across = std::hypot(m[0], m[1]);
    Vec2 best = profile[0];
    for (const Vec2& q : profile)
      if (q[0] * across + q[1] * m[2] > best[0] * across + best[1] * m[2]) best = q;
    const Real x = across > 0 ? m[0] / across : 1, y = across > 0 ? m[1] / across : 0;
    return p + R * Vec(best[0] * x, best[0] * y, best[1]);
  }

  /// Signed distance of a point, and the unit direction in which it grows.
  Real signedDistance(const Vec& q_W, Vec* outward = nullptr) const {
    const Vec q = R.transpose() * (q_W - p);
    const Vec2 m(std::hypot(q[0], q[1]), q[2]);
    Real nearest = kInfinity, inside = kInfinity;
    Vec2 away = Vec2::Zero(), way_out = Vec2::Zero();
    for (std::size_t k = 0; k + 1 < profile.size(); ++k) {
      const Vec2 e = profile[k + 1] - profile[k], r = m - profile[k];
      const Vec2 n = Vec2(-e[1], e[0]).normalized();  // outward: the profile runs down on the outside
      const Real depth = -n.dot(r);
      if (depth < inside) inside = depth, way_out = n;
      const Real t = std::clamp(r.dot(e) / e.squaredNorm(), Real(0), Real(1));
      const Vec2 d = r - t * e;
      if (d.norm() < nearest) nearest = d.norm(), away = d;
    }
    const bool within = inside >= 0;
    if (outward != nullptr) {
      const Vec2 d = within || nearest == 0 ? way_out : Vec2(away / nearest);
      const Real x = m[0] > 0 ? q[0] / m[0] : 1, y = m[0] > 0 ? q[1] / m[0] : 0;
      *outward = R * Vec(d[0] * x, d[0] * y, d[1]);
    }
    return within ? -inside : nearest;
  }
};

inline Revolved cylinderOf(Real radius, Real half_length) {
  return {{{0, half_length}, {radius, half_length}, {radius, -half_length}, {0, -half_length}}};
}

/// Apex on +z; the origin a quarter of the height above the base.
inline Revolved coneOf(Real radius, Real height) {
  return {{{0, 0.75L * height}, {radius, -0.25L * height}, {0, -0.25L * height}}};
}

inline Revolved placed(Revolved solid, const Pose& pose, const Vec3& origin) {
  solid.R = rotationOf(pose);
  solid.p = pose.p_WB.cast<Real>() - origin.cast<Real>();
  return solid;
}

/// Where a function with one valley is lowest, by golden section down to rounding: slopes lose their sign
/// near touching, values do not.
template <class Function>
Real lowestOf(const Function& function, Real low, Real high) {
  constexpr Real kGolden = 0.61803398874989484820L;
  Real best = low, least = function(low);
  const auto value = [&](Real t) {
    const Real f = function(t);
    if (f < least) least = f, best = t;
    return f;
  };
  value(high);
  Real s = high - kGolden * (high - low), t = low + kGolden * (high - low), f = value(s), g = value(t);
  for (int k = 0; k < 82; ++k) {
    if (f < g)
      high = t, t = s, g = f, s = high - kGolden * (high - low), f = value(s);
    else
      low = s, s = t, f = g, t = low + kGolden * (high - low), g = value(t);
  }
  return best;
}

/// From the polytope A to the solid B, where these are apart; else some vector too long.
inline Vec shortest(const Polytope& a, const Revolved& b) {
  Vec best = b.support(Vec::UnitX()) - a.vertices[0];
  const auto keep = [&](const Vec& r) {
    if (r.squaredNorm() < best.squaredNorm()) best = r;
  };
  for (const auto& [i, j] : a.edges) {
    const Vec from = a.vertices[i], along = a.vertices[j] - from;
    const Real t = lowestOf([&](Real t) { return b.signedDistance(from + t * along); }, 0, 1);
    Vec outward;
    const Real distance = b.signedDistance(from + t * along, &outward);
    keep(-std::max(distance, Real(0)) * outward);
  }
  for (const Polytope::Face& face : a.faces) {
    const Vec q = b.support(-face.normal);
    const Real height = face.normal.dot(q - a.vertices[face.corners[0]]);
    if (height >= 0 && overFace(a, face, q)) keep(height * face.normal);
  }
  return best;
}

inline Vec supportOf(const Polytope& a, const Vec& n) {
  Vec best = a.vertices[0];
  for (const Vec& v : a.vertices)
    if (n.dot(v) > n.dot(best)) best = v;
  return best;
}
inline Vec supportOf(const Revolved& a, const Vec& n) {
  return a.support(n);
}

template <class A, class B>
Real separationAlong(const A& a, const B& b, const Vec& n) {
  return n.dot(supportOf(b, -n) - supportOf(a, n));
}

/// Finds from A to B by descent on certificates: with v the nearest point of what is known of B - A, the
/// point w of B - A farthest against v proves that the distance is at least v.w / |v|. Stops when that meets
/// |v|.
struct Certified {
  Vec v;
  Real lower, upper;  ///< lower <= 0: they may overlap
};
template <class A, class B>
Certified certifiedDistance(const A& a, const B& b, const Vec& guess) {
  const auto difference = [&](const Vec& n) -> Vec { return supportOf(b, -n) - supportOf(a, n); };
  std::vector<Vec> known{difference(guess)};
  Certified result{known[0], -kInfinity, known[0].norm()};
  for (int k = 0; k < 300 && result.upper > 0; ++k) {
    const Vec w = difference(result.v / result.upper);
    result.lower = std::max(result.lower, result.v.dot(w) / result.upper);
    if (result.upper - result.lower <= 4 * kRealEpsilon * (result.upper + w.norm())) break;
    known.push_back(w);
    // The nearest point of the hull of at most five points, by all their points, segments and triangles.
    Vec best = known[0];
    std::vector<Vec> face;
    const auto keep = [&](const Vec& v, const std::vector<Vec>& of) {
      if (v.squaredNorm() < best.squaredNorm() || face.empty()) best = v, face = of;
    };
    const int n = static_cast<int>(known.size());
    for (int i = 0; i < n; ++i) {
      keep(known[i], {known[i]});
      for (int j = i + 1; j < n; ++j) {
        const Vec e = known[j] - known[i];
        const Real t = -known[i].dot(e) / e.squaredNorm();
        if (t > 0 && t < 1) keep(known[i] + t * e, {known[i], known[j]});
        for (int l = j + 1; l < n; ++l) {
          const Vec f = known[l] - known[i], c = e.cross(f);
          const Real cc = c.squaredNorm();
          const Real s = -known[i].cross(f).dot(c) / cc, r = -e.cross(known[i]).dot(c) / cc;
          if (s > 0 && r > 0 && s + r < 1) keep(known[i] + s * e + r * f, {known[i], known[j], known[l]});
        }
      }
    }
    if (!(best.norm() < result.upper)) break;
    result.v = best;
    result.upper = best.norm();
    known = face;
  }
  return result;
}

/// Keeps the direction of A to B along which the separation is largest.
template <class A, class B>
class DirectionSearch {
 public:
  DirectionSearch(const A& a, const B& b) : a_(a), b_(b) {}

  Real at(const Vec& n) {
    const Real separation = separationAlong(a_, b_, n);
    if (separation > best_.gap) best_.gap = separation, best_.n = n;
    return separation;
  }
  /// Over the circle (or cone) cos(t) x + sin(t) y + z: samples, then the top of each hill that may be
  /// highest.
  void around(const Vec& x, const Vec& y, const Vec& z) {
    constexpr int kSamples = 48;
    constexpr Real kStep = 2 * 3.14159265358979323846L / kSamples;
    const auto value = [&](Real t) { return at((std::cos(t) * x + std::sin(t) * y + z).normalized()); };
    std::array<Real, kSamples> values;
    for (int k = 0; k < kSamples; ++k) values[k] = value(k * kStep);
    for (int k = 0; k < kSamples; ++k) {
      if (values[k] < values[(k + kSamples - 1) % kSamples] || values[k] < values[(k + 1) % kSamples])
        continue;
      lowestOf([&](Real t) { return -value(t); }, (k - 1) * kStep, (k + 1) * kStep);
    }
  }
  Truth& best() { return best_; }

 private:
  const A& a_;
  const B& b_;
  Truth best_{-kInfinity, Vec::UnitZ(), kInfinity};
};

template <class A, class B>
void lookAlong(DirectionSearch<A, B>& search, const Polytope& polytope) {
  for (const Polytope::Face& face : polytope.faces) search.at(face.normal), search.at(-face.normal);
  for (const Vec& u : polytope.directions)
    search.around(u.unitOrthogonal(), u.cross(u.unitOrthogonal()), Vec::Zero());
}
template <class A, class B>
void lookAlong(DirectionSearch<A, B>& search, const Revolved& solid) {
  for (std::size_t k = 0; k + 1 < solid.profile.size(); ++k) {
    const Vec2 e = solid.profile[k + 1] - solid.profile[k], n = Vec2(-e[1], e[0]).normalized();
    const Vec x = n[0] * solid.R.col(0), y = n[0] * solid.R.col(1), z = n[1] * solid.R.col(2);
    for (const Real sign : {Real(1), Real(-1)}) {
      if (n[0] == 0)
        search.at(sign * z);
      else
        search.around(sign * x, sign * y, sign * z);
    }
  }
}

/// The depth of two that overlap: the least over faces, edges turned about themselves, caps and sides, and,
/// since the rims of two solids of revolution make a smooth piece together, over all directions by samples.
template <class A, class B>
Truth searchedDepth(const A& a, const B& b, const Vec& hint) {
  DirectionSearch<A, B> search(a, b);
  search.at(hint);
  lookAlong(search, a);
  lookAlong(search, b);
  if constexpr (std::is_same_v<A, Revolved> && std::is_same_v<B, Revolved>) {
    for (int k = 0; k < 600; ++k) {  // a spiral of even density
      const Real z = 1 - (2 * k + 1) / 600.0L, r = std::sqrt(1 - z * z), t = 2.399963229728653322L * k;
      search.at(Vec(r * std::cos(t), r * std::sin(t), z));
    }
    Real step = 0.1L;
    while (step > 1e-10L) {
      const Vec n = search.best().n, x = n.unitOrthogonal(), y = n.cross(x);
      const Real before = search.best().gap;
      for (int k = 0; k < 6; ++k)
        search.at((n + step * (std::cos(k + 0.3L) * x + std::sin(k + 0.3L) * y)).normalized());
      if (!(search.best().gap > before)) step *= 0.5L;
    }
  }
  return search.best();
}

}  // namespace rbs::oracle
