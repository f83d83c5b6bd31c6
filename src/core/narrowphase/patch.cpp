// SPDX-License-Identifier: BSD-3-Clause
// Both facets are projected along the normal n, where they are convex polygons (or segments): the patch is
// their intersection. The gap at a point of the plane is the difference of the heights at which the line
// through it along n meets the facets. The two are treated alike, so that it does not matter whose face is
// better aligned, and nothing flickers when that changes. A facet on which an edge or a corner of the other
// rests leaves the margin soon, so that an edge keeps its two ends and a corner its one point without being
// told apart. Where n is the normal of no face, edges or corners meet: then the highest edge stands for a
// face. The part of a side over one of the two faces of an edge would end where it crosses that edge, and
// that end moves far along the two as they turn a little.
//
// A corner of the patch is named by what it is made of: a corner of A, a corner of B, or an edge of each
// that cross. Edges are named by their ends, so that an edge that two faces share keeps its name when the
// other face takes over.
#include "narrowphase/patch.h"

#include "base/algebra.h"
#include "narrowphase/tolerances.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <tuple>

namespace rbs {

namespace {

using Vec2 = Eigen::Vector2d;

// How far two round sides may lie beside each other, as a share of their radii of curvature, and still touch
// there.
constexpr double kAside = 1e-2;

enum Owner : std::uint32_t { kOfA = 0, kOfB = 1 };

// An edge of one facet, by the numbers of its ends.
struct Edge {
  Owner owner;
  std::uint32_t from, to;
};

// A corner of the patch and the edge that leaves it.
struct Corner {
  Vec2 x;
  Edge leaving;
};

// Forty bits or so are mixed into thirty-two; two corners of a patch that share a name would only mix up
// the warm start of their forces.
std::uint32_t nameOf(std::uint64_t key) {
  key *= 0x9E3779B97F4A7C15u;
  key ^= key >> 32;
  key *= 0xD6E8FEB86659FD93u;
  return static_cast<std::uint32_t>(key >> 32);
}

std::uint32_t nameOfCorner(Owner owner, std::uint32_t id) {
  return nameOf(1u + 2u * id + owner);
}

std::uint32_t nameOfCrossing(const Edge& e, const Edge& f) {
  const auto ends = [](const Edge& edge) {
    return std::uint64_t{std::min(edge.from, edge.to)} << 16 | std::max(edge.from, edge.to);
  };
  return e.owner == kOfA ? nameOf(ends(e) << 32 | ends(f)) : nameOf(ends(f) << 32 | ends(e));
}

bool meetInCorner(const Edge& entering, const Edge& leaving) {
  return entering.owner == leaving.owner && entering.to == leaving.from;
}

std::uint32_t nameOfMeeting(const Edge& entering, const Edge& leaving) {
  if (meetInCorner(entering, leaving)) return nameOfCorner(entering.owner, entering.to);
  return nameOfCrossing(entering, leaving);
}

// A facet projected along n, and the height of its plane (or line) there: h0 + slope.x.
struct Shadow {
  Owner owner;
  int size;
  std::array<Vec2, Facet::kCorners> x;
  const std::array<std::uint32_t, Facet::kCorners>& ids;
  double h0 = 0.0;
  Vec2 slope = Vec2::Zero();
  bool flat = false;  // a polygon whose normal is nearly n

  Shadow(Owner whose, const Facet& facet, const Vec3& origin, const Mat3& R)
      : owner(whose), size(facet.size), ids(facet.ids) {
    const auto seen = [&](int k) -> Vec3 { return R.transpose() * (facet.corners[k] - origin); };
    const Vec3 first = seen(0);
    Vec3 normal = Vec3::Zero();  // of the plane, by Newell's sum of areas
    Vec3 last = first;
    x[0] = first.head<2>();
    for (int k = 1; k < size; ++k) {
      const Vec3 corner = seen(k);
      normal += (last - first).cross(corner - first);
      last = corner;
      x[k] = corner.head<2>();
    }
    if (size == 2) {
      const Vec3 along = last - first;
      const double squared = along.head<2>().squaredNorm();
      if (squared > 0.0) slope = along.z() / squared * along.head<2>();
    } else if (normal.z() != 0.0) {
      slope = normal.head<2>() / -normal.z();
      flat = std::abs(normal.z()) >= (1.0 - kAligned) * normal.norm();
    }
    h0 = first.z() - slope.dot(x[0]);
  }

