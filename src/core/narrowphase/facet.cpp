// SPDX-License-Identifier: BSD-3-Clause
#include "narrowphase/facet.h"

#include "base/algebra.h"
#include "narrowphase/tolerances.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace rbs {

namespace {

constexpr int kRim = 8;
// Tilts, rad, from which a disc stands on one point of its rim, and from which it rolls on it.
constexpr double kTilted = 0.01, kRolls = 0.02;

// The direction across the z axis in which d points; x where it points along z.
Eigen::Vector2d acrossAxis(const Vec3& d) {
  const double across = std::hypot(d.x(), d.y());
  return across > 0.0 ? Eigen::Vector2d(d.x() / across, d.y() / across) : Eigen::Vector2d::UnitX();
}

// Eight points of a circle about the z axis, anticlockwise seen from +z, or from -z when `up` is false. They
// are fixed to the body, so that a disc has the same feet in each step. A disc that is tilted also has the
// point farthest along d, which rolls along the rim and keeps its number. A disc that is tilted further lacks
// the two feet next to that point: they would stop it as it rolls over them.
void addRim(Facet& facet, double radius, double z, bool up, std::uint32_t first_id, const Vec3& d,
            std::uint32_t farthest_id) {
  facet.farthest_id = farthest_id;
  static const std::array<Eigen::Vector2d, kRim> kCircle = [] {
    std::array<Eigen::Vector2d, kRim> circle;
    const double h = std::sqrt(0.5);
    circle = {{{1, 0}, {h, h}, {0, 1}, {-h, h}, {-1, 0}, {-h, -h}, {0, -1}, {h, -h}}};
    return circle;
  }();
  const double tilt = std::hypot(d.x(), d.y()) / std::abs(d.z());
  const double eighths = std::atan2(d.y(), d.x()) * (0.5 * kRim / kPi);
  const int before = static_cast<int>(std::floor(eighths) + kRim) % kRim, after = (before + 1) % kRim;
  for (int k = 0; k < kRim; ++k) {
    const int at = up ? k : kRim - 1 - k;
    if (tilt <= kRolls || (at != before && at != after))
      facet.add({radius * kCircle[at].x(), radius * kCircle[at].y(), z}, first_id + at);
    if (tilt <= kTilted || at != (up ? before : after)) continue;
    const Eigen::Vector2d farthest = radius * acrossAxis(d);
    facet.add({farthest.x(), farthest.y(), z}, farthest_id);
  }
}

}  // namespace

Facet facetTowards(const Box& box, const Vec3& d) {
  int axis;
  d.cwiseAbs().maxCoeff(&axis);
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const bool up = d[axis] >= 0.0;
  Facet facet;
  for (const auto& [right, far] : {std::pair(0, 0), std::pair(1, 0), std::pair(1, 1), std::pair(0, 1)}) {
    // u, v and the axis are right-handed: seen from below the other way round is anticlockwise.
    const int iu = up ? right : far, iv = up ? far : right;
    Vec3 corner;
    corner[axis] = up ? 0.5 * box.size[axis] : -0.5 * box.size[axis];
    corner[u] = iu ? 0.5 * box.size[u] : -0.5 * box.size[u];
    corner[v] = iv ? 0.5 * box.size[v] : -0.5 * box.size[v];
    facet.add(corner, (up ? 1u << axis : 0u) | (iu ? 1u << u : 0u) | (iv ? 1u << v : 0u));
  }
  return facet;
}

Facet facetTowards(const Capsule& capsule, const Vec3& /*d*/) {
  Facet facet;
  facet.add({0.0, 0.0, capsule.half_length}, 0);
  facet.add({0.0, 0.0, -capsule.half_length}, 1);
  return facet;
}

Facet facetTowards(const Cylinder& cylinder, const Vec3& d) {
  Facet facet;
  const double across = std::hypot(d.x(), d.y());
  if (std::abs(d.z()) >= across) {
    const bool up = d.z() > 0.0;
    addRim(facet, cylinder.radius, up ? cylinder.half_length : -cylinder.half_length, up, up ? 0 : kRim, d,
           up ? 2 * kRim : 2 * kRim + 1);
    return facet;
  }
  const Eigen::Vector2d side = cylinder.radius * acrossAxis(d);
  facet.add({side.x(), side.y(), cylinder.half_length}, 2 * kRim);
  facet.add({side.x(), side.y(), -cylinder.half_length}, 2 * kRim + 1);
  facet.round = {cylinder.radius, cylinder.radius};
  return facet;
}

