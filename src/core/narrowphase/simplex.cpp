// The sub-distance problem of GJK by signed volumes: M. Montanari, N. Petrinic, E. Barbieri, "Improving the
// GJK algorithm for faster and more reliable distance queries between convex objects", ACM TOG 36(3), 2017.
//
// The barycentric coordinates of the origin's projection on a simplex are ratios of signed volumes (areas,
// lengths) measured from one vertex. Where all are positive the projection is inside; else the nearest point
// lies on a face whose coordinate is negative. A simplex too flat for its volume to have a sign is replaced
// by all of its faces. The nearest candidate wins, so every result is a point of the hull: a true upper bound
// of the distance, whatever the rounding.
#include "narrowphase/simplex.h"

#include <limits>
#include <utility>

namespace rbs {

namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
// A volume smaller than this fraction of the product of its edges is rounding.
constexpr double kFlat = 16.0 * kEpsilon;

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
  const Vec3 v = t < 0.5 ? Vec3(s[i].w + t * edge) : Vec3(s[j].w - towards_i / squared * edge);
  return {v, v.squaredNorm(), 2, {i, j}, {1.0 - t, t}};
}

// The two shorter edges span it: in a needle the cross product of the two long ones would cancel.
Nearest ofTriangle(const Points& s, int i, int j, int k) {
  const double ij = (s[j].w - s[i].w).squaredNorm(), ik = (s[k].w - s[i].w).squaredNorm(),
               jk = (s[k].w - s[j].w).squaredNorm();
  if (ij > ik && ij > jk)
    std::swap(i, k);
  else if (ik > jk)
    std::swap(i, j);
  const Vec3 e1 = s[j].w - s[i].w, e2 = s[k].w - s[i].w, r = -s[i].w;
  const Vec3 n = e1.cross(e2);
  const double area2 = n.squaredNorm();
  const bool flat = area2 <= kFlat * kFlat * e1.squaredNorm() * e2.squaredNorm();
  const double cj = r.cross(e2).dot(n), ck = e1.cross(r).dot(n), ci = area2 - cj - ck;
  if (!flat && ci > 0.0 && cj > 0.0 && ck > 0.0) {
    Nearest inside{Vec3(), 0.0, 3, {i, j, k}, {ci / area2, cj / area2, ck / area2}};
    const Vec3 sum = s[i].w + inside.weight[1] * e1 + inside.weight[2] * e2;
    // Along the normal the direction keeps all its digits however near the origin is; a triangle so thin
    // that the two forms disagree falls back on the one that stays in the hull.
    const Vec3 along = (s[i].w.dot(n) / area2) * n;
    const double rounding = kFlat * s[i].a.cwiseAbs().maxCoeff() + kFlat * s[i].b.cwiseAbs().maxCoeff();
    inside.v = (along - sum).squaredNorm() <= rounding * rounding ? along : sum;
    inside.squared = inside.v.squaredNorm();
    return inside;
  }
  Nearest best;
  if (flat || !(ck > 0.0)) keepNearer(best, ofSegment(s, i, j));
  if (flat || !(cj > 0.0)) keepNearer(best, ofSegment(s, i, k));
  if (flat || !(ci > 0.0)) keepNearer(best, ofSegment(s, j, k));
  return best;
}

Nearest ofTetrahedron(const Points& s) {
  const Vec3 e1 = s[1].w - s[0].w, e2 = s[2].w - s[0].w, e3 = s[3].w - s[0].w, r = -s[0].w;
  const Vec3 n23 = e2.cross(e3);
  const double volume = e1.dot(n23);
  const double sign = volume < 0.0 ? -1.0 : 1.0;
  const double c1 = sign * r.dot(n23), c2 = sign * e1.dot(r.cross(e3)), c3 = sign * e1.dot(e2.cross(r));
  const double c0 = sign * volume - c1 - c2 - c3;
  const bool flat = std::abs(volume) <= kFlat * e1.norm() * e2.norm() * e3.norm();
  if (!flat && c0 > 0.0 && c1 > 0.0 && c2 > 0.0 && c3 > 0.0) {
    const double v = sign * volume;
    return {Vec3::Zero(), 0.0, 4, {0, 1, 2, 3}, {c0 / v, c1 / v, c2 / v, c3 / v}};
  }
  Nearest best;
  if (flat || !(c3 > 0.0)) keepNearer(best, ofTriangle(s, 0, 1, 2));
  if (flat || !(c2 > 0.0)) keepNearer(best, ofTriangle(s, 0, 1, 3));
  if (flat || !(c1 > 0.0)) keepNearer(best, ofTriangle(s, 0, 2, 3));
  if (flat || !(c0 > 0.0)) keepNearer(best, ofTriangle(s, 1, 2, 3));
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
