// SPDX-License-Identifier: BSD-3-Clause
// Volume and centre of the part of a shape below a plane up.x <= level.
//
// Polyhedra. By Gauss' theorem the volume is the sum of the pyramids over the faces, cut at the plane, with a
// common apex. With the apex in the plane the new face at the cut has no height, and need not be found.
//
// Solids of revolution. A slice across the axis is a disc of radius r(z), cut at the chord e.x = c(z), where
// e is the direction of `up` across the axis, c = (level - up_z z)/up_r. With t = c/r between -1 and 1
//   area   A = r² (pi - arccos t + t sqrt(1 - t²)),    moment along e   M = -(2/3) r³ (1 - t²)^(3/2).
// Both are smooth in z but where the chord leaves the disc, (level - up_z z)² = up_r² r², with roots of
// square roots there and at the tips of the solid. r² is a quadratic in z, so these places are found in
// closed form, and z = middle - half cos(theta) takes the roots away: Gauss' rule in theta between them
// converges geometrically.
#include "shapes/submerged.h"

#include "base/algebra.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace rbs {

namespace {

// --- sphere

SubmergedPart capOf(double radius, const Vec3& up, double level) {
  const double h = std::clamp(radius + level, 0.0, 2.0 * radius);  // its depth
  if (h == 0.0) return {};
  const double left = 2.0 * radius - h;
  return {kPi * h * h * (3.0 * radius - h) / 3.0, -0.75 * left * left / (3.0 * radius - h) * up};
}

// --- polyhedra

class PyramidSum {
 public:
  PyramidSum(const Vec3& up, double level) : up_(up), level_(level), apex_(level * up) {}

  void addFace(const std::vector<Vec3>& corners) {
    cut_.clear();
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const Vec3 &a = corners[k], &b = corners[(k + 1) % corners.size()];
      const double over_a = up_.dot(a) - level_, over_b = up_.dot(b) - level_;
      if (over_a <= 0.0) cut_.push_back(a);
      if ((over_a < 0.0 && over_b > 0.0) || (over_a > 0.0 && over_b < 0.0))
        cut_.push_back(a + over_a / (over_a - over_b) * (b - a));
    }
    for (std::size_t k = 2; k < cut_.size(); ++k) addTetrahedron(cut_[0], cut_[k - 1], cut_[k]);
  }

  SubmergedPart result() const {
    if (!(volume_ > 0.0)) return {};
    return {volume_, apex_ + moment_ / volume_};
  }

 private:
  void addTetrahedron(const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 u = a - apex_, v = b - apex_, w = c - apex_;
    const double volume = u.dot(v.cross(w)) / 6.0;
    volume_ += volume;
    moment_ += 0.25 * volume * (u + v + w);
  }

  Vec3 up_;
  double level_;
  Vec3 apex_;
  std::vector<Vec3> cut_;
  double volume_ = 0.0;
  Vec3 moment_ = Vec3::Zero();  // about the apex
};

SubmergedPart partOf(const Box& box, const Vec3& up, double level) {
  PyramidSum sum(up, level);
  for (int axis = 0; axis < 3; ++axis) {
    const int s = (axis + 1) % 3, t = (axis + 2) % 3;
    for (const double side : {1.0, -1.0}) {
      std::vector<Vec3> corners;
      for (const auto& [x, y] : {std::pair(-1.0, -1.0), {1.0, -1.0}, {1.0, 1.0}, {-1.0, 1.0}}) {
        Vec3 corner;
        corner[axis] = side, corner[s] = side * x, corner[t] = y;
        corners.push_back(0.5 * corner.cwiseProduct(box.size));
      }
      sum.addFace(corners);
    }
  }
  return sum.result();
}

SubmergedPart partOf(const Polyhedron& solid, const Vec3& up, double level) {
  PyramidSum sum(up, level);
  for (const Polyhedron::Face& face : solid.faces) {
    std::vector<Vec3> corners;
    for (const int corner : face.corners) corners.push_back(solid.vertices[corner]);
    sum.addFace(corners);
  }
  return sum.result();
}

// --- solids of revolution

constexpr int kNodes = 32;
struct GaussRule {
  std::array<double, kNodes> x, weight;  // on [-1, 1]
};

// Roots of Legendre's polynomial by Newton's method.
GaussRule gaussRule() {
  GaussRule rule;
  for (int k = 0; k < kNodes; ++k) {
    double x = std::cos(kPi * (k + 0.75) / (kNodes + 0.5)), slope = 1.0;
    for (int step = 0; step < 20; ++step) {
      double p = 1.0, before = 0.0;
      for (int n = 1; n <= kNodes; ++n) {
        const double next = ((2.0 * n - 1.0) * x * p - (n - 1.0) * before) / n;
        before = p, p = next;
      }
      slope = kNodes * (x * p - before) / (x * x - 1.0);
      x -= p / slope;
    }
    rule.x[k] = x;
    rule.weight[k] = 2.0 / ((1.0 - x * x) * slope * slope);
  }
  return rule;
}

