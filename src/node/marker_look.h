// SPDX-License-Identifier: BSD-3-Clause
// The look of a body as RViz markers: all but where the body is.
#pragma once

#include <visualization_msgs/MarkerArray.h>

#include <string>
#include <vector>

#include "rigid_body_sim/snapshot.h"

namespace rbs {

struct MarkerLook {
  std::string ns;       ///< of its markers
  std::string frame;    ///< the world, or the frame of the body, to which the marker is then locked
  bool is_mesh = true;  ///< else, where RViz has one, its own sphere, cube or cylinder
  Shape shape;
  double plane_side = 0.0;  ///< of the square that stands for a plane, m; 0 for another shape
  Color color{};
};

bool operator==(const MarkerLook& a, const MarkerLook& b);

/// The look of a body in this namespace and frame, for a scene with this view.
MarkerLook lookOf(const BodyDescription& body, const std::string& ns, const std::string& frame, bool is_mesh,
                  const View& view);

/// Smallest extent that is drawn, m.
double drawnSize(const MarkerLook& look);

/// The markers of a body at `pose`, one a tone, in the namespaces `look.ns` and `look.ns`_dark; the id is the
/// lower 31 bits of the body's. Their (ns, id) stay the same while the body lives.
std::vector<visualization_msgs::Marker> markersOf(BodyId id, const MarkerLook& look, const Pose& pose);

/// The surface of a fluid, as wide as a scene with this view needs it, in this namespace.
visualization_msgs::Marker waterMarker(const Fluid& fluid, const std::string& ns, const View& view);

/// The message that takes this marker away.
visualization_msgs::Marker removalOf(const visualization_msgs::Marker& marker);

}  // namespace rbs
