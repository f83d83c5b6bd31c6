// SPDX-License-Identifier: BSD-3-Clause
#include "view.h"

#include <cmath>

namespace rbs {

void lookFrom(rviz::ViewController& view, const geometry_msgs::Point& eye,
              const geometry_msgs::Point& target) {
  const double x = eye.x - target.x, y = eye.y - target.y, z = eye.z - target.z;
  const double distance = std::hypot(x, y, z);
  if (view.getClassId() != "rviz/Orbit" || distance == 0.0) return;
  rviz::Property* const focus = view.subProp("Focal Point");
  focus->subProp("X")->setValue(target.x);
  focus->subProp("Y")->setValue(target.y);
  focus->subProp("Z")->setValue(target.z);
  view.subProp("Distance")->setValue(distance);
  view.subProp("Pitch")->setValue(std::asin(z / distance));
  const double yaw = std::atan2(y, x);
  view.subProp("Yaw")->setValue(yaw < 0.0 ? yaw + 2.0 * M_PI : yaw);
}

}  // namespace rbs
