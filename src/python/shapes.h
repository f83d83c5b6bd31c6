// SPDX-License-Identifier: BSD-3-Clause
// Shapes: the values Sphere, Box and so on of rigid_body_sim._types, and the class ConvexHull.
#pragma once

#include "errors.h"

#include "rigid_body_sim/shape.h"

namespace rbs::python {

Shape toShape(py::handle value, const std::string& path);
py::object fromShape(const Shape& shape);

void bindShapes(py::module_& module);

}  // namespace rbs::python
