// SPDX-License-Identifier: BSD-3-Clause
#include "reports.h"

#include "shapes.h"
#include "values.h"

namespace rbs::python {
namespace {

/// A tuple of what `convert` makes of each item.
template <class Item, class Convert>
py::tuple tupleOf(const std::vector<Item>& items, const Convert& convert) {
  py::tuple result(items.size());
  for (std::size_t k = 0; k < items.size(); ++k) result[k] = convert(items[k]);
  return result;
}

py::tuple residualsOf(const StepReport& report) {
  const py::object type = typeNamed("IslandResiduals");
  return tupleOf(report.residuals, [&](const IslandResiduals& r) {
    return type(r.bodies, r.contacts, r.method, r.iterations, r.signorini, r.coulomb, r.dissipation,
                r.converged, r.deepest_penetration, r.energy_change, r.turn);
  });
}

py::tuple warningsOf(const StepReport& report) {
  const py::object type = typeNamed("StepWarning");
  return tupleOf(report.warnings, [&](const Warning& warning) { return type(warning.kind, warning.text); });
}

}  // namespace

py::object fromTotals(const Totals& totals) {
  return typeNamed("Totals")(totals.kinetic_energy, totals.potential_energy, fromVec3(totals.momentum),
                             fromVec3(totals.angular_momentum));
}

py::tuple fromPipeline(const std::vector<StageInfo>& stages) {
  const py::object type = typeNamed("StageInfo");
  return tupleOf(stages, [&](const StageInfo& stage) {
    return type(stage.name, stage.active, stage.reason, stage.items, stage.unit, stage.seconds,
                stage.part_of);
  });
}

py::tuple fromDescriptions(const std::vector<BodyDescription>& bodies) {
  const py::object type = typeNamed("BodyDescription");
  return tupleOf(bodies, [&](const BodyDescription& body) {
    const Material& m = body.material;
    const Color& c = body.color;
    return type(body.id.serial, body.name, fromShape(body.shape), kindName(body.kind), body.mass,
                body.density, fromVec3(body.inertia), m.friction, m.restitution,
                m.drag_coefficient.value_or(0.0), m.rolling_resistance, m.torsional_resistance,
                py::make_tuple(c[0], c[1], c[2], c[3]), body.group, body.mask, body.frozen);
  });
}

py::list namesOf(const std::vector<BodyDescription>& bodies) {
  py::list names;
  for (const BodyDescription& body : bodies) names.append(body.name);
  return names;
}

void bindReports(py::module_& module) {
  py::class_<StepReport>(module, "StepReport",
                         "What a step did. Where it has several divisions, times, tests, impacts and "
                         "warnings are those of all together, and\nthe rest is that of the last one.")
      .def_readonly("seconds", &StepReport::seconds, "Wall time of the step, s.")
      .def_readonly("pairs", &StepReport::pairs, "Candidate pairs of the broad phase.")
      .def_readonly("overlap_tests", &StepReport::overlap_tests,
                    "Pairs of bounds that the broad phase compared.")
      .def_readonly("axis_queries", &StepReport::axis_queries,
                    "Queries of the narrow phase for pairs without a closed form.")
      .def_readonly("axes_kept", &StepReport::axes_kept,
                    "Those that the separating axis of the last query answered.")
      .def_readonly("contacts", &StepReport::contacts, "Contact points, also those that nearly touch.")
      .def_readonly("islands", &StepReport::islands, "Islands that the contact solver handled.")
      .def_readonly("flying", &StepReport::flying, "Dynamic bodies in free flight.")
      .def_readonly("impacts", &StepReport::impacts, "Impacts located in time and resolved in order.")
      .def_readonly("deferred_impacts", &StepReport::deferred_impacts,
                    "Located impacts that were left to the contact solver.")
      .def_readonly(
          "repeated", &StepReport::repeated,
          "Dynamic bodies that the step took once more, because contacts had pushed one into another.")
      .def_readonly("deepest_penetration", &StepReport::deepest_penetration,
                    "Largest penetration depth at the end of the step, m, >= 0.")
      .def_property_readonly("residuals", &residualsOf,
                             "A tuple of IslandResiduals, of the islands that have contact points.")
      .def_property_readonly("warnings", &warningsOf,
                             "A tuple of StepWarning: trouble of this step; empty: none.")
      .def("__repr__", [](const StepReport& r) {
        return "StepReport(contacts=" + std::to_string(r.contacts) +
               ", impacts=" + std::to_string(r.impacts) + ", warnings=" + std::to_string(r.warnings.size()) +
               ")";
      });
}

}  // namespace rbs::python
