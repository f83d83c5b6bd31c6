// SPDX-License-Identifier: BSD-3-Clause
#include "quantities.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rbs {
namespace {

using rigid_body_sim::Contacts;
using rigid_body_sim::IslandStatus;
using rigid_body_sim::Status;
using Values = Quantity::Values;

constexpr double kMilli = 1e3;

template <class Vector>
Values withSize(const Vector& v) {
  return {v.x, v.y, v.z, std::hypot(v.x, v.y, v.z)};
}

// Nothing is achieved while paused, which is no fall of the pace: what is not finite is not recorded.
Values paceOf(const Status& status) {
  const double achieved = status.paused ? std::numeric_limits<double>::quiet_NaN() : status.achieved_speed;
  return {status.requested_speed, achieved};
}

Values residualsOf(const Status& status) {
  Values largest(3, 0.0);
  for (const IslandStatus& island : status.residuals) {
    largest[0] = std::max(largest[0], island.signorini);
    largest[1] = std::max(largest[1], island.coulomb);
    largest[2] = std::max(largest[2], island.dissipation);
  }
  return largest;
}

// What the stages of a step do, by the beginning of their names. What is left of the step is the last curve.
struct Group {
  const char* name;
  std::vector<std::string> prefixes;
};
const std::vector<Group>& stageGroups() {
  static const std::vector<Group> groups = {{"contacts", {"contacts."}},
                                            {"narrowphase", {"narrowphase."}},
                                            {"impacts", {"impacts."}},
                                            {"broadphase", {"broadphase."}},
                                            {"motion", {"bodies.", "ballistic.", "forces.", "user_force."}}};
  return groups;
}

bool isIn(const Group& group, const std::string& stage) {
  return std::any_of(group.prefixes.begin(), group.prefixes.end(),
                     [&](const std::string& prefix) { return stage.compare(0, prefix.size(), prefix) == 0; });
}

std::vector<std::string> stageNames() {
  std::vector<std::string> names;
  for (const Group& group : stageGroups()) names.push_back(group.name);
  names.push_back("other");
  return names;
}

Values stagesOf(const Status& status) {
  Values times;
  double rest = kMilli * status.step_seconds;
  for (const Group& group : stageGroups()) {
    double sum = 0.0;
    for (const rigid_body_sim::StageStatus& stage : status.pipeline)
      if (isIn(group, stage.name)) sum += kMilli * stage.seconds;
    times.push_back(sum);
    rest -= sum;
  }
  times.push_back(std::max(0.0, rest));
  return times;
}

// The impulse on body b has the direction of the normal; a feels the opposite.
Values contactImpulses(const Contacts& contacts, const std::string& body) {
  geometry_msgs::Vector3 sum;
  for (const rigid_body_sim::Contact& contact : contacts.contacts) {
    if (contact.body_a != body && contact.body_b != body) continue;
    const double sign = contact.body_b == body ? 1.0 : -1.0;
    sum.x += sign * (contact.normal_impulse * contact.normal.x + contact.friction_impulse.x);
    sum.y += sign * (contact.normal_impulse * contact.normal.y + contact.friction_impulse.y);
    sum.z += sign * (contact.normal_impulse * contact.normal.z + contact.friction_impulse.z);
  }
  return withSize(sum);
}

Quantity ofStatus(const char* name, const char* unit, std::vector<std::string> curves, const char* tip,
                  Values (*read)(const Status&), Quantity::Scale scale = Quantity::Scale::Linear) {
  Quantity quantity{name, unit, std::move(curves), tip, scale};
  quantity.of_status = read;
  return quantity;
}

Quantity ofBody(const char* name, const char* unit, std::vector<std::string> curves, const char* tip,
                Values (*read)(const geometry_msgs::Pose&, const geometry_msgs::Twist&)) {
  Quantity quantity{name, unit, std::move(curves), tip};
  quantity.of_state = read;
  return quantity;
}

std::vector<Quantity> makeQuantities() {
  using geometry_msgs::Pose;
  using geometry_msgs::Twist;
  const std::vector<std::string> vector = {"x", "y", "z", "size"};
  std::vector<Quantity> all = {
      ofStatus("energy", "J", {"kinetic", "potential", "total"},
               "Kinetic and potential energy; the potential one is zero at the origin",
               [](const Status& s) -> Values {
                 return {s.kinetic_energy, s.potential_energy, s.kinetic_energy + s.potential_energy};
               }),
      ofStatus("real-time factor", "", {"requested", "achieved"},
               "Simulated time over wall time; 0 is requested for as fast as possible", paceOf),
      ofStatus("step time", "ms", {"wall", "CPU"}, "Time that the last step took",
               [](const Status& s) -> Values {
                 return {kMilli * s.step_seconds, kMilli * s.step_cpu_seconds};
               }),
      ofStatus("stage times", "ms", stageNames(),
               "Wall time of the stages of the last step, one on the other", stagesOf,
               Quantity::Scale::Stacked),
      ofStatus("momentum", "kg m/s", vector, "Sum over all bodies, in world",
               [](const Status& s) { return withSize(s.momentum); }),
      ofStatus("angular momentum", "kg m²/s", vector, "Sum over all bodies, about the origin of world",
               [](const Status& s) { return withSize(s.angular_momentum); }),
      ofStatus("deepest penetration", "mm", {"depth"}, "At the end of the last step",
               [](const Status& s) -> Values { return {kMilli * s.deepest_penetration}; }),
      ofStatus("solver residuals", "", {"Signorini", "Coulomb", "dissipation"},
               "Largest over the islands that ~status lists, without a dimension", residualsOf,
               Quantity::Scale::Logarithmic),
      ofStatus("contacts", "", {"contact points"}, "Contact points, also those that nearly touch",
               [](const Status& s) -> Values { return {double(s.contacts)}; }),
      ofStatus("impacts", "", {"impacts"}, "Impacts of the last step, located in time",
               [](const Status& s) -> Values { return {double(s.impacts)}; }),
      ofBody("height", "m", {"z"}, "Height of the centre of mass in world",
             [](const Pose& pose, const Twist&) -> Values { return {pose.position.z}; }),
      ofBody("position", "m", {"x", "y", "z"}, "Place of the centre of mass in world",
             [](const Pose& pose, const Twist&) -> Values {
               return {pose.position.x, pose.position.y, pose.position.z};
             }),
      ofBody("speed", "m/s", {"speed"}, "Size of the velocity of the centre of mass",
             [](const Pose&, const Twist& twist) -> Values {
               return {std::hypot(twist.linear.x, twist.linear.y, twist.linear.z)};
             }),
      ofBody("angular velocity", "rad/s", vector, "In world",
             [](const Pose&, const Twist& twist) { return withSize(twist.angular); }),
  };
  Quantity force{"contact force", "N", vector,
                 "Sum over all contacts of a step: impulse over its length, in world. With ~contacts_rate 0 "
                 "of every step, "
                 "else of ten steps a second"};
  force.of_contacts = contactImpulses;
  all.push_back(force);
  return all;
}

}  // namespace

const std::vector<Quantity>& quantities() {
  static const std::vector<Quantity> all = makeQuantities();
  return all;
}

const Quantity* findQuantity(const std::string& name) {
  for (const Quantity& quantity : quantities())
    if (quantity.name == name) return &quantity;
  return nullptr;
}

}  // namespace rbs
