// SPDX-License-Identifier: BSD-3-Clause
#include "body_spec.h"

#include "convert.h"
#include "names.h"
#include "rigid_body_sim/mesh_file.h"
#include "words.h"

#include <functional>

namespace rbs {
namespace {

using Spec = rigid_body_sim::BodySpec;

/// Runs one part of the work and keeps what is wrong with it, so that all parts are heard.
template <class Part>
void collect(std::vector<Problem>& problems, Part part) {
  try {
    part();
  } catch (const InvalidInput& refusal) {
    problems.insert(problems.end(), refusal.problems().begin(), refusal.problems().end());
  }
}

void throwIfAny(const std::vector<Problem>& problems) {
  if (!problems.empty()) throw InvalidInput(problems);
}

std::optional<double> unlessZero(double value) {
  return value == 0.0 ? std::nullopt : std::optional<double>(value);
}

std::optional<Color> colorFrom(const std_msgs::ColorRGBA& msg) {
  if (isZero(msg)) return std::nullopt;
  Color color = fromMsg(msg);
  if (color[3] == 0.0f) color[3] = 1.0f;
  return color;
}

/// The hull that a request asks for. Throws InvalidInput.
PlacedHull hullFrom(const Spec& spec, const std::string& path) {
  if (!isZero(spec.size)) {
    throw InvalidInput({{path + ".size", inWords(fromMsg(spec.size)),
                         "nothing: a hull is as large as its points; scale changes that"}});
  }
  if (spec.points.empty() == spec.mesh.empty()) {
    throw InvalidInput({{path + ".shape", "'hull'", "with either points or mesh"}});
  }
  const double scale = spec.scale == 0.0 ? 1.0 : spec.scale;
  if (!(scale > 0.0)) throw InvalidInput({{path + ".scale", words(scale), "more than 0, or 0 for 1"}});
  if (!spec.mesh.empty()) return hullOfMesh(spec.mesh, "", scale, path + ".mesh");
  std::vector<Vec3> points;
  for (const geometry_msgs::Point& p : spec.points) points.push_back(scale * fromMsg(p));
  return makeHull(points, path + ".points");
}

/// Pose and twist, from the axes of frame_id to those of W.
void placeBody(const Spec& spec, const World& world, BodyDef& body) {
  const Pose X_WF = frameNamed(world, spec.frame_id);
  if (!isZero(spec.pose)) body.pose = compose(X_WF, fromMsg(spec.pose));
  const Twist twist_F = fromMsg(spec.twist);
  body.twist = {turned(X_WF.q_WB, twist_F.v_WB), turned(X_WF.q_WB, twist_F.w_WB)};
}

void setMaterial(const rigid_body_sim::Material& msg, const std::string& path, BodyDef& body,
                 std::vector<Problem>& problems) {
  Material& material = body.material;
  collect(problems, [&] {
    material.friction = oneOrNone(msg.friction, path + ".friction").value_or(material.friction);
  });
  collect(problems, [&] {
    material.restitution = oneOrNone(msg.restitution, path + ".restitution").value_or(material.restitution);
  });
  collect(problems,
          [&] { material.drag_coefficient = oneOrNone(msg.drag_coefficient, path + ".drag_coefficient"); });
  collect(problems, [&] {
    material.rolling_resistance =
        oneOrNone(msg.rolling_resistance, path + ".rolling_resistance").value_or(material.rolling_resistance);
  });
  collect(problems, [&] {
    material.torsional_resistance = oneOrNone(msg.torsional_resistance, path + ".torsional_resistance")
                                        .value_or(material.torsional_resistance);
  });
}

BodyDef bodyFrom(const Spec& spec, const World& world, const std::string& path, std::vector<Problem>& problems) {
  BodyDef body;
  body.name = spec.name;
  collect(problems, [&] { placeBody(spec, world, body); });
  collect(problems, [&] { body.shape = shapeFrom(spec, path, body.pose); });
  body.kind = spec.is_static ? BodyKind::Static : BodyKind::Dynamic;
  body.mass = unlessZero(spec.mass);
  body.density = unlessZero(spec.density);
  body.color = colorFrom(spec.color);
  setMaterial(spec.material, path + ".material", body, problems);
  const std::vector<Problem> faults = validate(body, path);
  problems.insert(problems.end(), faults.begin(), faults.end());
  return body;
}

/// Puts the bodies without a pose above the origin, each over the ones before it.
void findPlaces(const std::vector<Spec>& specs, const World& world, std::vector<BodyDef>& bodies) {
  double clearance = 0.5;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (!isZero(specs[i].pose) || std::holds_alternative<Plane>(bodies[i].shape)) continue;
    Pose& pose = bodies[i].pose;
    pose.p_WB = world.freePlace(bodies[i].shape, pose.q_WB, clearance);
    clearance = pose.p_WB.z() + 1.1 * boundingRadius(bodies[i].shape);
  }
}

std::vector<BodyDef> bodiesFrom(const std::vector<Spec>& specs, const World& world,
                                const std::function<std::string(std::size_t)>& path) {
  std::vector<BodyDef> bodies;
  std::vector<Problem> problems;
  for (std::size_t i = 0; i < specs.size(); ++i) bodies.push_back(bodyFrom(specs[i], world, path(i), problems));
  throwIfAny(problems);
  findPlaces(specs, world, bodies);
  return bodies;
}

Spec specFrom(const rigid_body_sim::SpawnBody::Request& request) {
  Spec spec;
  spec.name = request.name;
  spec.shape = request.shape;
  spec.size = request.size;
  spec.points = request.points;
  spec.mesh = request.mesh;
  spec.scale = request.scale;
  spec.pose = request.pose;
  spec.frame_id = request.frame_id;
  spec.twist = request.twist;
  spec.density = request.density;
  spec.mass = request.mass;
  spec.is_static = request.is_static;
  spec.material = request.material;
  spec.color = request.color;
  return spec;
}

}  // namespace

