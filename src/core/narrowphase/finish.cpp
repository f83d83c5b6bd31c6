// SPDX-License-Identifier: BSD-3-Clause
#include "narrowphase/finish.h"

#include "base/algebra.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rbs {

namespace {

constexpr int kSteps = 16;
constexpr double kStep = 0.3;  // rad, the longest

// Whether a step, in rad, is the last: rounding, or no shorter than the one before.
bool settled(double step, double before) {
  constexpr double kNoStep = 1e-15, kCrawl = 1e-5;  // rad
  return step <= kNoStep || (step < kCrawl && step > 0.5 * before);
}

// The farthest point along `outward` and the derivative of it by the direction, scale f f'.
struct Farthest {
  Vec3 point, f;
  double scale;
};

Farthest farthest(const Feature& feature, const Vec3& outward, int k = 0) {
  if (feature.radius[k] == 0.0) return {feature.centre[k], Vec3::Zero(), 0.0};
  Vec3 e = outward - feature.axis.dot(outward) * feature.axis;
  const double across = e.norm();
  if (!(across > 1e-14)) return {feature.centre[k], Vec3::Zero(), 0.0};  // rounding
  e /= across;
  e = (e - feature.axis.dot(e) * feature.axis).normalized();  // what rounding has left there
  return {feature.centre[k] + feature.radius[k] * e, feature.axis.cross(e), feature.radius[k] / across};
}

struct Circle {
  Vec3 axis;
  double cosine;
};

bool parallel(const Circle& p, const Circle& q) {
  return p.axis.cross(q.axis).squaredNorm() <= 1e-20;
}

// Where n.u = c and n.w = d, nearest to n; n itself if nowhere.
Vec3 common(const Circle& p, const Circle& q, const Vec3& n) {
  const Vec3 across = p.axis.cross(q.axis);
  const double sine2 = across.squaredNorm(), cosine = p.axis.dot(q.axis);
  const Vec3 flat =
      ((p.cosine - cosine * q.cosine) * p.axis + (q.cosine - cosine * p.cosine) * q.axis) / sine2;
  const double height2 = 1.0 - flat.squaredNorm();
  if (height2 < 0.0) return n;
  const double height = std::copysign(std::sqrt(height2 / sine2), across.dot(n));
  return (flat + height * across).normalized();
}

// Where n.u = c, nearest to `start`, less its part along u; 0 if all are equally near.
Vec3 acrossAxis(const Circle& circle, const Vec3& start) {
  const Vec3 m = start - circle.axis.dot(start) * circle.axis;
  const double length = m.norm();
  if (!(length > 0.0)) return Vec3::Zero();
  return std::sqrt(std::max(1.0 - circle.cosine * circle.cosine, 0.0)) / length * m;
}

Vec3 nearestOn(const Circle& circle, const Vec3& start) {
  return (circle.cosine * circle.axis + acrossAxis(circle, start)).normalized();
}

Vec3 onCircle(const Feature& a, const Feature& b, const Circle& circle, const Vec3& start) {
  Vec3 m = acrossAxis(circle, start);
  if (m.isZero(0.0)) return start;
  double before = kStep;
  for (int k = 0; k < kSteps; ++k) {
    const Vec3 n = circle.cosine * circle.axis + m, t = circle.axis.cross(m);
    const Farthest on_a = farthest(a, n), on_b = farthest(b, -n);
    const Vec3 G = on_b.point - on_a.point;
    const double fa = on_a.f.dot(t), fb = on_b.f.dot(t);
    const double slope = t.dot(G), bend = -on_a.scale * fa * fa - on_b.scale * fb * fb - G.dot(m);
    if (!(bend < 0.0)) break;  // all directions on the circle tie, or none is a maximum
    const double step = std::clamp(-slope / bend, -kStep, kStep);
    m = std::cos(step) * m + std::sin(step) * t;
    if (settled(std::abs(step), before)) break;
    before = std::abs(step);
  }
  return (circle.cosine * circle.axis + m).normalized();
}

Vec3 onSphere(const Feature& a, const Feature& b, const Vec3& start) {
  Vec3 n = start;
  double before = kStep;
  for (int k = 0; k < kSteps; ++k) {
    const Farthest on_a = farthest(a, n), on_b = farthest(b, -n);
    const Vec3 G = on_b.point - on_a.point;
    const auto [t1, t2] = tangents(n);
    const double a1 = on_a.f.dot(t1), a2 = on_a.f.dot(t2), b1 = on_b.f.dot(t1), b2 = on_b.f.dot(t2);
    const double s = n.dot(G), g1 = t1.dot(G), g2 = t2.dot(G);
    const double h11 = on_a.scale * a1 * a1 + on_b.scale * b1 * b1 + s;
    const double h12 = on_a.scale * a1 * a2 + on_b.scale * b1 * b2;
    const double h22 = on_a.scale * a2 * a2 + on_b.scale * b2 * b2 + s;
    const double determinant = h11 * h22 - h12 * h12;
    if (!(determinant > 0.0 && h11 > 0.0)) return start;  // no maximum is near
    double d1 = (h22 * g1 - h12 * g2) / determinant, d2 = (h11 * g2 - h12 * g1) / determinant;
    const double length = std::sqrt(d1 * d1 + d2 * d2);
    if (length > kStep) d1 *= kStep / length, d2 *= kStep / length;
    n = (n + d1 * t1 + d2 * t2).normalized();
    if (settled(length, before)) return n;
    before = length;
  }
  return start;
}

bool isEdge(const Feature& feature) {
  return feature.size == 2 && feature.radius[0] == 0.0 && feature.radius[1] == 0.0;
}
// Whether it is a rim about an axis that is nearly n.
bool isRimAlong(const Feature& feature, const Vec3& n) {
  constexpr double kAlongAxis = 0.995;  // cosine
  return feature.size == 1 && feature.radius[0] > 0.0 && feature.pin == Feature::Pin::None &&
         std::abs(feature.axis.dot(n)) > kAlongAxis;
}

// Where an edge and a rim are nearest: the direction, and the point of the rim; n is 0 where that is not
// found.
struct AtRim {
  Vec3 n = Vec3::Zero(), on_rim = Vec3::Zero();
};

// Near its axis the farthest point of a circle turns faster than any direction does; but where the edge lies
// over the disc but for a small tilt, the point x of it at which it is nearest to the rim is a smooth root:
// with rho and z its distance from the axis and height over the circle of the radius R, and e the unit vector
// along the edge, the way from the rim to x is across the edge,
//   (rho - R) e_rho + z e_z = 0.
// And n, across the edge in the plane of the axis and x, does not become worse as the gap vanishes. Of the
// two crossings of the line with the cylinder over the rim the one is taken towards which it comes down along
// n.
AtRim edgeAtRim(const Feature& edge, const Feature& rim, const Vec3& outward) {
  constexpr double kAlongRim = 1e-3;  // an edge that runs along the rim spans no plane with the axis
  const Vec3 &axis = rim.axis, &e = edge.pin_axis;
  const double radius = rim.radius[0], e_z = axis.dot(e);
  const Vec3 flat = e - e_z * axis, from = edge.centre[0] - rim.centre[0];
  const double squared = flat.squaredNorm(), z_from = axis.dot(from);
  const Vec3 from_flat = from - z_from * axis;
  if (!(squared > kAlongRim * kAlongRim)) return {};
  const double middle = -flat.dot(from_flat) / squared;
  const double half =
      std::sqrt(std::max(radius * radius - (from_flat + middle * flat).squaredNorm(), 0.0) / squared);
  double s = middle - std::copysign(half, axis.dot(outward) * e_z),
         before = std::numeric_limits<double>::infinity();
  for (int k = 0; k < kSteps; ++k) {
    const Vec3 x = from_flat + s * flat;
    const double rho = x.norm(), z = z_from + s * e_z, e_rho = flat.dot(x) / rho;
    const double bend = e_rho * e_rho + (rho - radius) * (squared - e_rho * e_rho) / rho + e_z * e_z;
    if (!(rho > 0.0 && bend > 0.0)) return {};
    const double step = -((rho - radius) * e_rho + z * e_z) / bend, size = std::abs(step);
    s += step;
    if (size > 0.0 && !(size < 1e-5 * radius && size >= 0.5 * before)) {
      before = size;
      continue;
    }
    const double length = std::hypot(e_rho, e_z);
    if (!(length > kAlongRim)) return {};
    const Vec3 n = (e_rho * axis - e_z / rho * x) / length;
    return {std::copysign(1.0, n.dot(outward)) * n, rim.centre[0] + radius / rho * x};
  }
  return {};
}

// Along its axis a circle has no farthest point, and near to it none that Newton's method gets on from. A
// direction so near is turned to where the other feature lies, `outward` being that from the circle to it.
Vec3 offAxis(const Feature& circle, const Feature& other, const Vec3& outward) {
  constexpr double kTilt = 0.05;
  if (circle.size != 1 || circle.radius[0] == 0.0 || circle.pin != Feature::Pin::None) return outward;
  const auto across = [&](const Vec3& v) -> Vec3 { return v - circle.axis.dot(v) * circle.axis; };
  if (across(outward).norm() > kTilt) return outward;
  const Vec3 towards = across(farthest(other, -outward).point - circle.centre[0]);
  const double length = towards.norm();
  if (!(length > 0.0)) return outward;
  return (std::copysign(1.0, circle.axis.dot(outward)) * circle.axis + kTilt / length * towards).normalized();
}

// Whether the separation along m is larger than that along n, by more than rounding.
bool gains(const Feature& a, const Feature& b, const Vec3& n, const Vec3& m) {
  const Vec3 on_a = farthest(a, m).point, on_b = farthest(b, -m).point;
  return m.dot(on_b - on_a) >
         n.dot(farthest(b, -n).point - farthest(a, n).point) + kChainRounding * (on_a.norm() + on_b.norm());
}

Vec3 directionOf(const Feature& a, const Feature& b, const Vec3& n) {
  using Pin = Feature::Pin;
  if (a.pin == Pin::Point) return a.pin_axis;
  if (b.pin == Pin::Point) return -b.pin_axis;
  const Circle of_a{a.pin_axis, a.pin_cosine}, of_b{b.pin_axis, -b.pin_cosine};
  if (a.pin == Pin::Circle && b.pin == Pin::Circle && !parallel(of_a, of_b)) return common(of_a, of_b, n);
  if (a.pin == Pin::Circle) return onCircle(a, b, of_a, n);
  if (b.pin == Pin::Circle) return onCircle(a, b, of_b, n);
  if (const Vec3 found = onSphere(a, b, n); found != n) return found;
  const Vec3 turned = -offAxis(b, a, -offAxis(a, b, n)), found = onSphere(a, b, turned);
  return gains(a, b, n, found) ? found : n;
}

// The belt of the circle to which `pin` pins its outward normals m, m.u = c, met by a point or circle of the
// other shape about `axis`. Let m be c u + s e(f) and t = s u - c e(f) the unit vector across the circle of
// directions. With D the offset of a centre of `pin` from that of the other, z its height and d what it has
// across u,
//   m.D = c z + s e.d,   t.D = s z up to |c d|,
// and a circle of the radius r about u adds s r to the first and - c r to the second. One of the radius R
// about an axis tilted by the small angle a adds R (s - c e.v), with v what the axis has across u, up to R
// a^2 / s^3; and
// - c R up to R a.
Belt beltOf(const Feature& pin, const Vec3& centre, double radius, const Vec3& axis, double sign) {
  const Vec3& u = pin.pin_axis;
  const double c = pin.pin_cosine, s = std::sqrt(std::max(1.0 - c * c, 0.0));
  const Vec3 upright = u.dot(axis) < 0.0 ? Vec3(-axis) : axis;
  const Vec3 lean = upright - u.dot(upright) * u;
  const double tilt = radius > 0.0 ? lean.norm() : 0.0;
  Belt belt{sign * u, c, std::numeric_limits<double>::infinity(), 0.0};
  double lowest = belt.height, highest = -lowest;
  for (int j = 0; j < 2; ++j) {
    const Vec3 offset = pin.centre[j] - centre;
    const double z = u.dot(offset), r = pin.radius[j] + radius;
    const Vec3 across = offset - z * u;
    belt.height = std::min(belt.height, c * z + s * r - (s * across - radius * c * lean).norm() -
                                            radius * tilt * tilt / (s * s * s));
    const double blur = std::abs(c) * across.norm() + radius * tilt;
    lowest = std::min(lowest, s * z - c * r + blur), highest = std::max(highest, s * z - c * r - blur);
  }
  belt.reach = std::min(-lowest, highest);
  return belt;
}

// Those of the points or circles of the other shape, and of two between two: beside the middle of `pin`, and
// where the line through their centres is nearest to its axis, if a little inside the ends, where it may
// reach no farther.
std::array<Belt, 4> beltsOf(const Feature& pin, const Feature& other, double sign) {
  constexpr double kInside = 0.02;
  std::array<Belt, 4> belts{};
  if (other.isDisc()) return belts;
  for (int k = 0; k < other.size; ++k)
    belts[k] = beltOf(pin, other.centre[k], other.radius[k], other.axis, sign);
  if (other.size != 2) return belts;
  const Vec3 &u = pin.pin_axis, along = other.centre[1] - other.centre[0];
  const Vec3 to_middle = 0.5 * (pin.centre[0] + pin.centre[1]) - other.centre[0];
  const Vec3 along_flat = along - u.dot(along) * u, to_flat = to_middle - u.dot(to_middle) * u;
  const auto between = [&](double part, double whole) {
    const double at = whole == 0.0 ? 0.5 : std::clamp(part / whole, kInside, 1.0 - kInside);
    return beltOf(pin, other.centre[0] + at * along,
                  other.radius[0] + at * (other.radius[1] - other.radius[0]), other.axis, sign);
  };
  belts[2] = between(u.dot(to_middle), u.dot(along));
  belts[3] = between(along_flat.dot(to_flat), along_flat.squaredNorm());
  return belts;
}

// From `p`, the start of the segment `along`, to its lowest point over the disc; the one nearest to the
// middle of the disc where it is level up to rounding, or does not lie over the disc. `beside`: it would be
// lower beyond the rim.
Vec3 overDisc(const Feature& disc, const Vec3& p, const Vec3& along, bool& beside) {
  const Vec3 to_middle = disc.centre[0] - p;
  const double slope = disc.pin_axis.dot(along);
  const Vec3 flat = along - disc.axis.dot(along) * disc.axis;
  const double squared = flat.squaredNorm();
  if (!(squared > 0.0)) return Vec3::Zero();
  const double nearest = flat.dot(to_middle) / squared;
  const Vec3 offset = to_middle - disc.axis.dot(to_middle) * disc.axis - nearest * flat;
  const double half =
      std::sqrt(std::max(disc.radius[0] * disc.radius[0] - offset.squaredNorm(), 0.0) / squared);
  const double rounding = 4.0 * std::numeric_limits<double>::epsilon() * (p.norm() + disc.radius[0]);
  const double towards = std::abs(slope) <= rounding ? 0.0 : std::copysign(half, -slope);
  const double lowest = nearest + towards;
  beside = towards != 0.0 && lowest > 0.0 && lowest < 1.0;
  return std::clamp(lowest, 0.0, 1.0) * along;
}

// The point of a disc over or under one of a point, a line or another disc, and how far it is from the rim;
// none where it is beyond that.
bool underDisc(const Feature& disc, const Feature& other, const Vec3& n_other, Vec3& on_disc, Vec3& on_other,
               double& margin, bool& beside) {
  const auto across = [&](const Vec3& v) -> Vec3 { return v - disc.axis.dot(v) * disc.axis; };
  double reach = disc.radius[0];
  if (other.isDisc()) {
    reach += other.radius[0];
    on_other = other.centre[0] + other.radius[0] / reach * across(disc.centre[0] - other.centre[0]);
    margin = reach - across(disc.centre[0] - other.centre[0]).norm();
  } else {
    if (other.size > 2) return false;
    on_other = farthest(other, n_other).point;
    if (other.size == 2)
      on_other += overDisc(disc, on_other, farthest(other, n_other, 1).point - on_other, beside);
    margin = reach - across(on_other - disc.centre[0]).norm();
  }
  on_disc = on_other - disc.axis.dot(on_other - disc.centre[0]) * disc.axis;
  // What has corners is met at the rim, where it lies beside the disc; what is round may not be.
  beside = (beside || margin < 0.0) && other.radius[0] == 0.0 && other.radius[1] == 0.0;
  return margin >= 0.0;
}

}  // namespace

