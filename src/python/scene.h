// SPDX-License-Identifier: BSD-3-Clause
// Scene: the definition of a scene, and the rest of a saved state where it is one.
#pragma once

#include "errors.h"

#include "rigid_body_sim/scenes.h"

#include <optional>
#include <string>

namespace rbs::python {

/// What Python calls a Scene. Its bodies are a list of Python, so that they can be changed in place.
struct Scene {
  SceneDef settings;                ///< without bodies
  py::list bodies;                  ///< of Body, in canonical order
  std::optional<SavedState> state;  ///< the rest of a saved state; empty: a fresh start

  Scene() = default;
  explicit Scene(SceneFile file);
  /// The scene with its bodies. Throws InvalidInput for what is no Body.
  SceneFile file() const;
};

/// Writes text to a file, all of it or nothing, without the lock of the interpreter.
void writeText(const py::object& path, const std::string& text, bool overwrite);

void bindScene(py::module_& module);

}  // namespace rbs::python
