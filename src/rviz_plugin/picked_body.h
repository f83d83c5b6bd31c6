// SPDX-License-Identifier: BSD-3-Clause
// Which drawn body a pixel of the view shows.
#pragma once

#include <OgreQuaternion.h>
#include <OgreVector3.h>
#include <rviz/selection/forwards.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace rviz {
class DisplayContext;
class SelectionHandler;
class ViewportMouseEvent;
}  // namespace rviz

namespace rbs {

struct PickedBody {
  rviz::SelectionHandler* handler;  ///< valid until RViz draws the next picture
  std::string node;                 ///< of the simulator
  std::uint64_t id;                 ///< lower 31 bits of the body's
  Ogre::Vector3 position;           ///< where it is drawn, in RViz's fixed frame, m
  Ogre::Quaternion orientation;
  std::vector<rviz::CollObjectHandle> covers;  ///< bodies of a reference run that are drawn before it
};

/// What is drawn at the event's pixel, if it is a body, by the Bodies display or as the marker that
/// `simulator_node` publishes of it, and not an interactive marker. Up to 16 bodies of a reference run are looked
/// through. Costs a drawing of the scene into one pixel, and one more for each of them.
std::optional<PickedBody> pickBody(rviz::DisplayContext& context, const rviz::ViewportMouseEvent& event);

}  // namespace rbs