// The base faces (0, 0, -1), the side (h a, r) / sqrt(h² + r²) where a is the direction across the axis.
Facet facetTowards(const Cone& cone, const Vec3& d) {
  Facet facet;
  const double across = std::hypot(d.x(), d.y());
  const double towards_side =
      (cone.height * across + cone.radius * d.z()) / std::hypot(cone.height, cone.radius);
  if (-d.z() >= towards_side) {
    addRim(facet, cone.radius, -0.25 * cone.height, false, 0, d, kRim + 1);
    return facet;
  }
  const Eigen::Vector2d side = cone.radius * acrossAxis(d);
  facet.add({0.0, 0.0, 0.75 * cone.height}, kRim);
  facet.add({side.x(), side.y(), -0.25 * cone.height}, kRim + 1);
  // The centre of curvature lies on the axis (Meusnier).
  facet.round = {0.0, cone.radius * std::hypot(cone.height, cone.radius) / cone.height};
  return facet;
}

namespace {

// A face, or kCorners of its corners, spread evenly. Where it is tilted it stands on the two farthest along d, so that these are
// among them.
Facet represented(const Polyhedron& solid, const Polyhedron::Face& face, const Vec3& d) {
  const int corners = static_cast<int>(face.corners.size()), kept = std::min(corners, Facet::kCorners);
  std::array<int, Facet::kCorners> places;
  for (int k = 0; k < kept; ++k) places[k] = k * corners / kept;
  if (kept < corners) {
    const auto reachOf = [&](int place) { return solid.vertices[face.corners[place]].dot(d); };
    std::array<int, 3> lowest{0, 1, 2};
    const auto isFarther = [&](int one, int other) { return reachOf(one) > reachOf(other); };
    std::sort(lowest.begin(), lowest.end(), isFarther);
    for (int place = 3; place < corners; ++place) {
      if (!isFarther(place, lowest[2])) continue;
      lowest[2] = place;
      std::sort(lowest.begin(), lowest.end(), isFarther);
    }
    const bool is_tilted = reachOf(lowest[0]) - reachOf(lowest[2]) > kCovers * solid.bounding_radius;
    for (int k = 0; k < 2 && is_tilted; ++k) {
      const int place = lowest[k], other = lowest[1 - k];
      const auto begin = places.begin(), end = begin + kept;
      if (std::binary_search(begin, end, place)) continue;
      const auto after = std::upper_bound(begin, end, place);  // round about the face
      const auto before = after == begin ? end - 1 : after - 1, next = after == end ? begin : after;
      *(*before == other ? next : before) = place;
      std::sort(begin, end);
    }
  }
  Facet facet;
  for (int k = 0; k < kept; ++k) {
    const int corner = face.corners[places[k]];
    facet.add(solid.vertices[corner], static_cast<std::uint32_t>(corner));
  }
  return facet;
}

}  // namespace

Facet facetTowards(const ConvexHull& hull, const Vec3& d) {
  const Polyhedron& solid = *hull.polyhedron;
  double reach = -std::numeric_limits<double>::infinity();
  for (const Vec3& vertex : solid.vertices) reach = std::max(reach, vertex.dot(d));
  reach -= kCovers * solid.bounding_radius;
  std::array<int, Facet::kCorners> farthest;
  int tied = 0;
  for (int k = 0; k < static_cast<int>(solid.vertices.size()) && tied < Facet::kCorners; ++k)
    if (solid.vertices[k].dot(d) >= reach) farthest[tied++] = k;
  const auto isFarthest = [&](int corner) {
    return std::find(farthest.begin(), farthest.begin() + tied, corner) != farthest.begin() + tied;
  };

  // Where an edge is farthest, another face of one of its ends may face d more than the two that hold both.
  const Polyhedron::Face* best = nullptr;
  std::ptrdiff_t most = 1;
  double alignment = -std::numeric_limits<double>::infinity();
  for (const Polyhedron::Face& face : solid.faces) {
    const double cosine = face.normal.dot(d);
    if (!(cosine > alignment) && most >= tied) continue;
    const std::ptrdiff_t held = std::count_if(face.corners.begin(), face.corners.end(), isFarthest);
    if (held < most || (held == most && !(cosine > alignment))) continue;
    best = &face, most = held, alignment = cosine;
  }
  return represented(solid, *best, d);
}

}  // namespace rbs
