// SPDX-License-Identifier: BSD-3-Clause
// The sub-distance problem of GJK by signed volumes: M. Montanari, N. Petrinic, E. Barbieri, "Improving the
// GJK algorithm for faster and more reliable distance queries between convex objects", ACM TOG 36(3), 2017.
//
// The barycentric coordinates of the origin's projection on a simplex are ratios of signed volumes (areas,
// lengths) measured from one vertex. Where all are positive the projection is inside; else the nearest point
// lies on a face whose coordinate is negative. A simplex too flat for its volume to have a sign is replaced
// by all of its faces. The nearest candidate wins, so every result is a point of the hull: a true upper bound
// of the distance, up to the rounding of the corners.
#include "narrowphase/simplex.h"
#include "narrowphase/tolerances.h"

#include <limits>
#include <utility>

namespace rbs {

namespace {

// A volume smaller than this fraction of the product of its edges is rounding.
constexpr double kFlatVolume = 16.0 * kEpsilon;

struct Nearest {
  Vec3 v;
  double squared = std::numeric_limits<double>::infinity();
  int size = 0;
  std::array<int, 4> index{};
  std::array<double, 4> weight{};
};

void keepNearer(Nearest& best, const Nearest& other) {
  if (other.squared < best.squared) best = other;
}

using Points = std::array<SupportPoint, 4>;

Nearest ofPoint(const Points& s, int i) {
  return {s[i].w, s[i].w.squaredNorm(), 1, {i}, {1.0}};
}

Nearest ofSegment(const Points& s, int i, int j) {
  const Vec3 edge = s[j].w - s[i].w;
  const double squared = edge.squaredNorm();
  const double towards_j = -s[i].w.dot(edge);
  const double towards_i = s[j].w.dot(edge);
  if (!(towards_j > 0.0) || squared == 0.0) return ofPoint(s, i);
  if (!(towards_i > 0.0)) return ofPoint(s, j);
  // Measured from the nearer end, which keeps the most digits.
  const double t = towards_j / squared;
  Vec3 v = t < 0.5 ? Vec3(s[i].w + t * edge) : Vec3(s[j].w - towards_i / squared * edge);
  v -= edge.dot(v) / squared * edge;  // what rounding has left along the edge
  return {v, v.squaredNorm(), 2, {i, j}, {1.0 - t, t}};
}

// The origin's projection in the frame of the longest edge: u along it, q across it in the plane of the
// triangle, at x and y from the corner o. However thin the triangle is, and however badly q then is known,
// the projection is as good as the corners are: inside the triangle y is no larger than its width, and an
// error of q costs that error times y. (Weights from areas would be off along the edge by their own error.)
Nearest ofTriangle(const Points& s, int o, int j, int k) {
  const double oj = (s[j].w - s[o].w).squaredNorm(), ok = (s[k].w - s[o].w).squaredNorm(),
               jk = (s[k].w - s[j].w).squaredNorm();
  if (ok > oj && ok >= jk)
    std::swap(j, k);
  else if (jk > oj && jk > ok)
    std::swap(o, k);
  const Vec3 edge = s[j].w - s[o].w, side = s[k].w - s[o].w;
  const double length = edge.norm();
  const Vec3 u = edge / length;
  const double along_side = u.dot(side);
  Vec3 q = side - along_side * u;
  const double width = q.norm();
  if (!(width > kFlatVolume * length)) {
    Nearest best = ofSegment(s, o, j);
    keepNearer(best, ofSegment(s, o, k));
    keepNearer(best, ofSegment(s, j, k));
    return best;
  }
  q /= width;
  const double x = -u.dot(s[o].w);
  const Vec3 across = s[o].w + x * u;
  const double y = -q.dot(across);
  const double ck = y / width, cj = (x - ck * along_side) / length, co = 1.0 - cj - ck;
  if (co > 0.0 && cj > 0.0 && ck > 0.0) {
    Nearest inside{across + y * q, 0.0, 3, {o, j, k}, {co, cj, ck}};
    // What rounding has left along u, and along q where that is known better than it matters.
    inside.v -= u.dot(inside.v) * u;
    if (inside.v.squaredNorm() < width * width) inside.v -= q.dot(inside.v) * q;
    inside.squared = inside.v.squaredNorm();
    return inside;
  }
  Nearest best;
  if (!(ck > 0.0)) keepNearer(best, ofSegment(s, o, j));
  if (!(cj > 0.0)) keepNearer(best, ofSegment(s, o, k));
  if (!(co > 0.0)) keepNearer(best, ofSegment(s, j, k));
  return best;
}

// A face is a candidate unless the origin is on its inner side for certain; of a flat tetrahedron, whose
// volume has no sign, every face is.
Nearest ofTetrahedron(const Points& s) {
  const Vec3 e1 = s[1].w - s[0].w, e2 = s[2].w - s[0].w, e3 = s[3].w - s[0].w, r = -s[0].w;
  const Vec3 n23 = e2.cross(e3);
  const double volume = e1.dot(n23);
  const double sign = volume < 0.0 ? -1.0 : 1.0;
  const double c1 = sign * r.dot(n23), c2 = sign * e1.dot(r.cross(e3)), c3 = sign * e1.dot(e2.cross(r));
  const double c0 = sign * volume - c1 - c2 - c3;
  const double l1 = e1.norm(), l2 = e2.norm(), l3 = e3.norm();
  const double unsure = kFlatVolume * (l1 * l2 * l3 + r.norm() * (l1 * l2 + l2 * l3 + l3 * l1));
  const bool flat = std::abs(volume) <= unsure;
  if (!flat && c0 > unsure && c1 > unsure && c2 > unsure && c3 > unsure) {
    const double v = sign * volume;
    return {Vec3::Zero(), 0.0, 4, {0, 1, 2, 3}, {c0 / v, c1 / v, c2 / v, c3 / v}};
  }
  // Of faces that tie but for rounding, one with the newest corner: that came because it is nearer.
  Nearest best;
  if (flat || !(c2 > unsure)) keepNearer(best, ofTriangle(s, 0, 1, 3));
  if (flat || !(c1 > unsure)) keepNearer(best, ofTriangle(s, 0, 2, 3));
  if (flat || !(c0 > unsure)) keepNearer(best, ofTriangle(s, 1, 2, 3));
  if (flat || !(c3 > unsure)) {
    const Nearest old = ofTriangle(s, 0, 1, 2);
    if (old.squared < (1.0 - kFlatVolume) * best.squared) best = old;
  }
  return best;
}

}  // namespace

bool Simplex::contains(const Vec3& w) const {
  for (int i = 0; i < size; ++i)
    if (points[i].w == w) return true;
  return false;
}

Vec3 Simplex::witnessA() const {
  Vec3 sum = Vec3::Zero();
  for (int i = 0; i < size; ++i) sum += weight[i] * points[i].a;
  return sum;
}

Vec3 Simplex::witnessB() const {
  Vec3 sum = Vec3::Zero();
  for (int i = 0; i < size; ++i) sum += weight[i] * points[i].b;
  return sum;
}

Vec3 reduceToNearest(Simplex& simplex) {
  const Points& s = simplex.points;
  const Nearest nearest = simplex.size == 1   ? ofPoint(s, 0)
                          : simplex.size == 2 ? ofSegment(s, 0, 1)
                          : simplex.size == 3 ? ofTriangle(s, 0, 1, 2)
                                              : ofTetrahedron(s);
  Simplex face;
  for (int i = 0; i < nearest.size; ++i) {
    face.add(s[nearest.index[i]]);
    face.weight[i] = nearest.weight[i];
  }
  simplex = face;
  return nearest.v;
}

}  // namespace rbs
