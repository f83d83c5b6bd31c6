// SPDX-License-Identifier: BSD-3-Clause
#include "select_tool.h"

#include "bodies_display.h"
#include "body_names.h"
#include "picked_body.h"
#include "simulation_panel.h"

#include <rviz/display_context.h>
#include <rviz/load_resource.h>
#include <rviz/selection/selection_manager.h>
#include <rviz/view_manager.h>
#include <rviz/viewport_mouse_event.h>
#include <rviz/window_manager_interface.h>
#include <pluginlib/class_list_macros.hpp>

#include <QApplication>

#include <map>

namespace rbs {

SelectTool::SelectTool() {
  shortcut_key_ = 's';
}

void SelectTool::onInitialize() {
  setIcon(rviz::loadPixmap("package://rviz/icons/classes/Select.png"));
  setDescription("Selects bodies by a rectangle");
}

void SelectTool::deactivate() {
  rectangle_.reset();
  context_->getSelectionManager()->removeHighlight();
}

int SelectTool::processMouseEvent(rviz::ViewportMouseEvent& event) {
  setStatus(
      "<b>Left-Click, drag:</b> select. <b>Shift:</b> add. <b>Ctrl:</b> take away. Other buttons move the "
      "view.");
  if (event.leftDown()) rectangle_ = QRect(event.x, event.y, 1, 1);
  if (!rectangle_) {
    if (rviz::ViewController* const view = context_->getViewManager()->getCurrent())
      view->handleMouseEvent(event);
    return 0;
  }
  rectangle_->setBottomRight({event.x, event.y});
  if (event.leftUp()) {
    select(event);
    deactivate();
  } else {
    drawRectangle(event);
  }
  return Render;
}

void SelectTool::drawRectangle(const rviz::ViewportMouseEvent& event) {
  context_->getSelectionManager()->highlight(event.viewport, rectangle_->left(), rectangle_->top(),
                                             rectangle_->right(), rectangle_->bottom());
}

void SelectTool::select(const rviz::ViewportMouseEvent& event) {
  const QRect pixels = rectangle_->normalized();
  const bool is_click = pixels.width() + pixels.height() < QApplication::startDragDistance();
  std::map<std::string, QStringList> names;  // by node
  const std::optional<PickedBody> picked = is_click ? pickBody(*context_, event) : std::nullopt;
  for (BodiesDisplay* const display : BodiesDisplay::allIn(*context_)) {
    if (display->node().empty() || (picked && picked->node != display->node())) continue;
    QStringList& list = names[display->node()];
    if (is_click && !picked) continue;
    if (is_click) {
      list.append(QString::fromStdString(display->nameOf(picked->id)));
      continue;
    }
    list = toQt(display->namesIn(pixels, *event.viewport));
  }
  QWidget* const window = context_->getWindowManager()->getParentWindow();
  for (const auto& [node, list] : names) SimulationPanel::select(window, node, list, event.modifiers);
}

}  // namespace rbs

PLUGINLIB_EXPORT_CLASS(rbs::SelectTool, rviz::Tool)
