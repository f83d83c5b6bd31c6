// SPDX-License-Identifier: BSD-3-Clause
#include "rigid_body_sim/queries.h"

#include "base/checks.h"
#include "base/text.h"
#include "narrowphase/collide.h"
#include "narrowphase/ray_cast.h"

#include <algorithm>
#include <cmath>

namespace rbs {

namespace {

// The direction of a vector of any length above 0, be it so long or short that its square is not a number.
Vec3 unit(const Vec3& v) {
  return (v / v.cwiseAbs().maxCoeff()).normalized();
}

void check(const Ray& ray) {
  std::vector<Problem> problems;
  checkVector(ray.origin_W, Limits::max_position, "origin", "m", problems);
  if (!ray.direction_W.allFinite() || ray.direction_W.isZero(0.0))
    problems.push_back({"direction", textOf(ray.direction_W), "finite and not zero"});
  if (!(ray.max_distance > 0.0)) problems.push_back({"max_distance", text(ray.max_distance), "above 0 m"});
  throwIfAny(problems);
}

// A ray cast against single bodies.
class Cast {
 public:
  explicit Cast(const Ray& ray) : origin_W_(ray.origin_W), d_W_(unit(ray.direction_W)) {}

  std::optional<RayHit> onto(const BodyDescription& body, const Pose& pose, double max_distance) const {
    if (isFarOff(body.shape, pose, max_distance)) return std::nullopt;
    const Quat q_BW = pose.q_WB.conjugate();
    const auto entry = rbs::castRay(body.shape, q_BW * (origin_W_ - pose.p_WB), q_BW * d_W_);
    if (!entry || entry->distance > max_distance) return std::nullopt;
    return RayHit{body.id, origin_W_ + entry->distance * d_W_, pose.q_WB * entry->n_B, entry->distance};
  }

 private:
  // Whether the ray misses the ball about the body, by more than rounding.
  bool isFarOff(const Shape& shape, const Pose& pose, double max_distance) const {
    const double radius = 1.01 * boundingRadius(shape);
    if (!std::isfinite(radius)) return false;
    const Vec3 to_centre = pose.p_WB - origin_W_;
    const double along = to_centre.dot(d_W_);
    return along < -radius || along - radius > max_distance ||
           to_centre.cross(d_W_).squaredNorm() > radius * radius;
  }

  Vec3 origin_W_, d_W_;
};

bool isIgnored(const Ray& ray, BodyId body) {
  return std::find(ray.ignore.begin(), ray.ignore.end(), body) != ray.ignore.end();
}

std::size_t require(const Snapshot& snapshot, BodyId id, const char* path) {
  const int index = snapshot.find(id);
  if (index < 0) throw InvalidInput({{path, std::to_string(id.serial), "a body of this world"}});
  return static_cast<std::size_t>(index);
}

}  // namespace

std::optional<RayHit> castRay(const Snapshot& snapshot, const Ray& ray) {
  check(ray);
  const Cast cast(ray);
  std::optional<RayHit> nearest;
  for (std::size_t i = 0; i < snapshot.states.size(); ++i) {
    const BodyDescription& body = (*snapshot.bodies)[i];
    const auto hit = cast.onto(body, snapshot.states[i].pose, nearest ? nearest->distance : ray.max_distance);
    if (hit && !(nearest && hit->distance == nearest->distance) && !isIgnored(ray, body.id)) nearest = hit;
  }
  return nearest;
}

std::vector<RayHit> castRayThrough(const Snapshot& snapshot, const Ray& ray) {
  check(ray);
  const Cast cast(ray);
  std::vector<RayHit> hits;
  for (std::size_t i = 0; i < snapshot.states.size(); ++i) {
    const BodyDescription& body = (*snapshot.bodies)[i];
    const auto hit = cast.onto(body, snapshot.states[i].pose, ray.max_distance);
    if (hit && !isIgnored(ray, body.id)) hits.push_back(*hit);
  }
  std::stable_sort(hits.begin(), hits.end(),
                   [](const RayHit& a, const RayHit& b) { return a.distance < b.distance; });
  return hits;
}

ClosestPoints closestPoints(const Snapshot& snapshot, BodyId a, BodyId b) {
  const std::size_t i = require(snapshot, a, "body_a"), j = require(snapshot, b, "body_b");
  const Shape &shape_a = (*snapshot.bodies)[i].shape, &shape_b = (*snapshot.bodies)[j].shape;
  if (i == j) throw InvalidInput({{"body_b", (*snapshot.bodies)[j].name, "another body than body_a"}});
  if (traitsOf(shape_a).unbounded && traitsOf(shape_b).unbounded)
    throw InvalidInput({{"body_b", "a plane like body_a", "a body with a distance: two planes have none"}});
  const Gap found = gap(shape_a, snapshot.states[i].pose, shape_b, snapshot.states[j].pose);
  return {found.distance, found.n_W, found.p_WA, found.p_WB};
}

std::vector<Neighbour> overlaps(const Snapshot& snapshot, const Shape& shape, const Pose& pose,
                                double margin) {
  BodyDef place;
  place.shape = shape;
  place.pose = pose;
  place.kind = BodyKind::Static;
  std::vector<Problem> problems = validate(place, "place");
  if (!(margin >= 0.0 && margin <= Limits::max_position))
    problems.push_back({"margin", text(margin), "0 to " + text(Limits::max_position) + " m"});
  throwIfAny(problems);

  const Pose at{pose.p_WB, pose.q_WB.normalized()};
  const double reach = boundingRadius(shape) + margin;
  std::vector<Neighbour> found;
  for (std::size_t i = 0; i < snapshot.states.size(); ++i) {
    const BodyDescription& body = (*snapshot.bodies)[i];
    const Pose& X_WB = snapshot.states[i].pose;
    const double far = 1.01 * (reach + boundingRadius(body.shape));
    if ((X_WB.p_WB - at.p_WB).squaredNorm() > far * far) continue;
    if (!areWithin(shape, at, body.shape, X_WB, margin)) continue;
    found.push_back({body.id, gap(shape, at, body.shape, X_WB).distance});
  }
  return found;
}

}  // namespace rbs
