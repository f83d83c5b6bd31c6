// SPDX-License-Identifier: BSD-3-Clause
#include "settings.h"

#include "values.h"

#include <pybind11/stl.h>

namespace rbs::python {
namespace {

void require(py::handle value, const char* type, const std::string& path, const std::string& allowed) {
  if (!py::isinstance(value, typeNamed(type))) refuse(path, textOf(value), allowed);
}

double field(py::handle value, const char* name, const std::string& path) {
  return toNumber(value.attr(name), path + "." + name);
}
std::optional<double> optionalField(py::handle value, const char* name, const std::string& path) {
  return toOptional(value.attr(name), path + "." + name, toNumber);
}
Vec3 vectorField(py::handle value, const char* name, const std::string& path) {
  return toVec3(value.attr(name), path + "." + name);
}

py::tuple tupleOf(const Vec3& v) {
  return py::make_tuple(v.x(), v.y(), v.z());
}

}  // namespace

Setting toSetting(py::handle value, const std::string& path) {
  if (py::isinstance<py::str>(value)) return fidelityNamed(toText(value, path));
  require(value, "Setting", path, "a Setting, or preview, interactive, accurate or reference");
  Setting setting = fidelityNamed(toText(value.attr("preset"), path + ".preset"));
  setting.divisions = static_cast<std::uint32_t>(
      toWhole(value.attr("divisions"), path + ".divisions", 1, Limits::max_divisions));
  const py::object sub_steps = value.attr("sub_steps");
  if (!sub_steps.is_none())
    setting.sub_steps =
        static_cast<std::uint32_t>(toWhole(sub_steps, path + ".sub_steps", 1, Limits::max_sub_steps));
  setting.tolerance = optionalField(value, "tolerance", path);
  setting.max_solve_ms = optionalField(value, "max_solve_ms", path);
  return setting;
}

Goal toGoal(py::handle value, const std::string& path) {
  require(value, "Goal", path, "a Goal, or None");
  return {optionalField(value, "max_error", path), optionalField(value, "max_step_ms", path)};
}

Air toAir(py::handle value, const std::string& path) {
  require(value, "Air", path, "an Air, or None");
  return {field(value, "density", path)};
}

Wind toWind(py::handle value, const std::string& path) {
  require(value, "Wind", path, "a Wind, or None");
  return {vectorField(value, "velocity", path), field(value, "gust", path)};
}

Fluid toFluid(py::handle value, const std::string& path) {
  require(value, "Fluid", path, "a Fluid, or None");
  return {field(value, "density", path), field(value, "level", path)};
}

View toView(py::handle value, const std::string& path) {
  require(value, "View", path, "a View");
  return {vectorField(value, "eye", path), vectorField(value, "target", path)};
}

EffectOverrides toEffects(py::handle value, const std::string& path) {
  if (!py::isinstance<py::dict>(value))
    refuse(path, textOf(value), "a dictionary of names of effects to True or False");
  EffectOverrides effects;
  for (const auto& [name, on] : value.cast<py::dict>()) {
    const Effect effect = effectNamed(toText(name, path));
    if (!py::isinstance<py::bool_>(on)) refuse(path + "." + effectName(effect), textOf(on), "True or False");
    effects[effect] = on.cast<bool>();
  }
  return effects;
}

py::object fromSetting(const Setting& s) {
  return typeNamed("Setting")(fidelityName(s.preset), s.divisions, s.sub_steps, s.tolerance, s.max_solve_ms);
}
py::object fromGoal(const std::optional<Goal>& goal) {
  return goal ? typeNamed("Goal")(goal->max_error, goal->max_step_ms) : py::none();
}
py::object fromAir(const std::optional<Air>& air) {
  return air ? typeNamed("Air")(air->density) : py::none();
}
py::object fromWind(const std::optional<Wind>& wind) {
  return wind ? typeNamed("Wind")(tupleOf(wind->velocity), wind->gust) : py::none();
}
py::object fromFluid(const std::optional<Fluid>& fluid) {
  return fluid ? typeNamed("Fluid")(fluid->density, fluid->level) : py::none();
}
py::object fromView(const View& view) {
  return typeNamed("View")(tupleOf(view.eye), tupleOf(view.target));
}
py::dict fromEffects(const EffectOverrides& effects) {
  py::dict result;
  for (const auto& [effect, on] : effects) result[effectName(effect)] = on;
  return result;
}

}  // namespace rbs::python
