// SPDX-License-Identifier: BSD-3-Clause
// Queries of a World as it is now, and of a Snapshot: rays, closest points, overlaps.
#include "shapes.h"
#include "values.h"
#include "world.h"

#include "rigid_body_sim/queries.h"

namespace rbs::python {
namespace {

BodyId toBodyId(const Snapshot& snapshot, py::handle body, const std::string& path) {
  if (!py::isinstance<py::str>(body)) return {toWhole(body, path, 0)};
  const int index = snapshot.find(toText(body, path));
  if (index < 0) refuse(path, textOf(body), "the name of a body");
  return snapshot.states[static_cast<std::size_t>(index)].id;
}

Ray toRay(const Snapshot& snapshot, py::handle origin, py::handle direction, py::handle distance,
          py::handle ignore) {
  Ray ray;
  ray.origin_W = toVec3(origin, "origin");
  ray.direction_W = toVec3(direction, "direction");
  if (!distance.is_none()) ray.max_distance = toNumber(distance, "max_distance");
  if (!py::isinstance<py::iterable>(ignore) || py::isinstance<py::str>(ignore))
    refuse("ignore", textOf(ignore), "a list of handles or names");
  for (const py::handle body : ignore) ray.ignore.push_back(toBodyId(snapshot, body, "ignore"));
  return ray;
}

py::object fromHit(const RayHit& hit) {
  return typeNamed("RayHit")(hit.body.serial, fromVec3(hit.p_W), fromVec3(hit.n_W), hit.distance);
}

/// Adds the queries to a class of which `get` gives the snapshot.
template <class Class, class Get>
void addQueries(Class& type, const Get& get) {
  using Self = typename Class::type;
  const std::string ray =
      "origin: (3,) in W, m. direction: (3,) in W, of any length but 0. max_distance: m, above 0; None: no "
      "end.\nignore: handles or names of bodies that the ray passes through.";
  type.def(
          "cast_ray",
          [=](Self& self, py::handle origin, py::handle direction, py::handle distance, py::handle ignore) {
            const auto snapshot = get(self);
            const auto hit = castRay(*snapshot, toRay(*snapshot, origin, direction, distance, ignore));
            return hit ? fromHit(*hit) : py::none();
          },
          py::arg("origin"), py::arg("direction"), py::arg("max_distance") = py::none(),
          py::arg("ignore") = py::tuple(),
          Doc("The first body that the ray hits: a RayHit, or None.\n\n" + ray))
      .def(
          "cast_ray_through",
          [=](Self& self, py::handle origin, py::handle direction, py::handle distance, py::handle ignore) {
            const auto snapshot = get(self);
            py::list hits;
            for (const RayHit& hit :
                 castRayThrough(*snapshot, toRay(*snapshot, origin, direction, distance, ignore)))
              hits.append(fromHit(hit));
            return hits;
          },
          py::arg("origin"), py::arg("direction"), py::arg("max_distance") = py::none(),
          py::arg("ignore") = py::tuple(),
          Doc("All bodies that the ray hits, the nearest first: a list of RayHit.\n\n" + ray))
      .def(
          "closest_points",
          [=](Self& self, py::handle a, py::handle b) {
            const auto snapshot = get(self);
            const ClosestPoints points =
                closestPoints(*snapshot, toBodyId(*snapshot, a, "body_a"), toBodyId(*snapshot, b, "body_b"));
            return typeNamed("ClosestPoints")(points.distance, fromVec3(points.n_W), fromVec3(points.p_WA),
                                              fromVec3(points.p_WB));
          },
          py::arg("body_a"), py::arg("body_b"),
          Doc("Where two bodies (handles or names) are nearest to each other, or overlap most deeply: "
              "ClosestPoints.\n\nRaises InvalidInput where both are the same, and where both are planes."))
      .def(
          "overlaps",
          [=](Self& self, py::handle shape, py::handle position, py::handle orientation, py::handle margin) {
            const Pose pose{toVec3(position, "position"), toQuat(orientation, "orientation")};
            py::list bodies;
            for (const Neighbour& body :
                 overlaps(*get(self), toShape(shape, "shape"), pose, toNumber(margin, "margin")))
              bodies.append(typeNamed("Neighbour")(body.body.serial, body.distance));
            return bodies;
          },
          py::arg("shape"), py::arg("position"), py::arg("orientation") = py::make_tuple(0.0, 0.0, 0.0, 1.0),
          py::arg("margin") = 0.0,
          Doc("The bodies within `margin` (m, 0 to 1e9) of a shape: a list of Neighbour, the oldest "
              "first.\n\nposition: (3,) in W, m. orientation: (4,) [x, y, z, w]."));
}

}  // namespace

void bindQueries(WorldClass& world, py::class_<Snapshot, std::shared_ptr<Snapshot>>& snapshot) {
  addQueries(world, [](PyWorld& self) { return self.snapshot(); });
  addQueries(snapshot, [](Snapshot& self) -> const Snapshot* { return &self; });
}

}  // namespace rbs::python
