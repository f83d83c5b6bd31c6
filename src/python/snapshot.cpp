// SPDX-License-Identifier: BSD-3-Clause
// Snapshot: a whole world at one instant, which never changes.
#include "reports.h"
#include "settings.h"
#include "values.h"
#include "world.h"

#include "rigid_body_sim/difference.h"

namespace rbs::python {
namespace {

using Class = py::class_<Snapshot, std::shared_ptr<Snapshot>>;
using Self = std::shared_ptr<Snapshot>;

const char* const kLasting =
    "The array cannot be written. It is a view of the snapshot's memory and keeps it alive.";

py::object differenceOf(const Snapshot& run, const Snapshot& truth) {
  if (namesOf(*run.bodies).not_equal(namesOf(*truth.bodies)))
    refuse("truth", "other bodies", "a snapshot of the same bodies in the same order");
  const Difference d = rbs::differenceOf(run, truth);
  return typeNamed("Difference")(d.moved_body, d.distance, d.turned_body, d.angle, d.energy);
}

void bindBodies(Class& type) {
  bindStateArrays<Self>(
      type, [](const Self& self) { return States(self, &self->states); }, kLasting);
  type.def_property_readonly(
          "names", [](const Snapshot& s) { return namesOf(*s.bodies); },
          "The names of the bodies, in the order of the arrays: a new list.")
      .def(
          "bodies", [](const Snapshot& s) { return fromDescriptions(*s.bodies); },
          Doc("The properties of the bodies, in the order of the arrays: a tuple of BodyDescription."))
      .def_property_readonly(
          "methods",
          [](const Snapshot& s) {
            py::list methods;
            for (const BodyState& state : s.states) methods.append(state.method);
            return methods;
          },
          "What took each body through the last step: '' (nothing yet, or not moved by forces), 'ballistic', "
          "'flight',\n'asleep', or the method of its island.")
      .def(
          "contacts", [](const Self& self) { return arrayOf(Contacts(self, &self->contacts)); },
          Doc("The contact points of the last step, as World.contacts() has them: a view that cannot be "
              "written."));
}

void bindRest(Class& type) {
  type.def_readonly("scene", &Snapshot::scene, "Name of the scene.")
      .def_readonly("time", &Snapshot::time, "Physics time since the scene began, s.")
      .def_readonly("steps", &Snapshot::steps, "Steps since the scene began.")
      .def_readonly("step", &Snapshot::step, "Length of a step, s.")
      .def_readonly("edits", &Snapshot::edits, "Edit counter.")
      .def_readonly("report", &Snapshot::report, "The StepReport of the last step.")
      .def_readonly("hash", &Snapshot::hash, "World.state_hash().")
      .def(
          "totals", [](const Snapshot& s) { return fromTotals(s.totals); },
          Doc("Energy and momentum: Totals."))
      .def(
          "pipeline", [](const Snapshot& s) { return fromPipeline(s.pipeline); },
          Doc("The stages of the step: a tuple of StageInfo."))
      .def_property_readonly(
          "gravity", [](const Snapshot& s) { return fromVec3(s.gravity); }, "(3,) in W, m/s²: a new array.")
      .def_property_readonly(
          "air_velocity", [](const Snapshot& s) { return fromVec3(s.air.velocity); },
          "(3,) velocity of the air now, gust included, in W, m/s; zero without wind: a new array.")
      .def_property_readonly(
          "fluid", [](const Snapshot& s) { return fromFluid(s.fluid); }, "Fluid, or None.")
      .def_property_readonly(
          "fidelity", [](const Snapshot& s) { return fromSetting(s.fidelity); }, "Solver settings: Setting.")
      .def_property_readonly(
          "goal", [](const Snapshot& s) { return fromGoal(s.goal); }, "Goal, or None.")
      .def_property_readonly(
          "effects", [](const Snapshot& s) { return fromEffects(s.effects); },
          "Effects forced on (True) or off (False): a new dictionary.")
      .def("difference", &differenceOf, py::arg("truth"),
           Doc("How far this run has gone apart from another run of the same bodies: a Difference."));
}

}  // namespace

void bindSnapshot(Class& type) {
  bindBodies(type);
  bindRest(type);
}

}  // namespace rbs::python
