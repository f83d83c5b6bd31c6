// SPDX-License-Identifier: BSD-3-Clause
#include "errors.h"

#include "rigid_body_sim/quote.h"

#include <exception>

namespace rbs::python {
namespace {

py::tuple problemsOf(const InvalidInput& error) {
  const py::object type = typeNamed("Problem");
  py::tuple problems(error.problems().size());
  for (std::size_t k = 0; k < error.problems().size(); ++k) {
    const Problem& problem = error.problems()[k];
    problems[k] = type(problem.path, problem.value, problem.allowed);
  }
  return problems;
}

void translate(std::exception_ptr thrown) {
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const InvalidInput& error) {
    const py::object type = typeNamed("InvalidInput");
    PyErr_SetObject(type.ptr(), type(error.what(), problemsOf(error)).ptr());
  }
}

// Of a class bound by this module: its fields are properties that can be set.
bool isField(py::handle type, py::handle name) {
  const py::object attribute = type.attr("__dict__").attr("get")(name);
  return PyObject_TypeCheck(attribute.ptr(), &PyProperty_Type) && !attribute.attr("fset").is_none();
}

}  // namespace

py::object typeNamed(const char* name) {
  return py::module_::import("rigid_body_sim._types").attr(name);
}

void refuse(const std::string& path, const std::string& value, const std::string& allowed) {
  throw InvalidInput({{path, value, allowed}});
}

std::string fieldsOf(py::handle type) {
  std::string text = "a field of " + type.attr("__name__").cast<std::string>();
  const char* separator = ": ";
  for (const py::handle name : py::module_::import("builtins").attr("sorted")(type.attr("__dict__"))) {
    if (!isField(type, name)) continue;
    text += separator + name.cast<std::string>();
    separator = ", ";
  }
  return text;
}

void setField(py::handle self, py::handle name, py::handle value) {
  const py::object type = py::type::of(self);
  if (!isField(type, name)) refuse(name.cast<std::string>(), textOf(value), fieldsOf(type));
  py::setattr(self, name, value);
}

std::string textOf(py::handle value) {
  return printable(py::repr(value).cast<std::string>());
}

void bindErrors(py::module_&) {
  py::register_exception_translator(&translate);
}

}  // namespace rbs::python
