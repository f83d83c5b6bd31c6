// SPDX-License-Identifier: BSD-3-Clause
// Which body's marker a pixel of the view shows.
#pragma once

#include <rviz/selection/forwards.h>

#include <cstdint>
#include <optional>
#include <string>

namespace rviz {
class DisplayContext;
class MarkerSelectionHandler;
class ViewportMouseEvent;
}  // namespace rviz

namespace rbs {

struct PickedMarker {
  rviz::MarkerSelectionHandler* handler;  ///< valid until RViz draws the next picture
  std::string node;                       ///< of the simulator, as the marker's namespace says
  std::uint64_t id;                       ///< lower 31 bits of the body's
};

/// What is drawn at the event's pixel, if it is the marker of a body, as `simulator_node` publishes them, and
/// not an interactive marker. Costs a drawing of the scene into one pixel.
std::optional<PickedMarker> pickMarker(rviz::DisplayContext& context, const rviz::ViewportMouseEvent& event);

}  // namespace rbs
