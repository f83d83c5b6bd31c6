// SPDX-License-Identifier: BSD-3-Clause
#include "scene.h"

#include "body.h"
#include "settings.h"
#include "values.h"
#include "write_file.h"

#include <pybind11/stl.h>

#include <dlfcn.h>

#include <filesystem>
#include <utility>

namespace rbs::python {
namespace {

namespace fs = std::filesystem;

/// The catalogue that is installed with this library; else that of the source folder.
std::string catalogueFolder() {
  Dl_info library{};
  if (dladdr(reinterpret_cast<const void*>(&catalogueFolder), &library) == 0) return RBS_SCENE_FOLDER;
  const fs::path folder = fs::absolute(library.dli_fname).parent_path();
  const fs::path installed = (folder / "../../../../share/rigid_body_sim/scenes").lexically_normal();
  std::error_code error;
  return fs::is_directory(installed, error) ? installed.string() : RBS_SCENE_FOLDER;
}

std::optional<std::uint64_t> toSeed(py::handle seed) {
  return toOptional(seed, "seed",
                    [](py::handle value, const std::string& path) { return toWhole(value, path, 0); });
}

Scene load(const py::object& name_or_path, const py::object& seed) {
  std::string name = toPath(name_or_path);
  // A pathlib.Path is a path, also without a "/".
  if (!py::isinstance<py::str>(name_or_path)) name = fs::absolute(name).string();
  const std::optional<std::uint64_t> given = toSeed(seed);
  SceneFile file;
  {
    const py::gil_scoped_release release;
    file = readScene(findScene(catalogueFolder(), name), given);
  }
  return Scene(std::move(file));
}

Scene parse(py::handle given_text, py::handle given_source, const py::object& seed) {
  const std::string text = toText(given_text, "text"), source = toText(given_source, "source");
  const std::optional<std::uint64_t> given = toSeed(seed);
  SceneFile file;
  {
    const py::gil_scoped_release release;
    file = parseScene(text, source, given);
  }
  return Scene(std::move(file));
}

std::string toYaml(const Scene& scene) {
  const SceneFile file = scene.file();
  const py::gil_scoped_release release;
  return writeScene(file.scene, file.state);
}

Scene copy(const Scene& scene) {
  return Scene(scene.file());
}

py::tuple problemsOf(const Scene& scene) {
  py::list problems;
  for (const Problem& problem : validate(scene.file().scene))
    problems.append(typeNamed("Problem")(problem.path, problem.value, problem.allowed));
  return py::tuple(problems);
}

py::dict catalogue() {
  py::dict scenes;
  for (const SceneEntry& entry : listScenes(catalogueFolder())) scenes[entry.name.c_str()] = entry.property;
  return scenes;
}

Scene makeScene(py::handle bodies, const py::kwargs& fields) {
  Scene scene;
  const py::object self = py::cast(&scene, py::return_value_policy::reference);
  py::setattr(self, "bodies", bodies);
  for (const auto& [name, value] : fields) setField(self, name, value);
  return scene;
}

using Class = py::class_<Scene>;

void bindMaking(Class& type) {
  type.def(py::init(&makeScene), py::arg("bodies") = py::tuple(),
           Doc("Scene(bodies=(), **fields): the fields by their names; the others keep the defaults of scene "
               "files."))
      .def_static("load", &load, py::arg("name_or_path"), py::arg("seed") = py::none(),
                  Doc("Reads a scene or a saved state: a name of catalogue(), or the path of a file (with "
                      "'/', ending in '.yaml', or a Path).\n\nseed: replaces that of the file, 0 to 2^64 - "
                      "1.\nRaises InvalidInput with every fault: 'file:line: path: value (allowed: ...)'."))
      .def_static("parse", &parse, py::arg("text"), py::arg("source") = "text", py::arg("seed") = py::none(),
                  Doc("Reads a scene or a saved state from YAML text of at most 16 MiB.\n\nsource: names the "
                      "text in messages; meshes are looked for beside it.\nRaises InvalidInput with every "
                      "fault: 'source:line: path: value (allowed: ...)'."))
      .def("to_yaml", &toYaml,
           Doc("The text of the scene, which parse() reads back bit for bit.\n\nRaises InvalidInput for a "
               "faulty scene, and for one of more than 100,000 bodies or 16 MiB."))
      .def(
          "save",
          [](const Scene& scene, const py::object& path, bool overwrite) {
            writeText(path, toYaml(scene), overwrite);
          },
          py::arg("path"), py::arg("overwrite") = false,
          Doc("Writes to_yaml() to a file, whole or not at all.\n\nRaises InvalidInput for a file that is "
              "there already, unless `overwrite`, and for one that cannot be written."))
      .def("validate", &problemsOf,
           Doc("Every fault of the scene: a tuple of Problem, empty for a sound one."))
      .def("copy", &copy, Doc("Another Scene with bodies of its own."))
      .def("__copy__", &copy)
      .def(
          "__deepcopy__", [](const Scene& scene, py::handle) { return copy(scene); }, py::arg("memo"))
      .def("__repr__",
           [](const Scene& scene) {
             return "Scene('" + scene.settings.name + "', " + std::to_string(py::len(scene.bodies)) +
                    " bodies)";
           })
      .def(py::pickle(
          [](const Scene& scene) { return py::make_tuple(toYaml(scene)); },
          [](const py::tuple& state) { return Scene(parseScene(state[0].cast<std::string>(), "pickle")); }));
}

/// A field of the settings.
template <class Value, class From, class To>
void bindField(Class& type, const char* name, Value SceneDef::*field, const From& from, const To& to,
               const char* doc) {
  type.def_property(
      name, [field, from](const Scene& scene) { return from(scene.settings.*field); },
      [field, to, name](Scene& scene, py::handle value) { scene.settings.*field = to(value, name); }, doc);
}

/// A field that may be None.
template <class Value, class From, class To>
void bindOptional(Class& type, const char* name, std::optional<Value> SceneDef::*field, const From& from,
                  const To& to, const char* doc) {
  const auto convert = [to](py::handle value, const std::string& path) {
    return toOptional(value, path, to);
  };
  bindField(type, name, field, from, convert, doc);
}

void bindSettings(Class& type) {
  const auto same = [](const auto& value) { return value; };
  bindField(type, "name", &SceneDef::name, same, toText, "Name of the scene.");
  bindField(type, "property", &SceneDef::property, same, toText,
            "One sentence: what the scene shows and how to see that it is right.");
  bindField(type, "step", &SceneDef::step, same, toNumber, "Length of a step, s, 1e-6 to 1.");
  bindField(
      type, "seed", &SceneDef::seed, same,
      [](py::handle value, const std::string& path) { return toWhole(value, path, 0); },
      "Seed of the gusts, 0 to 2^64 - 1. Random placement in a file follows the seed of load() or parse().");
  bindField(type, "fidelity", &SceneDef::fidelity, fromSetting, toSetting,
            "Solver settings: a Setting, or the name of a quality level.");
  bindField(type, "view", &SceneDef::view, fromView, toView, "Where a viewer should stand: a View.");
  bindField(type, "effects", &SceneDef::effects, fromEffects, toEffects,
            "Effects forced on (True) or off (False), by name: a new dictionary. The others are detected.");
  bindOptional(type, "goal", &SceneDef::goal, fromGoal, toGoal,
               "Goal by which a simulator changes the solver settings; None: they stay. World.step() does "
               "not follow it.");
  bindOptional(type, "air", &SceneDef::air, fromAir, toAir, "Air, or None: vacuum.");
  bindOptional(type, "wind", &SceneDef::wind, fromWind, toWind, "Wind, or None: air at rest.");
  bindOptional(type, "fluid", &SceneDef::fluid, fromFluid, toFluid, "Fluid, or None: no buoyancy.");
  type.def_property(
      "gravity", [](const py::object& self) { return viewOf(self.cast<Scene&>().settings.gravity, self); },
      [](Scene& scene, py::handle value) { scene.settings.gravity = toVec3(value, "gravity"); },
      "(3,) in W, m/s², at most 1e7; zero is none. A view, which can be written.");
}

void bindContents(Class& type) {
  type.def_property(
          "bodies", [](const Scene& scene) { return scene.bodies; },
          [](Scene& scene, py::handle bodies) {
            if (!py::isinstance<py::iterable>(bodies)) refuse("bodies", textOf(bodies), "a list of Body");
            py::list listed(py::reinterpret_borrow<py::object>(bodies));  // what is iterable may be so once
            toBodies(listed, "bodies");
            scene.bodies = std::move(listed);
          },
          "The list of Body, in the order in which a world makes them. It can be changed in place.")
      .def_property_readonly(
          "is_saved_state", [](const Scene& scene) { return scene.state.has_value(); },
          "Whether it resumes a run: it then has time, contact forces, wrenches and so on, which name bodies "
          "by their\nplaces in the list.")
      .def(
          "forget_state", [](Scene& scene) { scene.state.reset(); }, Doc("Makes it a fresh start."));
}

}  // namespace

Scene::Scene(SceneFile file)
    : settings(std::move(file.scene)),
      bodies(fromBodies(std::move(settings.bodies))),
      state(std::move(file.state)) {
  settings.bodies.clear();
}

SceneFile Scene::file() const {
  SceneFile file{settings, state};
  file.scene.bodies = toBodies(bodies, "bodies");
  return file;
}

void writeText(const py::object& path, const std::string& text, bool overwrite) {
  const std::string name = toPath(path);
  if (name.empty()) refuse("path", "''", "the path of a file");
  const std::string file = fs::absolute(name).string();
  const py::gil_scoped_release release;
  writeFile(file, text, overwrite);
}

void bindScene(py::module_& module) {
  Class type(module, "Scene",
             "The definition of a scene, which a World is made of. Its fields have the names of the keys of "
             "scene files (docs/scenes.md).\n\nNumbers are checked where the scene is used: by World(), "
             "to_yaml() and validate().");
  bindMaking(type);
  bindSettings(type);
  bindContents(type);
  module.def("catalogue", &catalogue,
             Doc("The scenes that load() knows by name: a dictionary of name to what it shows."));
}

}  // namespace rbs::python
