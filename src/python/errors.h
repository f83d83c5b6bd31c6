// SPDX-License-Identifier: BSD-3-Clause
// Errors: InvalidInput of the core as rigid_body_sim.InvalidInput, a ValueError.
#pragma once

#include "doc.h"

#include "rigid_body_sim/types.h"

#include <pybind11/pybind11.h>

#include <string>

namespace rbs::python {

namespace py = pybind11;

/// A type of rigid_body_sim._types, by its name.
py::object typeNamed(const char* name);

/// Throws InvalidInput for one problem.
[[noreturn]] void refuse(const std::string& path, const std::string& value, const std::string& allowed);

/// The fields of a type that can be set, for such a message: "a field of Body: color, density, …", by name.
std::string fieldsOf(py::handle type);

/// Sets a field of an object by its name. Throws InvalidInput for a name that is none.
void setField(py::handle self, py::handle name, py::handle value);

/// What a message says of a Python value: its repr(), on one line and cut.
std::string textOf(py::handle value);

void bindErrors(py::module_& module);

}  // namespace rbs::python