FeatureContact featureContactOf(const Feature& a, const Feature& b, const Vec3& start, Seek seek) {
  FeatureContact found;
  AtRim of_a, of_b;
  if (seek == Seek::Stationary) {
    if (isEdge(a) && isRimAlong(b, start)) of_b = edgeAtRim(a, b, -start);
    if (isEdge(b) && isRimAlong(a, start)) of_a = edgeAtRim(b, a, start);
    found.n = !of_a.n.isZero(0.0) ? of_a.n : !of_b.n.isZero(0.0) ? Vec3(-of_b.n) : directionOf(a, b, start);
    found.elsewhere = found.n == start;
  } else {
    const Feature& pin = seek == Seek::PinnedByA ? a : b;
    found.n = start;
    if (pin.pin != Feature::Pin::Circle) return found;
    const double sign = &pin == &a ? 1.0 : -1.0;
    found.n = nearestOn({pin.pin_axis, sign * pin.pin_cosine}, start);
    found.belts = beltsOf(pin, &pin == &a ? b : a, sign);
  }
  if (a.isDisc()) {
    found.size = underDisc(a, b, -found.n, found.on_a[0], found.on_b[0], found.margin, found.elsewhere);
    found.between = true;
  } else if (b.isDisc()) {
    found.size = underDisc(b, a, found.n, found.on_b[0], found.on_a[0], found.margin, found.elsewhere);
    found.between = true;
  } else if (a.size * b.size <= 4) {
    for (int i = 0; i < a.size; ++i)
      for (int j = 0; j < b.size; ++j) {
        found.on_a[found.size] = of_a.n.isZero(0.0) ? farthest(a, found.n, i).point : of_a.on_rim;
        if (b.radius[j] == 0.0) found.corner_b[found.size] = j;
        found.on_b[found.size++] = of_b.n.isZero(0.0) ? farthest(b, -found.n, j).point : of_b.on_rim;
      }
  }
  return found;
}

