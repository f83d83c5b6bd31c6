// SPDX-License-Identifier: BSD-3-Clause
// The point of a box that is nearest to a path changes its kind (corner, edge, face) where the path crosses
// the plane of a face. In between, the distance is that of a parabola u(s) from the origin: of the components
// by which the path is outside of the box. |u|² is a polynomial of degree 4 at most; between the roots of its
// derivative the distance grows or shrinks, and has one root at most. The roots of the derivative are found
// the same way, down to a line. None of them needs the last digits but the distance, which is evaluated as it
// stands: expanded, the polynomial would lose to rounding the square of how far away the path begins.
#include "narrowphase/parabola.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace rbs {

namespace {

struct ValueAndSlope {
  double value, slope;
};

// Times in rising order: no more than two for each plane of a face of a box, and the end.
struct Times {
  int size = 0;
  std::array<double, 13> time;

  void add(double t) { time[size++] = t; }
  const double* begin() const { return time.data(); }
  const double* end() const { return time.data() + size; }
};

// The root of f between two times at which its signs differ, by Newton's method, and by halving where that
// leaves the bracket or is slow.
template <class Function>
double rootBetween(const Function& f, double low, double high) {
  constexpr double kSettled = 2.0 * std::numeric_limits<double>::epsilon();
  const bool falls = f(low).value > 0.0;
  double s = low, last = high - low;
  while (true) {
    const auto [value, slope] = f(s);
    ((value > 0.0) == falls ? low : high) = s;
    double next = s - value / slope;
    if (!(next > low && next < high && std::abs(next - s) <= 0.5 * last)) next = low + 0.5 * (high - low);
    last = std::abs(next - s);
    if (last <= kSettled * next) return next;
    s = next;
  }
}

// The times between begin and end at which f changes its sign; between the `turns` it has no extremum.
template <class Function>
Times signChanges(const Function& f, double begin, double end, Times turns) {
  Times changes;
  turns.add(end);
  for (const double turn : turns) {
    if ((f(begin).value > 0.0) != (f(turn).value > 0.0)) changes.add(rootBetween(f, begin, turn));
    begin = turn;
  }
  return changes;
}

// The root of q0 + q1 s, if it is between begin and end.
Times lineRoot(double q0, double q1, double begin, double end) {
  Times roots;
  if (const double root = -q0 / q1; root > begin && root < end) roots.add(root);
  return roots;
}

// The times between begin and end at which |u| stops growing or shrinking: from the derivatives of |u|²/2.
Times turnsOf(const Parabola& u, double begin, double end) {
  const double vv = u.v.dot(u.v) + u.p.dot(u.a), va = 3.0 * u.v.dot(u.a), aa = 3.0 * u.a.dot(u.a);
  const auto second = [&](double s) { return ValueAndSlope{vv + s * (va + 0.5 * s * aa), va + s * aa}; };
  const auto first = [&](double s) { return ValueAndSlope{u.at(s).dot(u.velocityAt(s)), second(s).value}; };
  return signChanges(first, begin, end, signChanges(second, begin, end, lineRoot(va, aa, begin, end)));
}

// Follows |u| - radius over one stretch of a path after the other.
class Approach {
 public:
  Approach(double radius, bool touches, double margin)
      : radius_(radius), margin_(margin), touches_(touches) {}

  std::optional<double> over(const Parabola& u, double begin, double end) {
    const auto gap = [&](double s) {
      const Vec3 x = u.at(s);
      const double distance = x.norm();
      return ValueAndSlope{distance - radius_, x.dot(u.velocityAt(s)) / distance};
    };
    Times stops = turnsOf(u, begin, end);
    stops.add(end);
    double now = gap(begin).value;
    for (const double stop : stops) {
      const double then = gap(stop).value;
      if (touches_) {
        if (then < now - margin_) return begin;
        touches_ = then <= margin_;
      } else if (then <= 0.0) {
        return now > 0.0 ? rootBetween(gap, begin, stop) : begin;
      }
      begin = stop, now = then;
    }
    return std::nullopt;
  }

 private:
  double radius_, margin_;
  bool touches_;
};

}  // namespace

// Of the two forms of each root, the one that adds numbers of equal sign.
std::optional<double> firstFall(double q0, double q1, double q2) {
  const double discriminant = q1 * q1 - 2.0 * q0 * q2;
  if (discriminant < 0.0) return std::nullopt;
  if (q1 < 0.0) return 2.0 * q0 / (std::sqrt(discriminant) - q1);
  if (q2 < 0.0) return (std::sqrt(discriminant) + q1) / -q2;
  return std::nullopt;
}

std::optional<double> firstWithin(double radius, const Vec3& half, const Parabola& path, bool touches,
                                  double margin, double horizon) {
  Times crossings;
  for (int k = 0; k < 3; ++k)
    for (const double face : {-half[k], half[k]}) {
      const auto height = [&](double s) {
        return ValueAndSlope{path.p[k] - face + s * (path.v[k] + 0.5 * s * path.a[k]),
                             path.v[k] + s * path.a[k]};
      };
      for (const double s : signChanges(height, 0.0, horizon, lineRoot(path.v[k], path.a[k], 0.0, horizon)))
        crossings.add(s);
    }
  std::sort(crossings.time.begin(), crossings.time.begin() + crossings.size);
  crossings.add(horizon);

  Approach approach(radius, touches, margin);
  double begin = 0.0;
  for (const double end : crossings) {
    const Vec3 middle = path.at(0.5 * (begin + end));
    Parabola u = path;
    for (int k = 0; k < 3; ++k) {
      if (std::abs(middle[k]) <= half[k])
        u.p[k] = u.v[k] = u.a[k] = 0.0;
      else
        u.p[k] -= std::copysign(half[k], middle[k]);
    }
    if (const auto s = approach.over(u, begin, end)) return s;
    begin = end;
  }
  return std::nullopt;
}

}  // namespace rbs