  double height(const Vec2& at) const { return h0 + slope.dot(at); }
  const Vec2& cornerOf(std::uint32_t id) const {
    const auto place = std::find(ids.begin(), ids.begin() + size, id);
    assert(place != ids.begin() + size);
    return x[static_cast<std::size_t>(place - ids.begin())];
  }
  Edge edge(int k) const { return {owner, ids[k], ids[k + 1 == size ? 0 : k + 1]}; }
};

// Of a polygon's edges the one whose lower end is highest along n.
Facet highestEdge(const Facet& polygon, const Vec3& n) {
  const auto after = [&](int k) { return k + 1 == polygon.size ? 0 : k + 1; };
  int best = 0;
  double most = -std::numeric_limits<double>::infinity();
  for (int k = 0; k < polygon.size; ++k) {
    if (polygon.corners[k] == polygon.corners[after(k)]) continue;
    const double lower = std::min(n.dot(polygon.corners[k]), n.dot(polygon.corners[after(k)]));
    if (lower > most) most = lower, best = k;
  }
  Facet edge;
  edge.add(polygon.corners[best], polygon.ids[best]);
  edge.add(polygon.corners[after(best)], polygon.ids[after(best)]);
  return edge;
}

double cross(const Vec2& u, const Vec2& v) {
  return u.x() * v.y() - u.y() * v.x();
}

struct Polygon {
  int size = 0;
  std::array<Corner, 2 * Facet::kCorners + 1>
      corners;  // clipping a convex polygon by a line adds one at most

  void add(const Vec2& x, const Edge& leaving) {
    if (size < static_cast<int>(corners.size())) corners[size++] = {x, leaving};
  }
};

// Keeps the part on the inner side of the line through p along the unit vector u (Sutherland and Hodgman,
// CACM 17(1), 1974). Outside is where cross(u, x - p) < -overhang.
void clip(Polygon& polygon, const Vec2& p, const Vec2& u, double overhang, const Edge& edge) {
  std::array<double, std::tuple_size_v<decltype(polygon.corners)>> excess;
  double most = 0.0;
  for (int k = 0; k < polygon.size; ++k) {
    excess[k] = -cross(u, polygon.corners[k].x - p) - overhang;
    most = std::max(most, excess[k]);
  }
  if (most == 0.0) return;
  const Polygon whole = polygon;
  polygon.size = 0;
  for (int k = 0; k < whole.size; ++k) {
    const int next = k + 1 == whole.size ? 0 : k + 1;
    const Corner &c = whole.corners[k], &d = whole.corners[next];
    const bool inside = excess[k] <= 0.0;
    if (inside) polygon.add(c.x, c.leaving);
    if (inside == (excess[next] <= 0.0)) continue;
    const double t = excess[k] / (excess[k] - excess[next]);
    polygon.add(c.x + t * (d.x - c.x), inside ? edge : c.leaving);
  }
}

double sizeOf(const Facet& facet) {
  double size = 0.0;
  for (int k = 1; k < facet.size; ++k)
    size = std::max(size, (facet.corners[k] - facet.corners[0]).cwiseAbs().maxCoeff());
  return size;
}

class Patch {
 public:
  Patch(const FacingFacets& facing, double margin) : facing_(facing), margin_(margin) {
    const auto [t1, t2] = tangents(facing.n);
    R_.col(0) = t1, R_.col(1) = t2, R_.col(2) = facing.n;
    const double size_a = sizeOf(facing.a), size_b = sizeOf(facing.b);
    size_ = std::max(size_a, size_b);
    overhang_ = kOverhang * std::min(size_a, size_b);
  }

