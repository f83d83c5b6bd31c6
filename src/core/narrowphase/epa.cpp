// A polytope inside A - B grows around the origin. Its face nearest to the origin, at distance `lower` along
// its outward normal n, is pushed out to w = support(n): all faces that w sees are removed, and the horizon
// they leave is joined to w. Since A - B holds the polytope and ends at the plane through w,
//   lower  <=  depth  <=  n.w
// (the first while the origin is inside). The smallest n.w met so far is the answer, so that it always is a
// translation that separates.
//
// Distances are signed: an origin outside by rounding is nearest to the face with the smallest, negative one,
// and needs no special case. Ties go to the older face. A face in whose plane w lies, up to rounding, counts
// as seen: flat sides of A - B are triangulated afresh rather than covered with slivers.
#include "narrowphase/epa.h"

#include "algebra.h"
#include "narrowphase/depth_proof.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <vector>

namespace rbs {

namespace {

constexpr double kRounding = 16.0 * std::numeric_limits<double>::epsilon();
// The interval of the depth is closed when it is this small.
constexpr double kClosed = 64.0 * std::numeric_limits<double>::epsilon();
// A round side whose directions tie would be tessellated without end. After so many rounds, and within this
// fraction of the size, the direction of each face left is finished instead.
constexpr int kTessellating = 512;
constexpr double kCoarse = 1e-3;
// Of the depth: the interval at which the features that meet are known well enough to ask for a proof.
constexpr double kFeatures = 0.05;
// Of the size: how well the points of a finished direction span the depth.
constexpr double kSpanned = 1e-9;
// Of the size: what the least distance may seem to shrink by as the polytope grows.
constexpr double kBroken = 1e-12;

// Corners anticlockwise seen from outside; edge k runs from corner k to corner k + 1 and borders
// `neighbour[k]`, whose own edge `twin[k]` runs back.
struct Face {
  std::array<int, 3> corner;
  std::array<int, 3> neighbour{-1, -1, -1};
  std::array<int, 3> twin{};
  Vec3 n;
  double distance = 0.0;
  bool alive = true;
};

int next(int edge) {
  return edge == 2 ? 0 : edge + 1;
}

class Polytope {
 public:
  Polytope(const Simplex& s, double rounding)
      : points_(s.points.begin(), s.points.end()), rounding_(rounding) {
    const Vec3 e1 = points_[1].w - points_[0].w, e2 = points_[2].w - points_[0].w;
    if (e1.cross(e2).dot(points_[3].w - points_[0].w) > 0.0) std::swap(points_[1], points_[2]);
    makeFace(0, 1, 2), makeFace(0, 3, 1), makeFace(0, 2, 3), makeFace(1, 3, 2);
    join(0, 0, 1, 2), join(0, 1, 3, 2), join(0, 2, 2, 0);
    join(1, 0, 2, 2), join(1, 1, 3, 0), join(2, 1, 3, 1);
    for (int face = 0; face < 4; ++face) nearest_.push({faces_[face].distance, face});
  }

  // Null when every face has been given up.
  const Face* nearestFace() {
    while (!nearest_.empty() && !faces_[nearest_.top().second].alive) nearest_.pop();
    return nearest_.empty() ? nullptr : &faces_[nearest_.top().second];
  }
  // Leaves the nearest face where it is, and never looks at it again.
  void giveUpNearest() { nearest_.pop(); }

  // Replaces what `point` sees, starting with `seen`, by the cone from it over the horizon. False, with
  // nothing changed, when the cone would have a face without area.
  bool expand(const Face& seen, const SupportPoint& point) {
    horizon_.clear();
    removed_.clear();
    const int start = static_cast<int>(&seen - faces_.data());
    remove(start);
    for (int edge = 0; edge < 3; ++edge)
      walk(faces_[start].neighbour[edge], faces_[start].twin[edge], point.w);

    const int apex = static_cast<int>(points_.size());
    points_.push_back(point);
    const int first = static_cast<int>(faces_.size());
    bool sound = horizon_.size() >= 3;
    for (const auto& [face, edge] : horizon_)
      sound = makeFace(faces_[face].corner[next(edge)], faces_[face].corner[edge], apex) && sound;
    if (!sound) {
      faces_.resize(first);
      points_.pop_back();
      for (const int face : removed_) faces_[face].alive = true;
      return false;
    }
    const int count = static_cast<int>(horizon_.size());
    for (int k = 0; k < count; ++k) {
      join(first + k, 0, horizon_[k].first, horizon_[k].second);
      join(first + k, 1, first + (k + 1) % count, 2);
      nearest_.push({faces_[first + k].distance, first + k});
    }
    return true;
  }

  const SupportPoint& point(int index) const { return points_[index]; }

