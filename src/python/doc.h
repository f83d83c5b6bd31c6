// SPDX-License-Identifier: BSD-3-Clause
// Doc: the docstring of a function, which begins with its signature as inspect and help() read it.
#pragma once

#include <pybind11/pybind11.h>

#include <string>
#include <utility>

namespace rbs::python {

/// The docstring of a function, the last of its attributes. Its signature is made of the py::arg before it.
class Doc {
 public:
  explicit Doc(std::string text) : text_(std::move(text)) {}

  /// Puts the signature in front, which CPython finds by the line "--".
  void document(pybind11::detail::function_record& function) const {
    std::string arguments;
    const auto add = [&](const std::string& argument) {
      arguments += (arguments.empty() ? "" : ", ") + argument;
    };
    if (function.is_method && function.args.empty()) add("self");
    for (const auto& argument : function.args)
      add(argument.name + (argument.value ? "=" + pybind11::repr(argument.value).cast<std::string>() : ""));
    if (function.has_kwargs) add("**fields");
    text_ = std::string(function.name) + "(" + arguments + ")\n--\n\n" + text_;
    function.doc = text_.data();
  }

 private:
  mutable std::string text_;  // until pybind11 has copied it
};

}  // namespace rbs::python

namespace pybind11::detail {

template <>
struct process_attribute<rbs::python::Doc> : process_attribute_default<rbs::python::Doc> {
  static void init(const rbs::python::Doc& doc, function_record* function) { doc.document(*function); }
};

}  // namespace pybind11::detail
