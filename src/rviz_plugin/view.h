// SPDX-License-Identifier: BSD-3-Clause
// Where RViz looks from.
#pragma once

#include <geometry_msgs/Point.h>
#include <rviz/view_controller.h>

namespace rbs {

/// Turns an orbit view to look from `eye` at `target`, m, in the view's target frame. Leaves any other kind
/// of view, and one whose eye is at its target, as it is.
void lookFrom(rviz::ViewController& view, const geometry_msgs::Point& eye,
              const geometry_msgs::Point& target);

}  // namespace rbs
