// SPDX-License-Identifier: BSD-3-Clause
#include "shapes.h"

#include "values.h"

#include "rigid_body_sim/mesh_file.h"

#include <filesystem>
#include <utility>

namespace rbs::python {
namespace {

bool isOf(py::handle value, const char* type) {
  return py::isinstance(value, typeNamed(type));
}

double field(py::handle value, const char* name, const std::string& path) {
  return toNumber(value.attr(name), path + "." + name);
}

std::vector<Vec3> toPoints(py::handle value, const std::string& path) {
  const auto numbers = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(value);
  if (!numbers) refuse(path, textOf(value), "points: an array of shape (n, 3)");
  if (numbers.ndim() != 2 || numbers.shape(1) != 3)
    refuse(path, "shape " + py::repr(numbers.attr("shape")).cast<std::string>(),
           "points: an array of shape (n, 3)");
  std::vector<Vec3> points;
  for (py::ssize_t k = 0; k < numbers.shape(0); ++k)
    points.emplace_back(numbers.at(k, 0), numbers.at(k, 1), numbers.at(k, 2));
  return points;
}

py::object fromHull(const PlacedHull& placed) {
  return typeNamed("PlacedHull")(placed.hull, fromVec3(placed.X_PB.p_WB), fromQuat(placed.X_PB.q_WB));
}

py::object placedHull(py::handle points) {
  return fromHull(makeHull(toPoints(points, "points"), "points"));
}

py::object hullOfFile(const py::object& file, py::handle scale) {
  const double factor = toNumber(scale, "scale");
  if (!(factor > 0.0 && factor <= Limits::max_size)) refuse("scale", textOf(scale), "above 0 to 1e6");
  return fromHull(hullOfMesh(toPath(file), std::filesystem::current_path().string(), factor, "mesh"));
}

py::array_t<double> verticesOf(const ConvexHull& hull) {
  const std::vector<Vec3>& vertices = hull.polyhedron->vertices;
  py::array_t<double> array({vertices.size(), std::size_t{3}});
  for (std::size_t k = 0; k < vertices.size(); ++k)
    for (int axis = 0; axis < 3; ++axis)
      array.mutable_at(static_cast<py::ssize_t>(k), axis) = vertices[k][axis];
  return array;
}

}  // namespace

Shape toShape(py::handle value, const std::string& path) {
  if (py::isinstance<ConvexHull>(value)) return value.cast<ConvexHull>();
  if (isOf(value, "Sphere")) return Sphere{field(value, "radius", path)};
  if (isOf(value, "Box")) return Box{toVec3(value.attr("size"), path + ".size")};
  if (isOf(value, "Plane")) return Plane{};
  if (isOf(value, "Capsule")) return Capsule{field(value, "radius", path), field(value, "half_length", path)};
  if (isOf(value, "Cylinder"))
    return Cylinder{field(value, "radius", path), field(value, "half_length", path)};
  if (isOf(value, "Cone")) return Cone{field(value, "radius", path), field(value, "height", path)};
  refuse(path, textOf(value), "a Sphere, Box, Plane, Capsule, Cylinder, Cone or ConvexHull");
}

py::object fromShape(const Shape& shape) {
  struct Maker {
    py::object operator()(const Sphere& s) const { return typeNamed("Sphere")(s.radius); }
    py::object operator()(const Box& s) const {
      return typeNamed("Box")(py::make_tuple(s.size.x(), s.size.y(), s.size.z()));
    }
    py::object operator()(const Plane&) const { return typeNamed("Plane")(); }
    py::object operator()(const Capsule& s) const { return typeNamed("Capsule")(s.radius, s.half_length); }
    py::object operator()(const Cylinder& s) const { return typeNamed("Cylinder")(s.radius, s.half_length); }
    py::object operator()(const Cone& s) const { return typeNamed("Cone")(s.radius, s.height); }
    py::object operator()(const ConvexHull& s) const { return py::cast(s); }
  };
  return std::visit(Maker{}, shape);
}

void bindShapes(py::module_& module) {
  py::class_<ConvexHull>(module, "ConvexHull",
                         "A convex solid with plane faces, in its body's frame B, whose origin is the centre "
                         "of mass and whose axes\nare the principal axes of inertia. make_hull(), "
                         "hull_of_mesh() and scene files make it; it never changes.")
      .def_property_readonly("vertices", &verticesOf, "Its corners in B, m: a new array (n, 3).")
      .def_property_readonly(
          "volume", [](const ConvexHull& hull) { return hull.polyhedron->volume; }, "m³.")
      .def("__eq__",
           [](const ConvexHull& hull, py::handle other) {
             return py::isinstance<ConvexHull>(other) && sameShape(hull, other.cast<ConvexHull>());
           })
      .def("__hash__", [](const ConvexHull& hull) { return hull.polyhedron->fingerprint >> 1; })
      .def("__repr__",
           [](const ConvexHull& hull) {
             return "ConvexHull of " + std::to_string(hull.polyhedron->vertices.size()) + " vertices";
           })
      .def(py::pickle(
          [](const ConvexHull& hull) { return py::make_tuple(verticesOf(hull)); },
          [](const py::tuple& state) { return makeHull(toPoints(state[0], "points"), "points").hull; }));
  module.def("make_hull", &placedHull, py::arg("points"),
             Doc("The convex hull of points in any frame P, as a PlacedHull.\n\npoints: (n, 3), m; 4 to "
                 "1,000,000 of them. Points that lie within the hull do not matter.\nRaises InvalidInput for "
                 "points on a plane or a line, and for a hull of more than 4096 vertices."));
  module.def("hull_of_mesh", &hullOfFile, py::arg("file"), py::arg("scale") = 1.0,
             Doc("The convex hull of the vertices of a mesh file (.obj, .stl, .ply, .dae, .gltf, .glb), as a "
                 "PlacedHull.\n\nscale: multiplies the vertices, above 0.\nRaises InvalidInput for a file "
                 "that cannot be read or is no sound mesh, and where make_hull() does."));
}

}  // namespace rbs::python
