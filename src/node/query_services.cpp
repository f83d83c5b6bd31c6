// SPDX-License-Identifier: BSD-3-Clause
// Queries on the last snapshot: ray casts, closest points, overlaps.
#include "services.h"

#include "body_spec.h"
#include "convert.h"
#include "names.h"
#include "words.h"

#include <rigid_body_sim/CastRay.h>
#include <rigid_body_sim/ClosestPoints.h>
#include <rigid_body_sim/Overlaps.h>
#include <rigid_body_sim/queries.h>

namespace rbs {
namespace {

std::string nameOf(const Snapshot& snapshot, BodyId id) {
  return (*snapshot.bodies)[snapshot.find(id)].name;
}

BodyId idNamed(const Snapshot& snapshot, const std::string& name, const std::string& field) {
  return snapshot.states[indexNamed(snapshot, name, field)].id;
}

std::string castRay(const Snapshot& snapshot, const rigid_body_sim::CastRay::Request& request,
                    rigid_body_sim::CastRay::Response& response) {
  const Pose X_WF = frameNamed(snapshot, request.frame_id);
  Ray ray;
  ray.origin_W = X_WF.p_WB + X_WF.q_WB * finiteVector(fromMsg(request.origin), "origin");
  ray.direction_W = X_WF.q_WB * finiteVector(fromMsg(request.direction), "direction");
  if (!(request.max_distance >= 0.0))
    throw InvalidInput({{"max_distance", words(request.max_distance), "above 0 m, or 0: without end"}});
  if (request.max_distance > 0.0) ray.max_distance = request.max_distance;
  for (const std::string& name : request.ignore) ray.ignore.push_back(idNamed(snapshot, name, "ignore"));

  std::vector<RayHit> hits;
  if (request.all) {
    hits = castRayThrough(snapshot, ray);
  } else if (const std::optional<RayHit> hit = castRay(snapshot, ray)) {
    hits.push_back(*hit);
  }
  for (const RayHit& hit : hits) {
    rigid_body_sim::RayHit msg;
    msg.body = nameOf(snapshot, hit.body);
    msg.position = toPoint(hit.p_W);
    msg.normal = toMsg(hit.n_W);
    msg.distance = hit.distance;
    response.hits.push_back(msg);
  }
  if (hits.empty()) return "the ray hits nothing";
  const std::string count = request.all ? bodyCount(hits.size()) + ", first " : "";
  return words("the ray hits ", count, "'", response.hits[0].body, "' after ", hits[0].distance, " m at ",
               inWords(hits[0].p_W));
}

std::string closestPoints(const Snapshot& snapshot, const rigid_body_sim::ClosestPoints::Request& request,
                          rigid_body_sim::ClosestPoints::Response& response) {
  std::vector<Problem> problems;
  const auto named = [&](const std::string& name, const char* field) -> BodyId {
    try {
      return idNamed(snapshot, name, field);
    } catch (const InvalidInput& refusal) {
      problems.insert(problems.end(), refusal.problems().begin(), refusal.problems().end());
      return {};
    }
  };
  const BodyId a = named(request.body_a, "body_a"), b = named(request.body_b, "body_b");
  if (!problems.empty()) throw InvalidInput(problems);
  const ClosestPoints found = closestPoints(snapshot, a, b);
  response.distance = found.distance;
  response.point_a = toPoint(found.p_WA);
  response.point_b = toPoint(found.p_WB);
  response.normal = toMsg(found.n_W);
  const std::string relation = found.distance < 0.0 ? words("overlap by ", -found.distance, " m")
                                                    : words("are ", found.distance, " m apart");
  return words("'", request.body_a, "' and '", request.body_b, "' ", relation, ", between ",
               inWords(found.p_WA), " and ", inWords(found.p_WB));
}

std::string overlaps(const Snapshot& snapshot, const rigid_body_sim::Overlaps::Request& request,
                     rigid_body_sim::Overlaps::Response& response) {
  rigid_body_sim::BodySpec place;
  place.shape = request.shape;
  place.size = request.size;
  place.points = request.points;
  place.mesh = request.mesh;
  place.scale = request.scale;
  const Pose X_WF = frameNamed(snapshot, request.frame_id);
  finiteVector(fromMsg(request.pose.position), "position");
  finiteOrientation(fromMsg(request.pose.orientation), "orientation");
  const PlacedShape shape = shapeFrom(place, "place");
  const Pose X_WB = shape.poseOfB(compose(X_WF, fromMsg(request.pose)));
  for (const Neighbour& neighbour : overlaps(snapshot, shape.shape, X_WB, request.margin)) {
    response.bodies.push_back(nameOf(snapshot, neighbour.body));
    response.distances.push_back(neighbour.distance);
  }
  if (response.bodies.empty())
    return request.margin > 0.0 ? words("no body within ", request.margin, " m of the shape")
                                : "no body touches the shape";
  const std::string count = bodyCount(response.bodies.size());
  if (request.margin == 0.0)
    return words(count, " in contact with the shape, first '", response.bodies[0], "'");
  return words(count, " within ", request.margin, " m of the shape, first '", response.bodies[0], "'");
}

}  // namespace

void Services::offerQueries() {
  offerQuery<rigid_body_sim::CastRay>("cast_ray", castRay);
  offerQuery<rigid_body_sim::ClosestPoints>("closest_points", closestPoints);
  offerQuery<rigid_body_sim::Overlaps>("overlaps", overlaps);
}

}  // namespace rbs
