// SPDX-License-Identifier: BSD-3-Clause
// Body: the definition of a body. Its fields have the names of the keys of scene files.
#pragma once

#include "errors.h"

#include "rigid_body_sim/scene.h"

#include <vector>

namespace rbs::python {

BodyKind toKind(py::handle value, const std::string& path);
std::uint32_t toBits(py::handle value, const std::string& path);

/// The definitions of a sequence of Body.
std::vector<BodyDef> toBodies(py::handle bodies, const std::string& path);
/// A list of new Body.
py::list fromBodies(std::vector<BodyDef> bodies);

void bindBody(py::module_& module);

}  // namespace rbs::python