 private:
  bool makeFace(int i, int j, int k) {
    const Vec3 ij = points_[j].w - points_[i].w, jk = points_[k].w - points_[j].w,
               ki = points_[i].w - points_[k].w;
    const double a = ij.squaredNorm(), b = jk.squaredNorm(), c = ki.squaredNorm(),
                 longest = std::max({a, b, c});
    // The two shorter edges: in a needle the cross product of the two long ones would cancel.
    Face face{{i, j, k},
              {-1, -1, -1},
              {},
              a == longest   ? jk.cross(ki)
              : b == longest ? ki.cross(ij)
                             : ij.cross(jk)};
    const double area = face.n.norm();
    const bool sound = area > rounding_ * std::sqrt(longest);
    if (area > 0.0) face.n /= area;
    // From the corner nearest to the origin, where rounding is least.
    const auto nearer = [&](int l, int m) { return points_[l].w.squaredNorm() < points_[m].w.squaredNorm(); };
    face.distance = face.n.dot(points_[std::min({i, j, k}, nearer)].w);
    faces_.push_back(face);
    return sound;
  }

  void join(int face, int edge, int other, int other_edge) {
    faces_[face].neighbour[edge] = other, faces_[face].twin[edge] = other_edge;
    faces_[other].neighbour[other_edge] = face, faces_[other].twin[other_edge] = edge;
  }

  void remove(int face) {
    faces_[face].alive = false;
    removed_.push_back(face);
  }

  // Floods over the faces that w sees, entering `face` through `edge`; the edges at which it stops come out
  // in order around the horizon.
  void walk(int face, int edge, const Vec3& w) {
    Face& f = faces_[face];
    if (!f.alive) return;
    if (f.n.dot(w) <= f.distance - rounding_) {
      horizon_.emplace_back(face, edge);
      return;
    }
    remove(face);
    const int left = next(edge), right = next(left);
    walk(f.neighbour[left], f.twin[left], w);
    walk(f.neighbour[right], f.twin[right], w);
  }