Shape shapeFrom(const Spec& spec, const std::string& path, Pose& pose) {
  if (spec.shape == "hull") {
    const PlacedHull hull = hullFrom(spec, path);
    pose = hull.poseOfB(pose);
    return hull.hull;
  }
  if (!spec.points.empty() || !spec.mesh.empty() || spec.scale != 0.0) {
    throw InvalidInput({{path, "points, mesh or scale", "these only with shape hull"}});
  }
  return makeShape(spec.shape.empty() ? "box" : spec.shape, fromMsg(spec.size), path);
}

std::vector<BodyDef> bodiesFrom(const std::vector<Spec>& specs, const World& world) {
  return bodiesFrom(specs, world, [](std::size_t i) { return "bodies[" + std::to_string(i) + "]"; });
}

BodyDef bodyFrom(const rigid_body_sim::SpawnBody::Request& request, const World& world) {
  return bodiesFrom({specFrom(request)}, world, [](std::size_t) { return "body"; }).front();
}

BodyEdit editFrom(const rigid_body_sim::SetBody::Request& request) {
  BodyEdit edit;
  std::vector<Problem> problems;
  edit.mass = unlessZero(request.mass);
  edit.density = unlessZero(request.density);
  edit.color = colorFrom(request.color);
  collect(problems, [&] {
    if (const auto twist = oneOrNone(request.twist, "twist")) edit.twist = fromMsg(*twist);
  });
  collect(problems, [&] {
    if (const auto is_static = oneOrNone(request.is_static, "is_static")) {
      edit.kind = *is_static ? BodyKind::Static : BodyKind::Dynamic;
    }
  });
  const rigid_body_sim::Material& material = request.material;
  collect(problems, [&] { edit.friction = oneOrNone(material.friction, "material.friction"); });
  collect(problems, [&] { edit.restitution = oneOrNone(material.restitution, "material.restitution"); });
  collect(problems,
          [&] { edit.drag_coefficient = oneOrNone(material.drag_coefficient, "material.drag_coefficient"); });
  collect(problems, [&] {
    edit.rolling_resistance = oneOrNone(material.rolling_resistance, "material.rolling_resistance");
  });
  collect(problems, [&] {
    edit.torsional_resistance = oneOrNone(material.torsional_resistance, "material.torsional_resistance");
  });
  throwIfAny(problems);
  return edit;
}

}  // namespace rbs
