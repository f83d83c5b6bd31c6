// SPDX-License-Identifier: BSD-3-Clause
// Quantities: what can be plotted, as a table, and how each is read from a message.
#pragma once

#include <geometry_msgs/Pose.h>
#include <geometry_msgs/Twist.h>
#include <rigid_body_sim/Contacts.h>
#include <rigid_body_sim/Status.h>

#include <string>
#include <vector>

namespace rbs {

/// A quantity of the whole simulation, or of a body.
struct Quantity {
  enum class Scale {
    Linear,
    Logarithmic,  ///< for numbers of very different size; 0 is drawn at the lower end
    Stacked,      ///< one curve on the other: their sum is seen
  };
  using Values = std::vector<double>;  ///< one for each curve

  std::string name;                 ///< in the menu, the layout and the table of numbers
  std::string unit;                 ///< empty: a mere number
  std::vector<std::string> curves;  ///< their names
  std::string tip;                  ///< one sentence about what it is
  Scale scale = Scale::Linear;
  /// One of the three reads it; the others are null. Contacts are read for a body of a name, as impulses, N s.
  Values (*of_status)(const rigid_body_sim::Status&) = nullptr;
  Values (*of_state)(const geometry_msgs::Pose&, const geometry_msgs::Twist&) = nullptr;
  Values (*of_contacts)(const rigid_body_sim::Contacts&, const std::string& body) = nullptr;

  bool isOfBody() const { return of_status == nullptr; }
};

/// All quantities, in the order of the menu: first those of the simulation, then those of a body.
const std::vector<Quantity>& quantities();
/// The quantity of this name; null for an unknown one.
const Quantity* findQuantity(const std::string& name);

}  // namespace rbs