  using Entry = std::pair<double, int>;  // distance, face
  std::vector<SupportPoint> points_;
  std::vector<Face> faces_;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<Entry>> nearest_;
  std::vector<std::pair<int, int>> horizon_;
  std::vector<int> removed_;
  double rounding_;
};

// Adds to the simplex the support point, among those along the given directions and their opposites, with
// the largest `height` over it. Returns that height.
template <class Height>
double grow(const SupportFunction& support, Simplex& simplex, std::initializer_list<Vec3> directions,
            const Height& height) {
  SupportPoint best{Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
  double best_height = -1.0;
  for (const Vec3& direction : directions)
    for (const double sign : {1.0, -1.0}) {
      const SupportPoint p = support(sign * direction);
      const double h = height(p.w);
      if (h > best_height) best_height = h, best = p;
    }
  simplex.add(best);
  return best_height;
}

// Makes any simplex a tetrahedron. Empty when A - B is flat; then `n` is normal to it.
bool makeTetrahedron(const SupportFunction& support, Simplex& s, double scale, Vec3& n) {
  const double flat = kRounding * scale;
  if (s.size == 1 && grow(support, s, {Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()},
                          [&](const Vec3& w) { return (w - s.points[0].w).norm(); }) <= flat)
    return false;
  const Vec3& p = s.points[0].w;
  const Vec3 along = (s.points[1].w - p).normalized();
  if (s.size == 2) {
    const auto [t1, t2] = tangents(along);
    n = t1;
    if (grow(support, s, {t1, t2}, [&](const Vec3& w) { return along.cross(w - p).norm(); }) <= flat)
      return false;
  }
  if (s.size == 3) {
    n = along.cross(s.points[2].w - p).normalized();
    if (grow(support, s, {n}, [&](const Vec3& w) { return std::abs(n.dot(w - p)); }) <= flat) return false;
  }
  return true;
}

// Witnesses where the origin projects on a face, by its barycentric coordinates.
void setWitnesses(const Polytope& polytope, const Face& face, EpaResult& result) {
  const SupportPoint &p = polytope.point(face.corner[0]), &q = polytope.point(face.corner[1]),
                     &r = polytope.point(face.corner[2]);
  const Vec3 e1 = q.w - p.w, e2 = r.w - p.w, to_origin = face.distance * face.n - p.w;
  const Vec3 n = e1.cross(e2);
  const double s = to_origin.cross(e2).dot(n) / n.squaredNorm();
  const double t = e1.cross(to_origin).dot(n) / n.squaredNorm();
  result.a = p.a + s * (q.a - p.a) + t * (r.a - p.a);
  result.b = p.b + s * (q.b - p.b) + t * (r.b - p.b);
}

EpaResult flatResult(const Simplex& simplex, const Vec3& n) {
  EpaResult result;
  result.n = n;
  result.a = simplex.witnessA();
  result.b = simplex.witnessB();
  return result;
}

}  // namespace

EpaResult epa(const SupportFunction& support, const Simplex& simplex, double scale,
              const FinishFunction& finish) {
  Simplex tetrahedron = simplex;
  Vec3 flat_normal = Vec3::UnitZ();
  if (!makeTetrahedron(support, tetrahedron, scale, flat_normal)) return flatResult(simplex, flat_normal);

  Polytope polytope(tetrahedron, kRounding * scale);
  EpaResult result;
  result.upper = std::numeric_limits<double>::infinity();
  result.lower = -std::numeric_limits<double>::infinity();
  Face best{};
  bool tessellating = false, best_is_finished = false;
  double least = result.lower;  // distance of the whole polytope
  // The least distances of the faces given up, and of those that proved enough.
  double given_up = std::numeric_limits<double>::infinity(), proved = given_up;
  // Whether the direction near that of a face proves that none it leaves open, those within
  // acos(distance / upper) of its normal, is shallower than `upper`. A better direction is kept.
  const auto closes = [&](const Face& face) {
    const std::array<SupportPoint, 3> corners{polytope.point(face.corner[0]), polytope.point(face.corner[1]),
                                              polytope.point(face.corner[2])};
    Finished finished = finish(face.n, corners.data(), 3);
    if (finished.nearest.size == 0) return false;
    const double depth = finished.n.dot(support(finished.n).w);
    const Vec3 touching = reduceToNearest(finished.nearest);
    if ((touching - depth * finished.n).norm() > kClosed * scale) return false;
    if (depth < result.upper + (best_is_finished ? 0.0 : kRounding * scale)) {
      result.upper = depth, result.n = finished.n;
      result.a = finished.nearest.witnessA(), result.b = finished.nearest.witnessB();
      best_is_finished = true;
    }
    const double open = std::acos(std::min(face.distance / result.upper, 1.0));
    const double turned = 2.0 * std::asin(std::min(0.5 * (face.n - finished.n).norm(), 1.0));
    return open + turned < EIGEN_PI && provesDepth(finished, depth, open + turned, kClosed * scale);
  };
  for (; result.iterations < kEpaIterations; ++result.iterations) {
    const Face* nearest = polytope.nearestFace();
    if (nearest == nullptr) {
      result.lower = std::max(result.lower, std::min(result.upper, given_up));
      break;
    }
    const Face face = *nearest;
    // Once the origin is inside, the least distance only grows, unless slivers have made the polytope lose
    // its shape.
    if (least > 0.0 && face.distance < least - kBroken * scale) break;
    const SupportPoint p = support(face.n);
    const double upper = face.n.dot(p.w);
    result.lower = std::max(result.lower, std::min(face.distance, given_up));
    least = std::max(least, std::min({face.distance, given_up, proved}));
    if (upper < result.upper - (best_is_finished ? kRounding * scale : 0.0)) {
      result.upper = upper;
      best = face, best_is_finished = false;
      result.n = face.n;
      setWitnesses(polytope, face, result);
    }
    if (result.upper - face.distance <= kClosed * scale) break;
    if (finish && face.distance > 0.0 && result.upper - face.distance <= kFeatures * result.upper) {
      if (closes(face)) {
        proved = std::min(proved, face.distance);
        polytope.giveUpNearest();
        continue;
      }
    }
    tessellating =
        finish && result.iterations >= kTessellating && result.upper - face.distance <= kCoarse * scale;
    if (tessellating) break;
    if (!polytope.expand(*nearest, p)) {
      given_up = std::min(given_up, face.distance);
      polytope.giveUpNearest();
    }
  }
  result.lower = std::min(result.lower, result.upper);
  if (!finish) return result;
  const auto take = [&](const Face& face, const Vec3& direction) {
    const std::array<SupportPoint, 3> corners{polytope.point(face.corner[0]), polytope.point(face.corner[1]),
                                              polytope.point(face.corner[2])};
    Finished finished = finish(direction, corners.data(), 3);
    const Vec3& n = finished.n;
    const SupportPoint p = support(n);
    const double upper = n.dot(p.w);
    if (upper > result.upper + (&face == &best ? kRounding * scale : 0.0)) return;
    if (&face != &best) setWitnesses(polytope, face, result);
    result.n = n, result.upper = upper;
    const bool spanned = finished.nearest.size > 0 &&
                         (reduceToNearest(finished.nearest) - upper * n).norm() <= kSpanned * scale;
    if (spanned) {
      result.a = finished.nearest.witnessA(), result.b = finished.nearest.witnessB();
    } else {  // chords lie below the surface
      result.a += n.dot(p.a - result.a) * n, result.b += n.dot(p.b - result.b) * n;
    }
  };
  if (std::isfinite(result.upper) && !best_is_finished) take(best, result.n);
  for (const Face* face = polytope.nearestFace(); tessellating && face && face->distance < result.upper;
       face = polytope.nearestFace()) {
    take(*face, face->n);
    polytope.giveUpNearest();
  }
  return result;
}

}  // namespace rbs
