// SPDX-License-Identifier: BSD-3-Clause
#include "body_spec.h"

#include "convert.h"
#include "names.h"
#include "rigid_body_sim/mesh_file.h"
#include "rigid_body_sim/quote.h"
#include "words.h"

#include <utility>

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

/// The hull that a request defines. Throws InvalidInput.
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

Vec3 finiteIn(const geometry_msgs::Vector3& v, const std::string& path) {
  return finiteVector(fromMsg(v), path);
}

/// The frame of a body. A refusal names its place in a request for several bodies.
Pose frameOf(const Spec& spec, const World& world, const std::string& path) {
  try {
    return frameNamed(world, spec.frame_id);
  } catch (const InvalidInput& refusal) {
    std::vector<Problem> problems = refusal.problems();
    if (path != "body")
      for (Problem& problem : problems) problem.path = path + "." + problem.path;
    throw InvalidInput(problems);
  }
}

/// Pose and twist, from the axes of frame_id to those of W.
void placeBody(const Spec& spec, const World& world, const std::string& path, BodyDef& body) {
  const Pose X_WF = frameOf(spec, world, path);
  if (!isZero(spec.pose)) {
    finiteVector(fromMsg(spec.pose.position), path + ".position");
    finiteOrientation(fromMsg(spec.pose.orientation), path + ".orientation");
    body.pose = compose(X_WF, fromMsg(spec.pose));
  }
  body.twist = {X_WF.q_WB * finiteIn(spec.twist.linear, path + ".velocity"),
                X_WF.q_WB * finiteIn(spec.twist.angular, path + ".spin")};
}

/// The kind of this name; empty where nothing is said.
std::optional<BodyKind> kindFrom(const std::string& kind, const std::string& path) {
  if (kind.empty()) return std::nullopt;
  for (const BodyKind known : {BodyKind::Dynamic, BodyKind::Static, BodyKind::Kinematic})
    if (kind == kindName(known)) return known;
  throw InvalidInput({{path, quoted(kind), "dynamic, static or kinematic"}});
}

