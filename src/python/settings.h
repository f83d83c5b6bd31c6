// SPDX-License-Identifier: BSD-3-Clause
// Settings and surroundings of a scene: the values Setting, Goal, Air, Wind, Fluid and View of
// rigid_body_sim._types, and effects as a dictionary.
#pragma once

#include "errors.h"

#include "rigid_body_sim/scene.h"

namespace rbs::python {

/// Of a Setting, or of the name of a quality level.
Setting toSetting(py::handle value, const std::string& path);
Goal toGoal(py::handle value, const std::string& path);
Air toAir(py::handle value, const std::string& path);
Wind toWind(py::handle value, const std::string& path);
Fluid toFluid(py::handle value, const std::string& path);
View toView(py::handle value, const std::string& path);
EffectOverrides toEffects(py::handle value, const std::string& path);

py::object fromSetting(const Setting& setting);
py::object fromGoal(const std::optional<Goal>& goal);
py::object fromAir(const std::optional<Air>& air);
py::object fromWind(const std::optional<Wind>& wind);
py::object fromFluid(const std::optional<Fluid>& fluid);
py::object fromView(const View& view);
py::dict fromEffects(const EffectOverrides& effects);

}  // namespace rbs::python
