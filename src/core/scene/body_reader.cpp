// SPDX-License-Identifier: BSD-3-Clause
#include "scene/body_reader.h"

#include "base/number_text.h"
#include "rigid_body_sim/mesh_file.h"
#include "rigid_body_sim/quote.h"
#include "scene/scene_generators.h"
#include "scene/scene_limits.h"

#include <cmath>
#include <iterator>

namespace rbs {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// Reads three extents, or one number for all of them.
void readSize(Fields& fields, FileProblems& problems, Vec3& size) {
  const YamlNode* node = fields.find("size");
  double edge = 0.0;
  if (node && node->kind == YamlNode::Kind::Sequence) {
    readValue(*node, fields.pathOf("size"), problems, size);
  } else if (fields.read("size", edge)) {
    size.setConstant(edge);
  }
}

/// The extents of a capsule, cylinder or cone, which are round about z.
Vec3 readRoundSize(Fields& fields, FileProblems& problems, const Shape& usual) {
  Vec3 size = fullExtents(usual);
  readSize(fields, problems, size);
  if (size.x() != size.y()) fields.report("size", vectorText(size), "[d, d, length]: round about z");
  return size;
}

/// `half_length` beside a `size` that is the diameter says it to the last bit.
Capsule readCapsule(Fields& fields, FileProblems& problems) {
  const Vec3 size = readRoundSize(fields, problems, Capsule{});
  Capsule capsule{0.5 * size.x(), 0.5 * size.z() - 0.5 * size.x()};
  const YamlNode* given = fields.find("size");
  if (fields.read("half_length", capsule.half_length)) {
    if (given && given->kind == YamlNode::Kind::Sequence) {
      fields.report("half_length", numberText(capsule.half_length), "only beside a size that is one number");
    }
    if (capsule.half_length < 0.0)
      fields.report("half_length", numberText(capsule.half_length), "0 m or more");
  } else if (capsule.half_length < 0.0) {
    fields.report("size", vectorText(size), "a whole length of at least the diameter: the ends are round");
  }
  return capsule;
}

/// All but a hull. `size` is the diameter of a sphere, the edge of a cube, or the three full extents.
Shape readSizedShape(Fields& fields, FileProblems& problems, const std::string& name) {
  if (name == "sphere") {
    double diameter = fullExtents(Sphere{}).x();
    fields.read("size", diameter);
    return Sphere{0.5 * diameter};
  }
  if (name == "box") {
    Box box;
    readSize(fields, problems, box.size);
    return box;
  }
  if (name == "capsule") return readCapsule(fields, problems);
  if (name == "cylinder") {
    const Vec3 size = readRoundSize(fields, problems, Cylinder{});
    return Cylinder{0.5 * size.x(), 0.5 * size.z()};
  }
  if (name == "cone") {
    const Vec3 size = readRoundSize(fields, problems, Cone{});
    return Cone{0.5 * size.x(), size.z()};
  }
  if (const YamlNode* size = fields.find("size")) {
    fields.report("size", describe(*size), "nothing: a plane has no size");
  }
  return Plane{};
}

/// The turn by an angle t about a unit axis a is the quaternion (a sin(t/2), cos(t/2)).
void readAttitude(Fields& fields, FileProblems& problems, Quat& q_WB) {
  fields.read("orientation", q_WB);
  readGroup(fields, "rotation", problems, [&](Fields& rotation) {
    if (fields.find("orientation")) fields.report("rotation", "", "at most one of orientation and rotation");
    Vec3 axis = Vec3::UnitZ();
    double degrees = 0.0;
    rotation.require("axis", "the axis of the turn, [x, y, z]", axis);
    rotation.require("degrees", "the angle of the turn", degrees);
    const double length = axis.norm();
    if (!(length > 0.0 && std::isfinite(length))) {
      rotation.report("axis", vectorText(axis), "a vector with a direction");
      return;
    }
    const double half = 0.5 * degrees * kPi / 180.0;
    const Vec3 sine = axis / length * std::sin(half);
    q_WB = Quat(std::cos(half), sine.x(), sine.y(), sine.z());
  });
}

/// All but the shape.
void readBody(Fields& fields, FileProblems& problems, BodyDef& body) {
  fields.read("name", body.name);
  if (fields.find("kind")) {
    // An unknown kind is read as kinematic, which contradicts nothing that is said elsewhere.
    const std::array kinds{BodyKind::Dynamic, BodyKind::Static, BodyKind::Kinematic};
    body.kind = kinds[fields.choose("kind", {"dynamic", "static", "kinematic"}).value_or(2)];
  }
  fields.read("position", body.pose.p_WB);
  readAttitude(fields, problems, body.pose.q_WB);
  fields.read("velocity", body.twist.v_WB);
  fields.read("spin", body.twist.w_WB);
  fields.read("mass", body.mass);
  fields.read("density", body.density);
  fields.read("friction", body.material.friction);
  fields.read("restitution", body.material.restitution);
  fields.read("drag_coefficient", body.material.drag_coefficient);
  fields.read("rolling_resistance", body.material.rolling_resistance);
  fields.read("torsional_resistance", body.material.torsional_resistance);
  fields.read("color", body.color);
  fields.read("group", body.group);
  fields.read("mask", body.mask);
}

void readRepeat(Fields& fields, Repeat& repeat) {
  fields.require("count", "how many along x, y and z, [nx, ny, nz]", repeat.count);
  fields.require("spacing", "the distances between them, [dx, dy, dz]", repeat.spacing);
  for (const std::uint32_t n : repeat.count) {
    if (n == 0) fields.report("count", "0", "at least 1 along each axis");
  }
  if (fields.read("jitter", repeat.jitter) && repeat.jitter < 0.0) {
    fields.report("jitter", numberText(repeat.jitter), "0 m or more");
  }
  repeat.turn = fields.choose("turn", {"random"}).has_value();
  if (fields.read("scale", repeat.scale) && !(0.0 < repeat.scale[0] && repeat.scale[0] <= repeat.scale[1])) {
    fields.report("scale", "", "[low, high] with 0 < low <= high");
  }
  if (fields.read("speed", repeat.speed) && repeat.speed < 0.0) {
    fields.report("speed", numberText(repeat.speed), "0 m/s or more");
  }
  fields.read("shapes", repeat.shapes);
  for (const std::string& shape : repeat.shapes) {
    if (shape != "sphere" && shape != "box") fields.report("shapes", quoted(shape), "sphere and box");
  }
}

void readPyramid(Fields& fields, const Shape& shape, Pyramid& pyramid) {
  if (!std::holds_alternative<Box>(shape)) fields.report("", shapeName(shape), "a pyramid is built of boxes");
  fields.require("rows", "the number of rows", pyramid.rows);
  if (pyramid.rows == 0) fields.report("rows", "0", "at least 1");
  if (fields.read("gap", pyramid.gap) && pyramid.gap < 0.0) {
    fields.report("gap", numberText(pyramid.gap), "0 m or more");
  }
}

void readRing(Fields& fields, Ring& ring) {
  fields.require("count", "how many on the circle", ring.count);
  fields.require("radius", "the radius of the circle", ring.radius);
  fields.read("degrees", ring.degrees);
  if (ring.count == 0) fields.report("count", "0", "at least 1");
  if (!(ring.radius > 0.0)) fields.report("radius", numberText(ring.radius), "more than 0 m");
}

void readCardHouse(Fields& fields, const Shape& shape, CardHouse& house) {
  if (!std::holds_alternative<Box>(shape)) {
    fields.report("", shapeName(shape), "a house of cards is built of boxes");
  }
  fields.require("floors", "the number of floors", house.floors);
  if (house.floors == 0) fields.report("floors", "0", "at least 1");
  if (fields.read("degrees", house.degrees) && !(0.0 < house.degrees && house.degrees < 45.0)) {
    fields.report("degrees", numberText(house.degrees), "more than 0 and less than 45");
  }
}

}  // namespace