void setKind(const Spec& spec, const std::string& path, BodyDef& body, std::vector<Problem>& problems) {
  collect(problems, [&] {
    const std::optional<BodyKind> kind = kindFrom(spec.kind, path + ".kind");
    if (spec.is_static && kind && *kind != BodyKind::Static) {
      throw InvalidInput({{path + ".is_static", "true", "only with kind static"}});
    }
    body.kind = kind.value_or(spec.is_static ? BodyKind::Static : BodyKind::Dynamic);
  });
  collect(problems, [&] {
    body.group = oneOrNone(spec.collision_group, path + ".collision_group").value_or(body.group);
  });
  collect(problems,
          [&] { body.mask = oneOrNone(spec.collision_mask, path + ".collision_mask").value_or(body.mask); });
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

BodyDef bodyFrom(const Spec& spec, const PlacedShape& shape, const World& world, const std::string& path,
                 std::vector<Problem>& problems) {
  BodyDef body;
  body.name = spec.name;
  collect(problems, [&] { placeBody(spec, world, path, body); });
  body.shape = shape.shape;
  body.pose = shape.poseOfB(body.pose);
  setKind(spec, path, body, problems);
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

/// What SetBody and BodyChange have in common.
template <class Fields>
BodyEdit commonEdit(const Fields& fields, const std::string& path, std::vector<Problem>& problems) {
  BodyEdit edit;
  edit.mass = unlessZero(fields.mass);
  edit.density = unlessZero(fields.density);
  edit.color = colorFrom(fields.color);
  collect(problems, [&] {
    if (const auto twist = oneOrNone(fields.twist, path + "twist")) edit.twist = fromMsg(*twist);
  });
  collect(problems, [&] { edit.kind = kindFrom(fields.kind, path + "kind"); });
  collect(problems, [&] { edit.group = oneOrNone(fields.collision_group, path + "collision_group"); });
  collect(problems, [&] { edit.mask = oneOrNone(fields.collision_mask, path + "collision_mask"); });
  const auto number = [&](const std::vector<double>& list, const char* name) {
    std::optional<double> value;
    collect(problems, [&] { value = oneOrNone(list, path + "material." + name); });
    return value;
  };
  const rigid_body_sim::Material& material = fields.material;
  edit.friction = number(material.friction, "friction");
  edit.restitution = number(material.restitution, "restitution");
  edit.drag_coefficient = number(material.drag_coefficient, "drag_coefficient");
  edit.rolling_resistance = number(material.rolling_resistance, "rolling_resistance");
  edit.torsional_resistance = number(material.torsional_resistance, "torsional_resistance");
  return edit;
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
  spec.kind = request.kind;
  spec.collision_group = request.collision_group;
  spec.collision_mask = request.collision_mask;
  spec.material = request.material;
  spec.color = request.color;
  return spec;
}

}  // namespace

PlacedShape shapeFrom(const Spec& spec, const std::string& path) {
  if (spec.shape == "hull") {
    const PlacedHull hull = hullFrom(spec, path);
    return {hull.hull, hull};
  }
  if (!spec.points.empty() || !spec.mesh.empty() || spec.scale != 0.0) {
    throw InvalidInput({{path, "points, mesh or scale", "these only with shape hull"}});
  }
  return {makeShape(spec.shape.empty() ? "box" : spec.shape, fromMsg(spec.size), path), std::nullopt};
}

SpawnPlan::SpawnPlan(std::vector<Spec> specs) : specs_(std::move(specs)) {
  for (std::size_t i = 0; i < specs_.size(); ++i) {
    paths_.push_back("bodies[" + std::to_string(i) + "]");
    shapes_.emplace_back();
    collect(problems_, [&] { shapes_[i] = shapeFrom(specs_[i], paths_[i]); });
  }
}

SpawnPlan::SpawnPlan(const rigid_body_sim::SpawnBody::Request& request)
    : specs_{specFrom(request)}, paths_{"body"} {
  shapes_.emplace_back();
  collect(problems_, [&] { shapes_[0] = shapeFrom(specs_[0], paths_[0]); });
}

std::vector<BodyDef> SpawnPlan::bodiesIn(const World& world) const {
  std::vector<BodyDef> bodies;
  std::vector<Problem> problems = problems_;
  for (std::size_t i = 0; i < specs_.size(); ++i) {
    bodies.push_back(bodyFrom(specs_[i], shapes_[i], world, paths_[i], problems));
  }
  throwIfAny(problems);
  findPlaces(specs_, world, bodies);
  return bodies;
}

BodyEdit editFrom(const rigid_body_sim::SetBody::Request& request) {
  std::vector<Problem> problems;
  BodyEdit edit = commonEdit(request, "", problems);
  collect(problems, [&] {
    const auto is_static = oneOrNone(request.is_static, "is_static");
    if (is_static && edit.kind) throw InvalidInput({{"is_static", "given", "not together with kind"}});
    if (is_static) edit.kind = *is_static ? BodyKind::Static : BodyKind::Dynamic;
  });
  throwIfAny(problems);
  return edit;
}

BodyEdit editFrom(const rigid_body_sim::BodyChange& change, const Shape& shape, const std::string& path) {
  std::vector<Problem> problems;
  BodyEdit edit = commonEdit(change, path + ".", problems);
  if (!change.new_name.empty()) edit.name = change.new_name;
  collect(problems, [&] {
    if (const auto pose = oneOrNone(change.pose, path + ".pose")) edit.pose = fromMsg(*pose);
  });
  collect(problems, [&] {
    if (const auto size = oneOrNone(change.size, path + ".size"))
      edit.shape = resized(shape, fromMsg(*size), path);
  });
  throwIfAny(problems);
  return edit;
}

bool isEmpty(const BodyEdit& edit) {
  return !edit.name && !edit.shape && !edit.pose && !edit.twist && !edit.kind && !edit.mass &&
         !edit.density && !edit.friction && !edit.restitution && !edit.drag_coefficient &&
         !edit.rolling_resistance && !edit.torsional_resistance && !edit.color && !edit.group && !edit.mask;
}

}  // namespace rbs
