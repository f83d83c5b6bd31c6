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

}  // namespace

py::object typeNamed(const char* name) {
  return py::module_::import("rigid_body_sim._types").attr(name);
}

void refuse(const std::string& path, const std::string& value, const std::string& allowed) {
  throw InvalidInput({{path, value, allowed}});
}

std::string textOf(py::handle value) {
  return printable(py::repr(value).cast<std::string>());
}

void bindErrors(py::module_&) {
  py::register_exception_translator(&translate);
}

}  // namespace rbs::python