void BodyReader::read(const YamlNode& list) {
  if (list.kind != YamlNode::Kind::Sequence) {
    problems_.add(list.line, "bodies", describe(list), "a list of bodies");
    return;
  }
  for (std::size_t i = 0; i < list.items.size(); ++i) readEntry(list.items[i], i);
}

void BodyReader::readShape(Fields& fields, BodyDef& body) {
  static const std::vector<std::string> shapes{"box",      "sphere", "plane", "capsule",
                                               "cylinder", "cone",   "hull"};
  const std::string& shape = shapes[fields.choose("shape", shapes).value_or(0)];
  if (shape == "hull") {
    readHull(fields, body);
  } else {
    body.shape = readSizedShape(fields, problems_, shape);
  }
}

void BodyReader::readHull(Fields& fields, BodyDef& body) {
  if (const YamlNode* size = fields.find("size")) {
    fields.report("size", describe(*size), "nothing: a hull is as large as its points; `scale` changes that");
  }
  double scale = 1.0;
  if (fields.read("scale", scale) && !(scale > 0.0)) fields.report("scale", numberText(scale), "more than 0");
  std::vector<Vec3> points;
  std::string mesh;
  const bool has_points = fields.read("points", points), has_mesh = fields.read("mesh", mesh);
  if (bool(fields.find("points")) == bool(fields.find("mesh"))) {
    fields.report("shape", "'hull'", "with either `points` or `mesh`");
  }
  if (has_points == has_mesh || !(scale > 0.0)) return;
  try {
    for (Vec3& p : points) p *= scale;
    const PlacedHull hull =
        has_mesh ? meshHull(mesh, scale, fields.pathOf("mesh")) : makeHull(points, fields.pathOf("points"));
    body.shape = hull.hull;
    body.pose = hull.poseOfB(body.pose);
  } catch (const InvalidInput& refusal) {
    for (const Problem& problem : refusal.problems()) fields.report(problem);
  }
}