  Manifold find() {
    const int a = facing_.a.size, b = facing_.b.size;
    if (a == 2 && b == 2) {
      addEdges(facing_.a, facing_.b);
    } else if (a > 1 && b > 1) {
      const Shadow on_a(kOfA, facing_.a, facing_.middle, R_), on_b(kOfB, facing_.b, facing_.middle, R_);
      if (!on_a.flat && !on_b.flat)
        addEdges(a == 2 ? facing_.a : highestEdge(facing_.a, facing_.n),
                 b == 2 ? facing_.b : highestEdge(facing_.b, -facing_.n));
      else if (a == 2)
        addEdgeOnFace(on_a, on_b, on_a, on_b);
      else if (b == 2)
        addEdgeOnFace(on_b, on_a, on_a, on_b);
      else
        addFaces(on_a, on_b);
    }
    if (facing_.has_middle && deepest_ > facing_.distance + kCovers * size_)
      manifold_.add(facing_.middle, facing_.distance, 0);
    return manifold_;
  }

 private:
  // The outward side of A's facet is seen anticlockwise along n, B's clockwise.
  void addFaces(const Shadow& on_a, const Shadow& on_b) {
    Polygon polygon;
    for (int k = on_b.size - 1; k >= 0; --k) {
      const int next = k == 0 ? on_b.size - 1 : k - 1;
      polygon.add(on_b.x[k], {kOfB, on_b.ids[k], on_b.ids[next]});
    }
    for (int k = 0; k < on_a.size; ++k) {
      const Vec2 along = on_a.x[k + 1 == on_a.size ? 0 : k + 1] - on_a.x[k];
      const double length = along.norm();
      if (length > 0.0) clip(polygon, on_a.x[k], along / length, overhang_, on_a.edge(k));
    }
    for (int k = 0; k < polygon.size; ++k) {
      const Corner& corner = polygon.corners[k];
      const Edge& entering = polygon.corners[k == 0 ? polygon.size - 1 : k - 1].leaving;
      // A's edges were moved out by the overhang; its corners are where they are.
      const bool is_of_a = meetInCorner(entering, corner.leaving) && entering.owner == kOfA;
      add(is_of_a ? on_a.cornerOf(entering.to) : corner.x, on_a, on_b,
          nameOfMeeting(entering, corner.leaving));
    }
  }

  // The part of a segment over a polygon (Cyrus and Beck, Computers & Graphics 3(1), 1978).
  void addEdgeOnFace(const Shadow& segment, const Shadow& face, const Shadow& on_a, const Shadow& on_b) {
    const Vec2 p = segment.x[0], along = segment.x[1] - p;
    const double turn = face.owner == kOfA ? 1.0 : -1.0;
    double from = 0.0, to = 1.0;
    std::uint32_t from_name = nameOfCorner(segment.owner, segment.ids[0]),
                  to_name = nameOfCorner(segment.owner, segment.ids[1]);
    for (int k = 0; k < face.size; ++k) {
      Vec2 u = face.x[k + 1 == face.size ? 0 : k + 1] - face.x[k];
      const double length = u.norm();
      if (length == 0.0) continue;
      u *= turn / length;
      const double height = cross(u, p - face.x[k]) + overhang_, climb = cross(u, along);
      if (height < 0.0 && height + climb < 0.0) return;
      if (height < 0.0 && -height > from * climb)
        from = -height / climb, from_name = nameOfCrossing(segment.edge(0), face.edge(k));
      if (height + climb < 0.0 && height < to * -climb)
        to = height / -climb, to_name = nameOfCrossing(segment.edge(0), face.edge(k));
    }
    if (!(from < to)) return;
    add(p + from * along, on_a, on_b, from_name);
    add(p + to * along, on_a, on_b, to_name);
  }

