#include "body_reader.h"

#include "number_text.h"
#include "scene_generators.h"
#include "scene_limits.h"

#include <cmath>
#include <iterator>

namespace rbs {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// `size` is the diameter of a sphere, the edge of a cube, or the three edges of a box.
void readShape(Fields& fields, FileProblems& problems, Shape& shape) {
  const std::size_t choice = fields.choose("shape", {"box", "sphere", "plane"}).value_or(0);
  if (choice == 1) {
    double diameter = fullExtents(Sphere{}).x();
    fields.read("size", diameter);
    shape = Sphere{0.5 * diameter};
  } else if (choice == 0) {
    Box box;
    const YamlNode* size = fields.find("size");
    double edge = 0.0;
    if (size && size->kind == YamlNode::Kind::Sequence) {
      readValue(*size, fields.pathOf("size"), problems, box.size);
    } else if (fields.read("size", edge)) {
      box.size.setConstant(edge);
    }
    shape = box;
  } else {
    shape = Plane{};
    if (const YamlNode* size = fields.find("size")) {
      fields.report("size", describe(*size), "nothing: a plane has no size");
    }
  }
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

void readBody(Fields& fields, FileProblems& problems, BodyDef& body) {
  fields.read("name", body.name);
  readShape(fields, problems, body.shape);
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
  fields.read("shapes", repeat.shapes);
  for (const std::string& shape : repeat.shapes) {
    if (shape != "sphere" && shape != "box") fields.report("shapes", "'" + shape + "'", "sphere and box");
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

}  // namespace

void BodyReader::read(const YamlNode& list) {
  if (list.kind != YamlNode::Kind::Sequence) {
    problems_.add(list.line, "bodies", describe(list), "a list of bodies");
    return;
  }
  for (std::size_t i = 0; i < list.items.size(); ++i) readEntry(list.items[i], i);
}

// An entry of faulty form makes no bodies, since they would not be those that were meant. What it says
// in good form is checked all the same, so that all its faults are told at once.
void BodyReader::readEntry(const YamlNode& node, std::size_t index) {
  const std::size_t faults = problems_.count();
  const std::string path = "bodies[" + std::to_string(index) + "]";
  const SplitMix64 random = random_.split();
  Fields fields(node, path, problems_);
  BodyDef body;
  std::optional<Repeat> repeat;
  std::optional<Pyramid> pyramid;
  readBody(fields, problems_, body);
  readGroup(fields, "repeat", problems_, [&](Fields& f) { readRepeat(f, repeat.emplace()); });
  readGroup(fields, "pyramid", problems_, [&](Fields& f) { readPyramid(f, body.shape, pyramid.emplace()); });
  if (repeat && pyramid) fields.report("pyramid", "", "at most one of repeat and pyramid");
  fields.refuseOthers();

  const double count = repeat ? bodyCount(*repeat) : pyramid ? bodyCount(*pyramid) : 1.0;
  if (static_cast<double>(bodies_.size()) + count > static_cast<double>(kMostBodies)) {
    fields.report("", numberText(count) + " bodies",
                  "at most " + std::to_string(kMostBodies) + " in a scene");
  }
  if (problems_.count() == faults) {
    add(repeat ? expand(body, *repeat, random) : pyramid ? expand(body, *pyramid) : std::vector{body}, index);
    return;
  }
  for (const Problem& problem : validate(body, path)) {
    problems_.add(lineOf(node, problem.path.substr(path.size())), problem.path, problem.value,
                  problem.allowed);
  }
}

void BodyReader::add(std::vector<BodyDef> bodies, std::size_t entry) {
  entries_.insert(entries_.end(), bodies.size(), entry);
  bodies_.insert(bodies_.end(), std::make_move_iterator(bodies.begin()),
                 std::make_move_iterator(bodies.end()));
}

}  // namespace rbs
