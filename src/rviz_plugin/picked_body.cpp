// SPDX-License-Identifier: BSD-3-Clause
#include "picked_body.h"

#include "body_handler.h"

#include <rviz/default_plugin/markers/marker_selection_handler.h>
#include <rviz/display_context.h>
#include <rviz/interactive_object.h>
#include <rviz/properties/property.h>
#include <rviz/selection/selection_manager.h>
#include <rviz/viewport_mouse_event.h>

#include <QRegularExpression>

namespace rbs {
namespace {

// A marker has its namespace and id only in the properties that RViz shows of what is selected. They are
// made here, read and taken away again. Those of a marker that is selected now are in use: it is deselected
// first.
QString titleOf(rviz::SelectionManager& manager, rviz::SelectionHandler& handler,
                const rviz::Picked& picked) {
  const rviz::M_Picked& selected = manager.getSelection();
  if (const auto it = selected.find(picked.handle); it != selected.end()) {
    manager.removeSelection({{it->first, it->second}});
  }
  rviz::Property parent;
  handler.createProperties(picked, &parent);
  const QString title = parent.numChildren() > 0 ? parent.childAt(0)->getName() : QString();
  handler.destroyProperties(picked, &parent);
  return title;
}

std::optional<PickedBody> bodyOf(BodyHandler& handler) {
  return PickedBody{&handler, handler.node(), handler.body().id & kLowId, handler.position(),
                    handler.orientation()};
}

// The namespace of a marker names the node.
std::optional<PickedBody> bodyOf(rviz::SelectionManager& manager, rviz::MarkerSelectionHandler& handler,
                                 const rviz::Picked& picked) {
  static const QRegularExpression kTitle("^Marker (/.+)/bodies(_dark)?/(\\d+)$");
  const QRegularExpressionMatch match = kTitle.match(titleOf(manager, handler, picked));
  if (!match.hasMatch()) return std::nullopt;
  return PickedBody{&handler, match.captured(1).toStdString(), match.captured(3).toULongLong(),
                    handler.getPosition(), handler.getOrientation()};
}

}  // namespace

std::optional<PickedBody> pickBody(rviz::DisplayContext& context, const rviz::ViewportMouseEvent& event) {
  rviz::SelectionManager& manager = *context.getSelectionManager();
  rviz::M_Picked results;
  manager.pick(event.viewport, event.x, event.y, event.x + 1, event.y + 1, results, true);
  if (results.empty()) return std::nullopt;
  const rviz::Picked& picked = results.begin()->second;
  rviz::SelectionHandler* const handler = manager.getHandler(picked.handle);
  if (auto* const body = dynamic_cast<BodyHandler*>(handler)) return bodyOf(*body);
  if (auto* const marker = dynamic_cast<rviz::MarkerSelectionHandler*>(handler))
    return bodyOf(manager, *marker, picked);
  return std::nullopt;
}

}  // namespace rbs
