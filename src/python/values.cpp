// SPDX-License-Identifier: BSD-3-Clause
#include "values.h"

namespace rbs::python {
namespace {

using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// `count` numbers in a row.
Numbers row(py::handle value, const std::string& path, py::ssize_t count, const char* allowed) {
  Numbers numbers = py::isinstance<py::str>(value) ? Numbers{} : Numbers::ensure(value);
  if (!numbers) refuse(path, textOf(value), allowed);
  if (numbers.ndim() != 1 || numbers.size() != count)
    refuse(path, "shape " + py::repr(numbers.attr("shape")).cast<std::string>(), allowed);
  return numbers;
}

}  // namespace

double toNumber(py::handle value, const std::string& path) {
  const double number = PyFloat_AsDouble(value.ptr());
  if (PyErr_Occurred() == nullptr) return number;
  PyErr_Clear();
  refuse(path, textOf(value), "a number");
}

std::uint64_t toWhole(py::handle value, const std::string& path, std::uint64_t low, std::uint64_t high) {
  const auto whole = py::reinterpret_steal<py::object>(PyNumber_Index(value.ptr()));
  const std::uint64_t number = whole ? PyLong_AsUnsignedLongLong(whole.ptr()) : 0;
  const bool failed = PyErr_Occurred() != nullptr;
  PyErr_Clear();
  if (!failed && number >= low && number <= high) return number;
  refuse(path, textOf(value), "a whole number, " + std::to_string(low) + " to " + std::to_string(high));
}

std::string toText(py::handle value, const std::string& path) {
  if (!py::isinstance<py::str>(value)) refuse(path, textOf(value), "a text");
  Py_ssize_t size = 0;
  const char* const text = PyUnicode_AsUTF8AndSize(value.ptr(), &size);
  PyErr_Clear();
  if (!text) refuse(path, textOf(value), "a text of Unicode characters");
  return {text, static_cast<std::size_t>(size)};
}

std::string toPath(py::handle value) {
  const auto path = py::reinterpret_steal<py::object>(PyOS_FSPath(value.ptr()));
  const bool is_text = path && py::isinstance<py::str>(path);
  // Python writes bytes of a file name that are no UTF-8 as lone surrogates.
  const auto bytes =
      py::reinterpret_steal<py::bytes>(is_text ? PyUnicode_EncodeFSDefault(path.ptr()) : nullptr);
  PyErr_Clear();
  if (!bytes) refuse("path", textOf(value), "the path of a file");
  return bytes;
}

Vec3 toVec3(py::handle value, const std::string& path) {
  const Numbers numbers = row(value, path, 3, "three numbers [x, y, z]");
  return {numbers.at(0), numbers.at(1), numbers.at(2)};
}

Quat toQuat(py::handle value, const std::string& path) {
  const Numbers numbers = row(value, path, 4, "four numbers [x, y, z, w]");
  return {numbers.at(3), numbers.at(0), numbers.at(1), numbers.at(2)};
}

Color toColor(py::handle value, const std::string& path) {
  const char* const allowed = "three or four numbers: red, green, blue and alpha, each 0 to 1";
  const bool with_alpha = py::isinstance<py::sequence>(value) && py::len(value) == 4;
  const Numbers numbers = row(value, path, with_alpha ? 4 : 3, allowed);
  Color color{0.0f, 0.0f, 0.0f, 1.0f};
  for (py::ssize_t k = 0; k < numbers.size(); ++k)
    color[static_cast<std::size_t>(k)] = static_cast<float>(numbers.at(k));
  return color;
}

py::array_t<double> fromVec3(const Vec3& v) {
  return py::array_t<double>(3, v.data());
}
py::array_t<double> fromQuat(const Quat& q) {
  return py::array_t<double>(4, q.coeffs().data());
}
py::tuple fromPose(const Pose& pose) {
  return py::make_tuple(fromVec3(pose.p_WB), fromQuat(pose.q_WB));
}

py::array viewOf(Vec3& v, py::handle owner) {
  return {py::dtype::of<double>(), {3}, {sizeof(double)}, v.data(), owner};
}
py::array viewOf(Quat& q, py::handle owner) {
  return {py::dtype::of<double>(), {4}, {sizeof(double)}, q.coeffs().data(), owner};
}

}  // namespace rbs::python