// A piece of the axis on which r² = a + b z + c z².
struct Profile {
  double from, to, a, b, c;
};

SubmergedPart partOf(const std::vector<Profile>& profiles, const Vec3& up, double level) {
  static const GaussRule rule = gaussRule();
  const double up_r = std::hypot(up.x(), up.y()), up_z = up.z();
  const Vec3 e = up_r > 0.0 ? Vec3(up.x() / up_r, up.y() / up_r, 0.0) : Vec3(Vec3::UnitX());
  double volume = 0.0, moment_e = 0.0, moment_z = 0.0;
  for (const Profile& p : profiles) {
    std::vector<double> breaks{p.from, p.to};
    const auto addBreak = [&](double z) {
      if (z > p.from && z < p.to) breaks.push_back(z);
    };
    // up_r² (a + b z + c z²) - (level - up_z z)² = 0
    const double q2 = up_r * up_r * p.c - up_z * up_z, q1 = up_r * up_r * p.b + 2.0 * level * up_z,
                 q0 = up_r * up_r * p.a - level * level;
    const double root = std::sqrt(std::max(q1 * q1 - 4.0 * q2 * q0, 0.0));
    const double q = -0.5 * (q1 + std::copysign(root, q1));
    if (q2 != 0.0) addBreak(q / q2);
    if (q != 0.0) addBreak(q0 / q);
    std::sort(breaks.begin(), breaks.end());
    for (std::size_t part = 1; part < breaks.size(); ++part) {
      const double middle = 0.5 * (breaks[part] + breaks[part - 1]),
                   half = 0.5 * (breaks[part] - breaks[part - 1]);
      for (int k = 0; k < kNodes; ++k) {
        const double theta = 0.5 * kPi * (1.0 + rule.x[k]);
        const double z = middle - half * std::cos(theta);
        const double dz = 0.5 * kPi * rule.weight[k] * half * std::sin(theta);
        const double r2 = std::max(p.a + z * (p.b + z * p.c), 0.0), r = std::sqrt(r2);
        const double below = level - up_z * z;
        const double reach = up_r * r;
        const double t = below >= reach ? 1.0 : below <= -reach ? -1.0 : below / reach;
        const double s = std::sqrt((1.0 - t) * (1.0 + t));
        const double area = r2 * (kPi - std::acos(t) + t * s);
        volume += dz * area;
        moment_z += dz * z * area;
        moment_e -= dz * 2.0 / 3.0 * r2 * r * s * s * s;
      }
    }
  }
  if (!(volume > 0.0)) return {};
  return {volume, moment_e / volume * e + moment_z / volume * Vec3::UnitZ()};
}

std::vector<Profile> profilesOf(const Capsule& capsule) {
  const double R = capsule.radius, l = capsule.half_length;
  return {{-l - R, -l, R * R - l * l, -2.0 * l, -1.0},
          {-l, l, R * R, 0.0, 0.0},
          {l, l + R, R * R - l * l, 2.0 * l, -1.0}};
}

std::vector<Profile> profilesOf(const Cylinder& cylinder) {
  return {{-cylinder.half_length, cylinder.half_length, cylinder.radius * cylinder.radius, 0.0, 0.0}};
}

// r = slope (apex - z)
std::vector<Profile> profilesOf(const Cone& cone) {
  const double apex = 0.75 * cone.height, slope2 = std::pow(cone.radius / cone.height, 2);
  return {{-0.25 * cone.height, apex, slope2 * apex * apex, -2.0 * slope2 * apex, slope2}};
}

struct Part {
  const Vec3& up;
  double level;
  SubmergedPart operator()(const Sphere& ball) const { return capOf(ball.radius, up, level); }
  SubmergedPart operator()(const Box& box) const { return partOf(box, up, level); }
  SubmergedPart operator()(const ConvexHull& hull) const { return partOf(*hull.polyhedron, up, level); }
  SubmergedPart operator()(const Plane&) const { return {}; }
  template <class Round>
  SubmergedPart operator()(const Round& solid) const {
    return partOf(profilesOf(solid), up, level);
  }
};

}  // namespace

// The sums about a point of the surface lose their digits where that is far away.
SubmergedPart submergedPart(const Shape& shape, const Vec3& up_B, double level) {
  if (level >= boundingRadius(shape)) return {volume(shape), Vec3::Zero()};
  if (level <= -boundingRadius(shape)) return {};
  return std::visit(Part{up_B, level}, shape);
}

}  // namespace rbs
