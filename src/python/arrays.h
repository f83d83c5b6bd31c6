// SPDX-License-Identifier: BSD-3-Clause
// Arrays: views into the states and contact points of a world at one instant. Nothing is copied: an array keeps
// the memory alive that it shows, and cannot be written.
#pragma once

#include "errors.h"

#include "rigid_body_sim/snapshot.h"

#include <pybind11/numpy.h>

#include <memory>
#include <vector>

namespace rbs::python {

/// Memory that arrays share and never change.
using States = std::shared_ptr<const std::vector<BodyState>>;
using Contacts = std::shared_ptr<const std::vector<ContactPoint>>;

/// Numbers of a body in a row of states: position, orientation [x, y, z, w], velocity, angular velocity.
inline constexpr int kStateLength = 13;
/// The first of them.
inline const double* rowOf(const BodyState& state) {
  return state.pose.p_WB.data();
}

/// Columns of states, (n, last - first); a single one is still a column.
py::array columnsOf(const States& states, int first, int last);
/// (n,) handles.
py::array idsOf(const States& states);
/// (m,) structured.
py::array arrayOf(const Contacts& contacts);

/// Adds to a class the arrays of the states that `states(self)` gives. Self is a pointer to the class, or its holder.
template <class Self, class Class, class Get>
void bindStateArrays(Class& type, const Get& states, const std::string& moment) {
  const auto add = [&](const char* name, int first, int last, const std::string& what) {
    const std::string doc = what + "\n\n" + moment;
    type.def_property_readonly(
        name, [=](const Self& self) { return columnsOf(states(self), first, last); }, doc.c_str());
  };
  add("states", 0, kStateLength,
      "(n, 13) all that follows in a row a body: position, orientation, velocity, angular velocity.");
  add("positions", 0, 3, "(n, 3) of the centres of mass, in W, m.");
  add("orientations", 3, 7, "(n, 4) unit quaternions [x, y, z, w] that rotate vectors from B to W.");
  add("velocities", 7, 10, "(n, 3) linear velocities of the centres of mass, in W, m/s.");
  add("angular_velocities", 10, kStateLength, "(n, 3) in W, rad/s.");
  const std::string doc =
      "(n,) handles of the bodies, ascending, uint64. np.searchsorted(ids, handle) is the place of a "
      "body.\n\n" +
      moment;
  type.def_property_readonly(
      "ids", [=](const Self& self) { return idsOf(states(self)); }, doc.c_str());
}

}  // namespace rbs::python