namespace {

// Normals this near to a face or a line on the side may belong to it, as cosines.
constexpr double kNearFace = 0.95, kNearSide = 0.2;

Feature circle(double radius, double z) {
  Feature rim;
  rim.add({0.0, 0.0, z}, radius);
  return rim;
}

Feature disc(double radius, double z, double up) {
  Feature disc = circle(radius, z);
  disc.pin = Feature::Pin::Point, disc.pin_axis = {0.0, 0.0, up};
  return disc;
}

}  // namespace

Features featuresAt(const CylinderCore& core, const Vec3& d, const Vec3* points, int size) {
  Features features;
  bool top = false, bottom = false;
  for (int i = 0; i < size; ++i) (points[i].z() > 0.0 ? top : bottom) = true;
  if (std::abs(d.z()) < kNearSide && top && bottom) {
    Feature side = circle(core.radius, -core.half_length);
    side.add({0.0, 0.0, core.half_length}, core.radius);
    side.pin = Feature::Pin::Circle;
    features.add(side);
  }
  const double z = std::copysign(core.half_length, d.z());
  features.add(circle(core.radius, z));
  if (std::abs(d.z()) > kNearFace) features.add(disc(core.radius, z, std::copysign(1.0, d.z())));
  return features;
}

Features featuresAt(const ConeCore& core, const Vec3& d, const Vec3* points, int size) {
  Features features;
  const double length = std::hypot(core.radius, core.height), sine = core.radius / length;
  bool apex = false, rim = false;
  for (int i = 0; i < size; ++i) (points[i].z() > 0.0 ? apex : rim) = true;
  const Feature base = circle(core.radius, -0.25 * core.height);
  if (apex && rim) {
    Feature side = base;
    side.add({0.0, 0.0, 0.75 * core.height}, 0.0);
    side.pin = Feature::Pin::Circle, side.pin_cosine = sine;
    features.add(side);
  }
  if (apex && !rim) {
    features.add(circle(0.0, 0.75 * core.height));
    return features;
  }
  features.add(base);
  if (d.z() < -kNearFace && features.size < 2) features.add(disc(core.radius, -0.25 * core.height, -1.0));
  return features;
}

