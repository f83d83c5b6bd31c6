// SPDX-License-Identifier: BSD-3-Clause
// The looks of the interactive markers of one body: what to click, the gizmo, the handles of its faces.
//
// They are in the world frame with no stamp, so that RViz answers in the world frame whatever its own fixed
// frame is, and needs no tf.
#pragma once

#include <visualization_msgs/InteractiveMarker.h>

#include <string>

#include "menu_titles.h"
#include "rigid_body_sim/snapshot.h"

namespace rbs {

// No body's name has a dot, so these are never the name of one.
inline constexpr int kFaces = 6;
inline constexpr const char* kGizmoName = "selection.gizmo";
/// Name of the handle of face 0 to 5: +x, -x, +y, -y, +z, -z of the body.
std::string handleName(int face);
/// The face of a handle by its marker's name, or -1.
int handleFace(const std::string& marker_name);
/// Whether a marker of this name is the gizmo or a handle of the selected body.
bool isOfSelection(const std::string& marker_name);
/// Outward normal of a face in B.
Vec3 faceNormal(int face);

/// An invisible shape just outside the body, named after it, with its menu, whose entries are for the bodies of `scope`. It moves in
/// the plane of the view. Of a plane only a patch at its origin can be clicked, or the camera could not be turned with the
/// mouse on the floor. The patch is sized for `view`.
visualization_msgs::InteractiveMarker clickTarget(const BodyDescription& body, const Pose& pose,
                                                  const View& view, const MenuScope& scope);

/// Three arrows and three rings around the body, along its axes.
visualization_msgs::InteractiveMarker gizmo(const BodyDescription& body, const Pose& pose, const View& view);

/// A cube in front of the body on one side, to be dragged along the normal.
visualization_msgs::InteractiveMarker faceHandle(const BodyDescription& body, const Pose& pose, int face);

}  // namespace rbs
