// SPDX-License-Identifier: BSD-3-Clause
#include "stale_markers.h"

#include <rviz/display_context.h>
#include <rviz/display_group.h>

namespace rbs {
namespace {

void resetMarkers(rviz::DisplayGroup& group, const QString& topics) {
  for (int k = 0; k < group.numDisplays(); ++k) {
    rviz::Display* const display = group.getDisplayAt(k);
    if (auto* const inner = qobject_cast<rviz::DisplayGroup*>(display)) {
      resetMarkers(*inner, topics);
    } else if (display->getClassId() == "rviz/InteractiveMarkers" && display->isEnabled() &&
               display->subProp("Update Topic")->getValue().toString().startsWith(topics)) {
      display->reset();
    }
  }
}

}  // namespace

void dropMarkersOf(const std::string& node, rviz::DisplayContext& context) {
  if (!node.empty()) resetMarkers(*context.getRootDisplayGroup(), QString::fromStdString(node + "/"));
}

}  // namespace rbs
