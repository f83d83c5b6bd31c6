// SPDX-License-Identifier: BSD-3-Clause
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

#include "base/algebra.h"
#include "narrowphase/depth_proof.h"
#include "narrowphase/tolerances.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory_resource>
#include <queue>
#include <vector>

namespace rbs {

namespace {

// The interval of the depth is closed when it is this small.
constexpr double kKnown = 64.0 * std::numeric_limits<double>::epsilon();
// Of the depth: the interval at which the features that meet are known well enough to ask for a proof.
constexpr double kFeaturesOfDepth = 0.05;
// After so many rounds directions tie about an axis, or nearly so, and that is asked for.
constexpr int kTies = 32;
// After so many, if all is within this fraction of the size, the rest is finished without a proof.
constexpr int kUnproved = 512;
constexpr double kCoarse = 1e-3;
// rad: the widest cap about a direction that is asked to prove itself.
constexpr double kWidest = 0.6;
// Of the size: how well the points of a finished direction span the depth.
constexpr double kSpanned = 1e-9;

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
  using Memory = std::pmr::memory_resource;

  Polytope(const Simplex& s, double rounding, Memory* memory)
      : points_(s.points.begin(), s.points.end(), memory),
        faces_(memory),
        nearest_(memory),
        horizon_(memory),
        removed_(memory),
        rounding_(rounding) {
    points_.reserve(kUsual), faces_.reserve(6 * kUsual), horizon_.reserve(kUsual), removed_.reserve(kUsual);
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

  // Replaces what `point` sees, starting with `seen`, by the cone from it over the horizon. Where an edge of
  // the horizon is in line with the point, the face beyond it is replaced too. False, with nothing changed,
  // when the cone would have a face without area all the same.
  bool expand(const Face& seen, const SupportPoint& point) {
    const int start = static_cast<int>(&seen - faces_.data());
    const int apex = static_cast<int>(points_.size()), first = static_cast<int>(faces_.size());
    points_.push_back(point);
    std::vector<int> in_line;
    for (bool sound = false; !sound;) {
      horizon_.clear();
      removed_.clear();
      remove(start);
      for (int edge = 0; edge < 3; ++edge)
        walk(faces_[start].neighbour[edge], faces_[start].twin[edge], point.w, in_line);
      sound = true;
      const std::size_t before = in_line.size();
      for (const auto& [face, edge] : horizon_)
        if (!makeFace(faces_[face].corner[next(edge)], faces_[face].corner[edge], apex)) {
          sound = false;
          in_line.push_back(face);
        }
      if (sound && horizon_.size() >= 3) break;
      faces_.resize(first);
      for (const int face : removed_) faces_[face].alive = true;
      if (in_line.size() == before) {
        points_.pop_back();
        return false;
      }
    }
    const int count = static_cast<int>(horizon_.size());
    for (int k = 0; k < count; ++k) {
      join(first + k, 0, horizon_[k].first, horizon_[k].second);
      join(first + k, 1, first + (k + 1) % count, 2);
      nearest_.push({faces_[first + k].distance, first + k});
    }
    return true;
  }

  bool hasCorner(const Face& face, const Vec3& w) const {
    return std::any_of(face.corner.begin(), face.corner.end(), [&](int k) { return points_[k].w == w; });
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
    const bool sound = area > 0.0 && area * area > rounding_ * rounding_ * longest;
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

  // Floods over the faces that w sees, and the given ones, entering `face` through `edge`; the edges at which
  // it stops come out in order around the horizon.
  void walk(int face, int edge, const Vec3& w, const std::vector<int>& given) {
    Face& f = faces_[face];
    if (!f.alive) return;
    if (f.n.dot(w) <= f.distance - rounding_ && std::find(given.begin(), given.end(), face) == given.end()) {
      horizon_.emplace_back(face, edge);
      return;
    }
    remove(face);
    const int left = next(edge), right = next(left);
    walk(f.neighbour[left], f.twin[left], w, given);
    walk(f.neighbour[right], f.twin[right], w, given);
  }

  static constexpr int kUsual = 16;  // points: with fewer no memory is asked for twice

  using Entry = std::pair<double, int>;  // distance, face
  std::pmr::vector<SupportPoint> points_;
  std::pmr::vector<Face> faces_;
  std::priority_queue<Entry, std::pmr::vector<Entry>, std::greater<Entry>> nearest_;
  std::pmr::vector<std::pair<int, int>> horizon_;
  std::pmr::vector<int> removed_;
  double rounding_;
};

// No direction in it is shallower than the depth.
struct Cap {
  Vec3 n;
  double angle;  // rad, from n
};

// Those of the points that reach this far along n.
Simplex pointsAt(const Simplex& points, const Vec3& n, double height) {
  Simplex reaching;
  for (int k = 0; k < points.size; ++k)
    if (n.dot(points.points[k].w) >= height) reaching.add(points.points[k]);
  return reaching;
}

// The two of at least as many points that are farthest from each other.
Simplex farthestTwo(const Simplex& points) {
  Simplex two;
  double farthest = -1.0;
  for (int i = 0; i < points.size; ++i)
    for (int j = i + 1; j < points.size; ++j) {
      const double distance = (points.points[j].w - points.points[i].w).squaredNorm();
      if (distance <= farthest) continue;
      farthest = distance, two.size = 0;
      two.add(points.points[i]), two.add(points.points[j]);
    }
  return two;
}

double angleBetween(const Vec3& m, const Vec3& n) {
  return 2.0 * std::asin(std::min(0.5 * (m - n).norm(), 1.0));
}

// rad, from the circle of the belt to n.
double angleFrom(const Belt& belt, const Vec3& n) {
  const double along = belt.axis.dot(n), sine = std::sqrt(std::max(1.0 - belt.cosine * belt.cosine, 0.0));
  return std::abs(std::atan2(belt.axis.cross(n).norm(), along) - std::atan2(sine, belt.cosine));
}

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
  const double flat = kChainRounding * scale;
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

  std::array<std::byte, 32768> usual;  // what most pairs need: none of it is asked of the heap
  std::pmr::monotonic_buffer_resource memory(usual.data(), usual.size());
  Polytope polytope(tetrahedron, kChainRounding * scale, &memory);
  EpaResult result;
  result.upper = std::numeric_limits<double>::infinity();
  result.lower = -std::numeric_limits<double>::infinity();
  Face best{};
  bool best_is_finished = false, unproved = false;
  double given_up = std::numeric_limits<double>::infinity();  // least distance of the faces given up
  std::pmr::vector<Cap> caps(&memory);
  std::pmr::vector<std::pair<Belt, double>> proven_belts(&memory);  // with their widths
  // The directions that a face leaves open are those within this angle of its normal.
  const auto open = [&](const Face& face) { return std::acos(std::min(face.distance / result.upper, 1.0)); };
  const auto cornersOf = [&](const Face& face) {
    return std::array{polytope.point(face.corner[0]), polytope.point(face.corner[1]),
                      polytope.point(face.corner[2])};
  };
  // Whether a direction near that of the face proves that none it leaves open is shallower than `upper`. A
  // better direction is kept.
  const auto closes = [&](const Face& face, Seek seek) {
    Finished finished = finish(face.n, cornersOf(face).data(), 3, seek);
    for (const Belt& belt : finished.belts) {
      const double width = provenWidth(belt, result.upper, kKnown * scale);
      if (width > open(face) + angleFrom(belt, face.n)) {
        proven_belts.push_back({belt, width});
        return true;
      }
    }
    if (finished.nearest.size == 0) return false;
    const double height = finished.n.dot(support(finished.n).w);
    const Simplex reaching = pointsAt(finished.nearest, finished.n, height - kKnown * scale);
    if (reaching.size == 0) return false;
    finished.nearest = reaching;
    const Vec3 touching = reduceToNearest(finished.nearest);
    if (height < result.upper + (best_is_finished ? 0.0 : kChainRounding * scale)) {
      result.upper = height, result.n = finished.n;
      result.a = finished.nearest.witnessA(), result.b = finished.nearest.witnessB();
      best_is_finished = (touching - height * finished.n).norm() <= kKnown * scale;
      best = face;
    }
    const double needed = open(face) + angleBetween(face.n, finished.n);
    if (!(needed < EIGEN_PI)) return false;
    const auto proves = [&](double angle) {
      return provesDepth(finished, height, result.upper, angle, kKnown * scale);
    };
    if (!proves(needed)) {
      if (reaching.size < 3) return false;
      finished.nearest = farthestTwo(reaching);
      if (!proves(needed)) return false;
    }
    double angle = kWidest;
    while (angle > needed && !proves(angle)) angle *= 0.5;
    caps.push_back({finished.n, std::max(angle, needed)});
    return true;
  };
  const auto covered = [&](const Face& face) {
    const double angle = open(face);
    return std::any_of(caps.begin(), caps.end(),
                       [&](const Cap& cap) {
                         return angle <= cap.angle && angle + angleBetween(face.n, cap.n) <= cap.angle;
                       }) ||
           std::any_of(proven_belts.begin(), proven_belts.end(), [&](const auto& belt) {
             return angle + angleFrom(belt.first, face.n) <= belt.second;
           });
  };
  for (; result.iterations < kEpaIterations; ++result.iterations) {
    const Face* nearest = polytope.nearestFace();
    if (nearest == nullptr) {
      result.lower = std::max(result.lower, std::min(result.upper, given_up));
      break;
    }
    const Face face = *nearest;
    result.lower = std::max(result.lower, std::min(face.distance, given_up));
    if (result.upper - face.distance <= kKnown * scale) break;
    const bool round = finish && face.distance > 0.0;
    if (round && covered(face)) {
      polytope.giveUpNearest();
      continue;
    }
    const SupportPoint p = support(face.n);
    const double upper = face.n.dot(p.w);
    if (upper < result.upper - (best_is_finished ? kChainRounding * scale : 0.0)) {
      result.upper = upper;
      best = face, best_is_finished = false;
      result.n = face.n;
      setWitnesses(polytope, face, result);
    }
    if (result.upper - face.distance <= kKnown * scale) break;
    if (round && result.upper - face.distance <= kFeaturesOfDepth * result.upper &&
        (closes(face, Seek::Stationary) ||
         (result.iterations >= kTies && (closes(face, Seek::PinnedByA) || closes(face, Seek::PinnedByB))))) {
      polytope.giveUpNearest();
      continue;
    }
    unproved = round && result.iterations >= kUnproved && result.upper - face.distance <= kCoarse * scale;
    if (unproved) break;
    // A face whose own corner lies highest over it is as good as rounding lets it be.
    if (polytope.hasCorner(face, p.w) || !polytope.expand(*nearest, p)) {
      given_up = std::min(given_up, face.distance);
      polytope.giveUpNearest();
    }
  }
  for (const Face* face = polytope.nearestFace(); unproved && face && face->distance < result.upper;
       face = polytope.nearestFace()) {
    closes(*face, Seek::Stationary);
    polytope.giveUpNearest();
  }
  result.lower = std::min(result.lower, result.upper);
  if (!finish || !std::isfinite(result.upper) || best_is_finished) return result;
  Finished finished = finish(result.n, cornersOf(best).data(), 3, Seek::Stationary);
  const Vec3& n = finished.n;
  const SupportPoint p = support(n);
  const double upper = n.dot(p.w);
  if (upper > result.upper + kChainRounding * scale) return result;
  result.n = n, result.upper = upper;
  if (finished.nearest.size > 0 &&
      (reduceToNearest(finished.nearest) - upper * n).norm() <= kSpanned * scale) {
    result.a = finished.nearest.witnessA(), result.b = finished.nearest.witnessB();
  } else {  // chords lie below the surface
    result.a += n.dot(p.a - result.a) * n, result.b += n.dot(p.b - result.b) * n;
  }
  return result;
}

}  // namespace rbs
