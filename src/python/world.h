// SPDX-License-Identifier: BSD-3-Clause
// World: a world of the core that one thread of Python uses at a time.
#pragma once

#include "arrays.h"
#include "scene.h"

#include "rigid_body_sim/world.h"

#include <cstdint>
#include <memory>
#include <string>

namespace rbs::python {

/// What Python calls a World. A step runs without the lock of the interpreter; the world refuses all other calls
/// meanwhile. Arrays are of a copy of the states that is made when it is first asked for, and dropped by the next
/// step or edit.
class PyWorld {
 public:
  explicit PyWorld(World world) : world_(std::move(world)) {}
  PyWorld(const PyWorld&) = delete;
  PyWorld& operator=(const PyWorld&) = delete;

  /// The world, to be read. Throws std::runtime_error during a step or a journal's call, as change() does.
  const World& read() const;
  /// The world, to be changed: what was copied of it is dropped.
  World& change();

  States states();
  Contacts contacts();
  std::shared_ptr<const Snapshot> snapshot();

  /// Takes n steps, and looks for signals now and then.
  StepReport step(std::uint64_t n);
  /// Calls `journal` with the text of each change; None: no journal.
  void setJournal(const py::object& journal);

 private:
  World world_;
  bool busy_ = false;  // under the lock of the interpreter
  States states_;
  Contacts contacts_;
  std::shared_ptr<const Snapshot> snapshot_;
};

/// The body of this name or handle. Throws InvalidInput with `path` for what is neither.
BodyId toBodyId(const World& world, py::handle body, const std::string& path);

using WorldClass = py::class_<PyWorld>;

void bindWorld(WorldClass& type);
/// The verbs that change bodies, forces and surroundings.
void bindEdits(WorldClass& type);
/// Rays, closest points and overlaps, also of a Snapshot.
void bindQueries(WorldClass& world, py::class_<Snapshot, std::shared_ptr<Snapshot>>& snapshot);
void bindSnapshot(py::class_<Snapshot, std::shared_ptr<Snapshot>>& type);
void bindRollout(py::module_& module);

}  // namespace rbs::python
