// SPDX-License-Identifier: BSD-3-Clause
#include "world.h"

#include "reports.h"
#include "values.h"

#include "rigid_body_sim/commands.h"

#include <chrono>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>

namespace rbs::python {
namespace {

/// Marks a world as busy.
class Busy {
 public:
  explicit Busy(bool& flag) : flag_(flag) { flag_ = true; }
  ~Busy() { flag_ = false; }
  Busy(const Busy&) = delete;
  Busy& operator=(const Busy&) = delete;

 private:
  bool& flag_;
};

// Without the lock of the interpreter; then signals get their turn.
constexpr std::chrono::milliseconds kChunk{20};

/// The warnings of several steps, each once, and the first of each kind where there are too many.
class Warnings {
 public:
  void add(const std::vector<Warning>& warnings) {
    for (const Warning& warning : warnings) {
      const bool is_new_kind = kinds_.insert(warning.kind).second;
      if (all_.size() >= kMost && !is_new_kind) continue;
      if (known_.emplace(warning.kind, warning.text).second) all_.push_back(warning);
    }
  }
  std::vector<Warning> all() && { return std::move(all_); }

 private:
  static constexpr std::size_t kMost = 1000;
  std::set<std::string> kinds_;
  std::set<std::pair<std::string, std::string>> known_;
  std::vector<Warning> all_;
};

/// Takes `left` steps, or as many as there is time for in a chunk, at least one, and counts `left` down.
const StepReport& stepForAChunk(World& world, std::uint64_t& left, Warnings& warnings) {
  const auto end = std::chrono::steady_clock::now() + kChunk;
  while (true) {
    const StepReport& report = world.step();
    warnings.add(report.warnings);
    if (--left == 0 || std::chrono::steady_clock::now() > end) return report;
  }
}

std::unique_ptr<PyWorld> makeWorld(const Scene& scene) {
  SceneFile file = scene.file();
  const py::gil_scoped_release release;
  return std::make_unique<PyWorld>(World(std::move(file.scene), file.state));
}

Scene capture(const PyWorld& world, bool user_forces) {
  const World& w = world.read();
  return Scene({w.capture(), user_forces ? w.captureExactState() : w.captureState()});
}

std::string toYaml(const PyWorld& world) {
  return writeScene(world.read().capture(), world.read().captureExactState());
}

std::unique_ptr<PyWorld> fromYaml(const std::string& text, const std::string& source) {
  SceneFile file = parseScene(text, source);
  return std::make_unique<PyWorld>(World(std::move(file.scene), file.state));
}

std::unique_ptr<PyWorld> copy(const PyWorld& world) {
  return std::make_unique<PyWorld>(World(world.read()));
}

void bindLife(WorldClass& type) {
  type.def(py::init(&makeWorld), py::arg("scene"),
           Doc("A world of this scene; a saved state resumes its run bit for bit.\n\nRaises InvalidInput "
               "with every fault."))
      .def_static(
          "load",
          [](const py::object& path) {
            return py::type::of<PyWorld>()(py::type::of<Scene>().attr("load")(path));
          },
          py::arg("path"), Doc("World(Scene.load(path)): resumes what save() wrote."))
      .def("capture", &capture, py::arg("user_forces") = true,
           Doc("The world as a Scene that is a saved state: World(scene) has the same state_hash(), and the "
               "same future, bit for bit.\n\nuser_forces: False leaves out grabs, holds and the memory of "
               "frozen bodies, as a saved state for people does."))
      .def(
          "save",
          [](const PyWorld& world, const py::object& path, bool overwrite) {
            writeText(path, toYaml(world), overwrite);
          },
          py::arg("path"), py::arg("overwrite") = false,
          Doc("Writes capture() to a file, whole or not at all; load() resumes it bit for bit.\n\nRaises "
              "InvalidInput for a file that is there already, unless `overwrite`, for one that cannot be "
              "written,\nand for more than 100,000 bodies or 16 MiB."))
      .def("copy", &copy,
           Doc("Another world with the same future, bit for bit, but no journal and one thread."))
      .def("__copy__", &copy)
      .def(
          "__deepcopy__", [](const PyWorld& world, py::handle) { return copy(world); }, py::arg("memo"))
      .def(
          py::pickle([](const PyWorld& world) { return py::make_tuple(toYaml(world)); },
                     [](const py::tuple& state) { return fromYaml(state[0].cast<std::string>(), "pickle"); }))
      .def("__repr__", [](const PyWorld& world) {
        const World& w = world.read();
        return "World('" + w.scene().name + "', " + std::to_string(w.bodies()->size()) + " bodies, " +
               std::to_string(w.steps()) + " steps)";
      });
}

void bindTime(WorldClass& type) {
  type.def(
          "step", [](PyWorld& world, py::handle n) { return world.step(toWhole(n, "n", 1)); },
          py::arg("n") = 1,
          Doc("Takes n steps (1 or more) of the scene's length, and returns the StepReport of the last, with "
              "the warnings of all of\nthem, each once, about 1,000 at most.\n\nOther threads of Python run "
              "meanwhile; the world refuses all their calls with RuntimeError. Trouble never raises: it "
              "is\nin the report's warnings. Ctrl-C raises KeyboardInterrupt between two steps; `steps` is "
              "how many were taken."))
      .def_property(
          "threads", [](const PyWorld& world) { return world.read().threads(); },
          [](PyWorld& world, py::handle n) {
            const std::uint64_t threads = toWhole(n, "threads", 1, 256);
            world.change().setThreads(static_cast<unsigned>(threads));
          },
          "How many threads a step may use, 1 to 256; 1 at first. Results are equal for every number, bit "
          "for bit.")
      .def_property_readonly(
          "time", [](const PyWorld& world) { return world.read().time(); },
          "Physics time since the scene began, s.")
      .def_property_readonly(
          "steps", [](const PyWorld& world) { return world.read().steps(); }, "Steps since the scene began.")
      .def_property_readonly(
          "edits", [](const PyWorld& world) { return world.read().edits(); },
          "Edit counter, 1 for a new world.");
}

void bindReading(WorldClass& type) {
  type.def_property_readonly(
          "names", [](const PyWorld& world) { return namesOf(*world.read().bodies()); },
          "The names of the bodies, in the order of the arrays: a new list.")
      .def(
          "bodies", [](const PyWorld& world) { return fromDescriptions(*world.read().bodies()); },
          Doc("The properties of the bodies, in the order of the arrays: a tuple of BodyDescription."))
      .def(
          "find",
          [](const PyWorld& world, py::handle name) -> py::object {
            const BodyId id = world.read().find(toText(name, "name"));
            return id ? py::object(py::int_(id.serial)) : py::none();
          },
          py::arg("name"), Doc("The handle of the body of this name, or None."))
      .def(
          "pose",
          [](const PyWorld& world, py::handle body) {
            return fromPose(world.read().pose(toBodyId(world.read(), body, "body")));
          },
          py::arg("body"),
          Doc("(position, orientation) of a body now: arrays (3,) in W, m, and (4,) [x, y, z, w].\n\nbody: "
              "handle or name."))
      .def_property_readonly(
          "scene",
          [](const PyWorld& world) {
            return Scene({world.read().scene(), std::nullopt});
          },
          "The settings as they are now: a new Scene without bodies.")
      .def(
          "contacts", [](PyWorld& world) { return arrayOf(world.contacts()); },
          Doc("The contact points of the last step: a structured array (m,), which cannot be "
              "written.\n\nFields: body_a, body_b (handles, the older body first), position (m, in W, midway "
              "between the surfaces), normal\n(unit, in W, from a to b), separation (m; negative is "
              "penetration), normal_impulse (N s, over the step, >= 0),\nfriction_impulse (on b, in W, N s, "
              "over the step), touching_steps (for how many steps the two have pushed each other without a "
              "break; 1: they\n"
              "began in this step; 0: they do not touch). The array is a view of the moment of the call: it "
              "never changes\nand stays "
              "valid when the world steps on or is gone."))
      .def(
          "totals", [](const PyWorld& world) { return fromTotals(world.read().totals()); },
          Doc("Energy and momentum of the dynamic bodies now: Totals."))
      .def(
          "pipeline", [](const PyWorld& world) { return fromPipeline(world.read().pipeline()); },
          Doc("The stages of the step, whether each runs, why, and its cost: a tuple of StageInfo."))
      .def_property_readonly(
          "report", [](PyWorld& world) { return world.snapshot()->report; },
          "The StepReport of the last step.")
      .def(
          "state_hash", [](const PyWorld& world) { return world.read().stateHash(); },
          Doc("Hash of what decides the next steps, 0 to 2^64 - 1: equal worlds have equal hashes, in C++ "
              "too."))
      .def_property_readonly(
          "bodies_analysed", [](const PyWorld& world) { return world.read().bodiesAnalysed(); },
          "Number of analyses of single bodies so far, each for the effects that the body needs.")
      .def(
          "snapshot", [](PyWorld& world) { return std::const_pointer_cast<Snapshot>(world.snapshot()); },
          Doc("The whole world as it is now: a Snapshot, which never changes. It is the same one until a "
              "step or an edit."));
  bindStateArrays<PyWorld*>(
      type, [](PyWorld* world) { return world->states(); },
      "The array cannot be written. It is a view of the moment of the call: it never changes and stays valid "
      "when the world\nsteps on or is gone. Ask again after a step; until then the same memory is shown.");
}

}  // namespace

const World& PyWorld::read() const {
  if (busy_)
    throw std::runtime_error(
        "the world is busy with a step or a call of its journal; use it from one thread at a time");
  return world_;
}

World& PyWorld::change() {
  read();
  states_.reset(), contacts_.reset(), snapshot_.reset();
  return world_;
}

States PyWorld::states() {
  const World& world = read();
  if (!states_) states_ = std::make_shared<const std::vector<BodyState>>(world.states());
  return states_;
}

Contacts PyWorld::contacts() {
  const World& world = read();
  if (!contacts_) contacts_ = std::make_shared<const std::vector<ContactPoint>>(world.contacts());
  return contacts_;
}

std::shared_ptr<const Snapshot> PyWorld::snapshot() {
  const World& world = read();
  if (!snapshot_) snapshot_ = std::make_shared<Snapshot>(world.snapshot());
  return snapshot_;
}

StepReport PyWorld::step(std::uint64_t n) {
  World& world = change();
  const Busy busy(busy_);
  Warnings warnings;
  while (true) {
    const StepReport* last = nullptr;
    {
      const py::gil_scoped_release release;
      last = &stepForAChunk(world, n, warnings);
    }
    if (n == 0) {
      StepReport report = *last;
      report.warnings = std::move(warnings).all();
      return report;
    }
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  }
}

void PyWorld::setJournal(const py::object& journal) {
  if (journal.is_none()) return change().setJournal(nullptr);
  if (PyCallable_Check(journal.ptr()) == 0) refuse("journal", textOf(journal), "a function, or None");
  change().setJournal([this, journal](const Command& command) {
    const Busy busy(busy_);
    try {
      journal(writeCommand(command));
    } catch (py::error_already_set& error) {  // the change is made: it cannot be refused any more
      error.discard_as_unraisable("the journal of a World");
    }
  });
}

BodyId toBodyId(const World& world, py::handle body, const std::string& path) {
  if (!py::isinstance<py::str>(body)) return {toWhole(body, path, 0)};
  const BodyId id = world.find(toText(body, path));
  if (!id) refuse(path, textOf(body), "the name of a body");
  return id;
}

void bindWorld(WorldClass& type) {
  bindLife(type);
  bindTime(type);
  bindReading(type);
  bindEdits(type);
}

}  // namespace rbs::python
