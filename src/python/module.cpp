// SPDX-License-Identifier: BSD-3-Clause
// The extension module rigid_body_sim._core: the physics for Python.
#include "body.h"
#include "errors.h"
#include "reports.h"
#include "scene.h"
#include "shapes.h"
#include "world.h"

PYBIND11_MODULE(_core, module) {
  using namespace rbs::python;
  pybind11::options options;
  options.disable_function_signatures();  // Doc has them
  module.doc() = "The physics: see the package rigid_body_sim, which has all names of this module.";
  bindErrors(module);
  bindShapes(module);
  bindBody(module);
  bindScene(module);
  bindReports(module);
  py::class_<rbs::Snapshot, std::shared_ptr<rbs::Snapshot>> snapshot(
      module, "Snapshot",
      "A whole world at one instant between two steps. It never changes, and any thread may keep and read "
      "it.");
  WorldClass world(
      module, "World",
      "A simulated world: bodies, surroundings, solver settings and the state of motion.\n\nOne thread uses "
      "it at a time. A verb does all that it was asked, or raises InvalidInput and changes nothing. A body "
      "is\nnamed by its name or by its handle, a number of this world: the handle of another world is "
      "refused, or names another body.\nEqual worlds under equal verbs stay equal, bit for bit.");
  bindSnapshot(snapshot);
  bindWorld(world);
  bindQueries(world, snapshot);
  bindRollout(module);
}