Features featuresAt(const SegmentCore& core, const Vec3& d, const Vec3* points, int size) {
  Features features = spannedBy(d, points, size);
  if (features.of[0].size == 1 && std::abs(d.z()) < kNearSide && core.half > 0.0) {
    const std::array<Vec3, 2> ends{Vec3(0.0, 0.0, -core.half), Vec3(0.0, 0.0, core.half)};
    features.add(spannedBy(d, ends.data(), 2).of[0]);
  }
  return features;
}

Features spannedBy(const Vec3& d, const Vec3* points, int size) {
  std::array<Vec3, 4> corner;
  int count = 0;
  for (int i = 0; i < size; ++i)
    if (std::find(corner.begin(), corner.begin() + count, points[i]) == corner.begin() + count)
      corner[count++] = points[i];
  Features features;
  Feature feature;
  for (int k = 0; k < std::min(count, 3); ++k) feature.add(corner[k], 0.0);
  if (count == 2) {
    feature.pin = Feature::Pin::Circle;
    feature.pin_axis = (corner[1] - corner[0]).normalized();
  } else if (count >= 3) {
    const Vec3 n = (corner[1] - corner[0]).cross(corner[2] - corner[0]).normalized();
    if (n.isZero(0.0)) {
      feature.size = 1;  // three corners in line: no face
    } else {
      feature.pin = Feature::Pin::Point;
      feature.pin_axis = n.dot(d) < 0.0 ? Vec3(-n) : n;
    }
  }
  features.add(feature);
  return features;
}

}  // namespace rbs