// Bodies of one mesh share one hull.
PlacedHull BodyReader::meshHull(const std::string& mesh, double scale, const std::string& path) {
  const auto known = meshes_.find({mesh, scale});
  if (known != meshes_.end()) return known->second;
  auto points = mesh_points_.find(mesh);
  if (points == mesh_points_.end()) points = mesh_points_.emplace(mesh, readMesh(mesh, folder_, path)).first;
  hull_points_ += points->second.size();
  if (hull_points_ > kMostMeshPoints) {
    throw InvalidInput({{path, "more than " + std::to_string(kMostMeshPoints) + " points",
                         "at most so many in the meshes of a scene, each counted once for every scale"}});
  }
  const PlacedHull hull = hullOfMesh(points->second, mesh, scale, path);
  meshes_.emplace(std::pair{mesh, scale}, hull);
  return hull;
}

// An entry of faulty form makes no bodies, since they would not be those that were meant. What it says
// in good form is checked all the same, so that all its faults are reported at once.
void BodyReader::readEntry(const YamlNode& node, std::size_t index) {
  const std::size_t faults = problems_.count();
  const std::string path = "bodies[" + std::to_string(index) + "]";
  const SplitMix64 random = random_.split();
  Fields fields(node, path, problems_);
  BodyDef body;
  std::optional<Repeat> repeat;
  std::optional<Pyramid> pyramid;
  std::optional<Ring> ring;
  std::optional<CardHouse> house;
  readBody(fields, problems_, body);
  readShape(fields, body);
  readGroup(fields, "repeat", problems_, [&](Fields& f) { readRepeat(f, repeat.emplace()); });
  readGroup(fields, "pyramid", problems_, [&](Fields& f) { readPyramid(f, body.shape, pyramid.emplace()); });
  readGroup(fields, "ring", problems_, [&](Fields& f) { readRing(f, ring.emplace()); });
  readGroup(fields, "card_house", problems_,
            [&](Fields& f) { readCardHouse(f, body.shape, house.emplace()); });
  if (repeat.has_value() + pyramid.has_value() + ring.has_value() + house.has_value() > 1) {
    fields.report("", "", "at most one of repeat, pyramid, ring and card_house");
  }
  fields.refuseOthers();

  const double count = repeat    ? bodyCount(*repeat)
                       : pyramid ? bodyCount(*pyramid)
                       : ring    ? bodyCount(*ring)
                       : house   ? bodyCount(*house)
                                 : 1.0;
  if (static_cast<double>(bodies_.size()) + count > static_cast<double>(kMostBodies)) {
    fields.report("", numberText(count) + " bodies",
                  "at most " + std::to_string(kMostBodies) + " in a scene");
  }
  if (problems_.count() == faults) {
    try {
      add(repeat    ? expand(body, *repeat, random)
          : pyramid ? expand(body, *pyramid)
          : ring    ? expand(body, *ring)
          : house   ? expand(body, *house)
                    : std::vector{body},
          index);
    } catch (const InvalidInput& refusal) {  // of a hull that `repeat` scales
      fields.report("repeat", refusal.problems().front().value, refusal.problems().front().allowed);
    }
    return;
  }
  for (const Problem& problem : validate(body, path)) fields.report(problem);
}

void BodyReader::add(std::vector<BodyDef> bodies, std::size_t entry) {
  entries_.insert(entries_.end(), bodies.size(), entry);
  bodies_.insert(bodies_.end(), std::make_move_iterator(bodies.begin()),
                 std::make_move_iterator(bodies.end()));
}

}  // namespace rbs
