// SPDX-License-Identifier: BSD-3-Clause
// Values: numbers, vectors and poses from Python and back. What is none throws InvalidInput with its place.
#pragma once

#include "errors.h"

#include "rigid_body_sim/scene.h"

#include <pybind11/numpy.h>

#include <cstdint>
#include <limits>
#include <string>

namespace rbs::python {

inline constexpr std::uint64_t kNoLimit = std::numeric_limits<std::uint64_t>::max();

double toNumber(py::handle value, const std::string& path);
/// A whole number from `low` to `high`.
std::uint64_t toWhole(py::handle value, const std::string& path, std::uint64_t low,
                      std::uint64_t high = kNoLimit);
std::string toText(py::handle value, const std::string& path);
/// The path of a file: a text, or what os.fspath() takes.
std::string toPath(py::handle value);
Vec3 toVec3(py::handle value, const std::string& path);
/// Of [x, y, z, w].
Quat toQuat(py::handle value, const std::string& path);
/// Of three numbers, or four with alpha.
Color toColor(py::handle value, const std::string& path);

/// A new array (3,).
py::array_t<double> fromVec3(const Vec3& v);
/// A new array (4,): [x, y, z, w].
py::array_t<double> fromQuat(const Quat& q);
/// A tuple (position, orientation).
py::tuple fromPose(const Pose& pose);
/// The numbers themselves, which can be written; `owner` holds them and is kept alive.
py::array viewOf(Vec3& v, py::handle owner);
py::array viewOf(Quat& q, py::handle owner);

/// Empty for None; else what `convert(value, path)` makes of it.
template <class Convert>
auto toOptional(py::handle value, const std::string& path, const Convert& convert)
    -> std::optional<decltype(convert(value, path))> {
  if (value.is_none()) return std::nullopt;
  return convert(value, path);
}

}  // namespace rbs::python