  // The ends of two parallel segments that lie over the other one. Where they cross, their one point is
  // the deepest. Round sides of radii of curvature r and s that lie d beside each other are further apart
  // there by d²/(2 (r + s)): while that is little they still touch along a line.
  void addEdges(const Facet& a, const Facet& b) {
    const Vec3 &p = a.corners[0], &q = b.corners[0];
    const Vec3 u = a.corners[1] - p, v = b.corners[1] - q;
    const double uu = u.squaredNorm(), vv = v.squaredNorm();
    if (uu == 0.0 || vv == 0.0) return;
    const std::array<double, 2> round_a = roundOf(a, u), round_b = roundOf(b, v);
    for (int k = 0; k < 2; ++k) {
      const Vec3& end = b.corners[k];
      const double s = u.dot(end - p) / uu;
      if (s >= -kOverhang && s <= 1.0 + kOverhang)
        addIfAbove(p + s * u, between(round_a, s), end, round_b[k], nameOfCorner(kOfB, b.ids[k]));
    }
    for (int k = 0; k < 2; ++k) {
      const Vec3& end = a.corners[k];
      const double s = v.dot(end - q) / vv;
      if (s > kOverhang && s < 1.0 - kOverhang)
        addIfAbove(end, round_a[k], q + s * v, between(round_b, s), nameOfCorner(kOfA, a.ids[k]));
    }
  }

  // Of a line that is no line of contact, since n is tilted along it, no roundness counts.
  std::array<double, 2> roundOf(const Facet& line, const Vec3& along) const {
    return std::abs(facing_.n.dot(along)) <= kAside * along.norm() ? line.round : std::array<double, 2>{};
  }
  static double between(const std::array<double, 2>& ends, double s) {
    return ends[0] + s * (ends[1] - ends[0]);
  }

  // Two points that do not face each other along n, up to a fraction of what they are rounded by, are none.
  // What lies between them is shared in proportion to the radii of curvature: there the normals are equal.
  void addIfAbove(const Vec3& on_a, double round_a, const Vec3& on_b, double round_b, std::uint32_t name) {
    const double radius_a = facing_.radius_a, radius_b = facing_.radius_b;
    const double along_n = facing_.n.dot(on_b - on_a);
    const Vec3 aside = on_b - on_a - along_n * facing_.n;
    const double round = radius_a + round_a + radius_b + round_b;
    if (aside.norm() > overhang_ + kAside * round) return;
    const double share = round > 0.0 ? (radius_a + round_a) / round : 0.5;
    const double apart = round > 0.0 ? 0.5 * aside.squaredNorm() / round : 0.0;
    keep(on_a + share * aside + 0.5 * (along_n + radius_a - radius_b) * facing_.n,
         along_n - radius_a - radius_b + apart, name);
  }

  void add(const Vec2& x, const Shadow& on_a, const Shadow& on_b, std::uint32_t name) {
    const double a = on_a.height(x) + facing_.radius_a, b = on_b.height(x) - facing_.radius_b;
    // No two points of the bodies are deeper along n than the bodies are: what is came from the overhang.
    keep(facing_.middle + R_ * Vec3(x.x(), x.y(), 0.5 * (a + b)), std::max(b - a, facing_.distance), name);
  }

  void keep(const Vec3& point, double separation, std::uint32_t name) {
    if (!(separation <= margin_)) return;
    deepest_ = std::min(deepest_, separation);
    manifold_.add(point, separation, name);
  }

  const FacingFacets& facing_;
  double margin_;
  Mat3 R_;           // columns: two tangents and n, in A's frame
  double size_;      // of the larger facet, m
  double overhang_;  // by which a corner may lie beside the other facet and still be over it, m
  double deepest_ = std::numeric_limits<double>::infinity();
  Manifold manifold_;
};

}  // namespace

Manifold patchOf(const FacingFacets& facing, double margin) {
  return Patch(facing, margin).find();
}

}  // namespace rbs
