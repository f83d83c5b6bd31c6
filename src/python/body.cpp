// SPDX-License-Identifier: BSD-3-Clause
#include "body.h"

#include "shapes.h"
#include "values.h"

#include <pybind11/stl.h>

#include <array>
#include <memory>
#include <utility>

namespace rbs::python {
namespace {

using Class = py::class_<BodyDef, std::shared_ptr<BodyDef>>;

/// All fields of a body, for pickling.
constexpr std::array kFields{"name",
                             "shape",
                             "position",
                             "orientation",
                             "velocity",
                             "spin",
                             "kind",
                             "mass",
                             "density",
                             "friction",
                             "restitution",
                             "rolling_resistance",
                             "torsional_resistance",
                             "drag_coefficient",
                             "color",
                             "group",
                             "mask"};

void bindPlace(Class& type) {
  type.def_property(
          "position", [](const py::object& self) { return viewOf(self.cast<BodyDef&>().pose.p_WB, self); },
          [](BodyDef& body, py::handle value) { body.pose.p_WB = toVec3(value, "position"); },
          "(3,) of the centre of mass, in W, m, at most 1e9 from the origin. A view, which can be written.")
      .def_property(
          "orientation", [](const py::object& self) { return viewOf(self.cast<BodyDef&>().pose.q_WB, self); },
          [](BodyDef& body, py::handle value) { body.pose.q_WB = toQuat(value, "orientation"); },
          "(4,) quaternion [x, y, z, w] that rotates vectors from B to W; it is normalised on use. A view, "
          "which can be written.")
      .def_property(
          "velocity", [](const py::object& self) { return viewOf(self.cast<BodyDef&>().twist.v_WB, self); },
          [](BodyDef& body, py::handle value) { body.twist.v_WB = toVec3(value, "velocity"); },
          "(3,) linear velocity at the centre of mass, in W, m/s, at most 1e6. A view, which can be written.")
      .def_property(
          "spin", [](const py::object& self) { return viewOf(self.cast<BodyDef&>().twist.w_WB, self); },
          [](BodyDef& body, py::handle value) { body.twist.w_WB = toVec3(value, "spin"); },
          "(3,) angular velocity, in W, rad/s, at most 1e6. A view, which can be written.")
      .def_property(
          "kind", [](const BodyDef& body) { return kindName(body.kind); },
          [](BodyDef& body, py::handle value) { body.kind = toKind(value, "kind"); },
          "'dynamic' (moved by forces), 'static', or 'kinematic' (keeps its velocity, whatever it meets).");
}

void bindMass(Class& type) {
  type.def_property(
          "mass", [](const BodyDef& body) { return body.mass; },
          [](BodyDef& body, py::handle value) { body.mass = toOptional(value, "mass", toNumber); },
          "kg, 1e-18 to 1e18; None: by the density. At most one of mass and density.")
      .def_property(
          "density", [](const BodyDef& body) { return body.density; },
          [](BodyDef& body, py::handle value) { body.density = toOptional(value, "density", toNumber); },
          "kg/m³, 1e-6 to 1e9; None: 1000, unless there is a mass.");
}

/// A number of the material.
void bindNumber(Class& type, const char* name, double Material::*field, const char* doc) {
  type.def_property(
      name, [field](const BodyDef& body) { return body.material.*field; },
      [field, name](BodyDef& body, py::handle value) { body.material.*field = toNumber(value, name); }, doc);
}

void bindMaterial(Class& type) {
  bindNumber(type, "friction", &Material::friction,
             "Coulomb's coefficient, 0 to 1e9. A pair uses the geometric mean of its two, 1e4 at most.");
  bindNumber(type, "restitution", &Material::restitution,
             "Newton's coefficient, 0 (no rebound) to 1 (elastic). A pair uses the larger of its two.");
  bindNumber(type, "rolling_resistance", &Material::rolling_resistance,
             "Lever arm of the rolling torque over the radius of a round body, 0 to 1e6.");
  bindNumber(type, "torsional_resistance", &Material::torsional_resistance,
             "Lever arm of the torsional torque over the radius of a round body, 0 to 1e6.");
  type.def_property(
      "drag_coefficient", [](const BodyDef& body) { return body.material.drag_coefficient; },
      [](BodyDef& body, py::handle value) {
        body.material.drag_coefficient = toOptional(value, "drag_coefficient", toNumber);
      },
      "0 to 1e6; None: 0.47 for a sphere and a capsule, 1.05 for other shapes.");
}

void bindRest(Class& type) {
  type.def_property(
          "name", [](const BodyDef& body) { return body.name; },
          [](BodyDef& body, py::handle value) { body.name = toText(value, "name"); },
          "Letters, digits, '_', '-' and '/', at most 64; unique in a world. '': the world names it after "
          "its shape.")
      .def_property(
          "shape", [](const BodyDef& body) { return fromShape(body.shape); },
          [](BodyDef& body, py::handle value) { body.shape = toShape(value, "shape"); },
          "A Sphere, Box, Plane, Capsule, Cylinder, Cone or ConvexHull, in B.")
      .def_property(
          "color", [](const BodyDef& body) { return body.color; },
          [](BodyDef& body, py::handle value) { body.color = toOptional(value, "color", toColor); },
          "Red, green, blue and alpha, each 0 to 1; None: chosen.")
      .def_property(
          "group", [](const BodyDef& body) { return body.group; },
          [](BodyDef& body, py::handle value) { body.group = toBits(value, "group"); },
          "Collision groups that the body is in, one a bit (32 bits).")
      .def_property(
          "mask", [](const BodyDef& body) { return body.mask; },
          [](BodyDef& body, py::handle value) { body.mask = toBits(value, "mask"); },
          "Groups that the body may collide with, one a bit. Two bodies collide where each one's group "
          "shares a bit\nwith the other's mask.");
}

std::shared_ptr<BodyDef> makeBody(py::handle shape, const py::kwargs& fields) {
  auto body = std::make_shared<BodyDef>();
  if (!shape.is_none()) body->shape = toShape(shape, "shape");
  const py::object self = py::cast(body);
  for (const auto& [name, value] : fields) setField(self, name, value);
  return body;
}

std::string describe(const BodyDef& body) {
  return "Body(" + (body.name.empty() ? "" : "'" + body.name + "', ") + kindName(body.kind) + " " +
         shapeName(body.shape) + ")";
}

}  // namespace

BodyKind toKind(py::handle value, const std::string& path) {
  for (const BodyKind kind : {BodyKind::Dynamic, BodyKind::Static, BodyKind::Kinematic})
    if (py::isinstance<py::str>(value) && toText(value, path) == kindName(kind)) return kind;
  refuse(path, textOf(value), "dynamic, static or kinematic");
}

std::uint32_t toBits(py::handle value, const std::string& path) {
  return static_cast<std::uint32_t>(toWhole(value, path, 0, 0xffffffffu));
}

std::vector<BodyDef> toBodies(py::handle bodies, const std::string& path) {
  if (!py::isinstance<py::iterable>(bodies)) refuse(path, textOf(bodies), "a list of Body");
  std::vector<BodyDef> result;
  for (const py::handle body : bodies) {
    if (!py::isinstance<BodyDef>(body))
      refuse(path + "[" + std::to_string(result.size()) + "]", textOf(body), "a Body");
    result.push_back(body.cast<const BodyDef&>());
  }
  return result;
}

py::list fromBodies(std::vector<BodyDef> bodies) {
  py::list result;
  for (BodyDef& body : bodies) result.append(std::make_shared<BodyDef>(std::move(body)));
  return result;
}

void bindBody(py::module_& module) {
  Class type(module, "Body",
             "The definition of a body. Its fields have the names of the keys of scene files "
             "(docs/scenes.md).\n\nNumbers are checked where the body is used: by World(), add_body() and "
             "Scene.validate().");
  type.def(py::init(&makeBody), py::arg("shape") = py::none(),
           Doc("Body(shape=Box(), **fields): the fields by their names."));
  bindRest(type);
  bindPlace(type);
  bindMass(type);
  bindMaterial(type);
  const auto copy = [](const BodyDef& body) { return std::make_shared<BodyDef>(body); };
  type.def("copy", copy, Doc("Another Body with the same fields."))
      .def("__copy__", copy)
      .def(
          "__deepcopy__", [copy](const BodyDef& body, py::handle) { return copy(body); }, py::arg("memo"))
      .def(py::pickle(
          [](const py::object& self) {
            py::dict fields;
            for (const char* const name : kFields) fields[name] = self.attr(name);
            return fields;
          },
          [](const py::dict& fields) {
            const auto body = std::make_shared<BodyDef>();
            const py::object self = py::cast(body);
            for (const auto& [name, value] : fields) py::setattr(self, name, value);
            return body;
          }))
      .def("__repr__", &describe);
}

}  // namespace rbs::python
