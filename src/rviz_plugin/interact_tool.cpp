// SPDX-License-Identifier: BSD-3-Clause
#include "interact_tool.h"

#include "bodies_display.h"
#include "picked_body.h"
#include "simulation_panel.h"

#include <rviz/display_context.h>
#include <rviz/load_resource.h>
#include <rviz/render_panel.h>
#include <rviz/selection/selection_handler.h>
#include <rviz/selection/selection_manager.h>
#include <rviz/viewport_mouse_event.h>
#include <rviz/window_manager_interface.h>
#include <pluginlib/class_list_macros.hpp>

#include <QApplication>
#include <QPointer>

namespace rbs {

void InteractTool::onInitialize() {
  mouse_ = boost::make_shared<BodyMouse>(*context_);
  setIcon(rviz::loadPixmap("package://rviz/icons/classes/Interact.png"));
  rviz::InteractionTool::onInitialize();
}

void InteractTool::deactivate() {
  mouse_->cancel();
  hover(nullptr);
  rviz::InteractionTool::deactivate();
}

// RViz looks for what is under the mouse once a picture. A press looks anew: in a slow picture the mouse may
// have come from somewhere else since.
int InteractTool::processMouseEvent(rviz::ViewportMouseEvent& event) {
  if (event.panel->contextMenuVisible()) return 0;
  const bool is_press = event.type == QEvent::MouseButtonPress && event.buttons_down == event.acting_button;
  if (is_press) last_selection_frame_count_ = 0;
  const bool is_free = is_press || (event.type == QEvent::MouseMove && event.buttons_down == Qt::NoButton);
  if (is_free && context_->getFrameCount() > last_selection_frame_count_) aim(event);

  if (is_press && event.left() && event.control()) return toggle(event), 0;
  const int flags = rviz::InteractionTool::processMouseEvent(event);

  if (is_press) {
    missed_ = focused_object_.expired();
    pressed_at_ = QPoint(event.x, event.y);
  }
  if (missed_ && event.left()) context_->setStatus(nothing_there_);
  if (missed_ && event.leftUp()) finishMiss(QPoint(event.x, event.y));
  return flags;
}

// Where the view shows something else, such as a click target of an interactive marker, the simulator says which
// body is there.
void InteractTool::toggle(const rviz::ViewportMouseEvent& event) {
  QWidget* const window = context_->getWindowManager()->getParentWindow();
  if (const std::optional<PickedBody> picked = pickBody(*context_, event)) {
    const rigid_body_sim::BodyDescription* const body = bodiesOf(picked->node)->find(picked->id);
    if (body) SimulationPanel::toggleSelected(window, picked->node, QString::fromStdString(body->name));
    return;
  }
  // The first simulator in the order of the panels, whichever answers first.
  const std::vector<std::string> nodes = SimulationPanel::nodes(window);
  struct Answers {
    std::vector<std::optional<QString>> names;
    std::size_t came = 0;
  };
  const auto answers = std::make_shared<Answers>();
  answers->names.resize(nodes.size());
  for (std::size_t k = 0; k < nodes.size(); ++k)
    askBodyUnder(
        event, *context_, *bodiesOf(nodes[k]),
        [window = QPointer<QWidget>(window), nodes, answers, k](const SimulatorBodies::Answer& answer) {
          if (answer.met) answers->names[k] = QString::fromStdString(answer.met->body.description.name);
          if (++answers->came < nodes.size() || window.isNull()) return;
          for (std::size_t n = 0; n < nodes.size(); ++n)
            if (answers->names[n])
              return SimulationPanel::toggleSelected(window, nodes[n], *answers->names[n]);
        });
}

// Before each picture: the bodies of a simulator are to be known before the mouse is over one of them.
void InteractTool::update(float, float) {
  for (const std::string& node : SimulationPanel::nodes(context_->getWindowManager()->getParentWindow()))
    bodiesOf(node);
}

void InteractTool::aim(const rviz::ViewportMouseEvent& event) {
  nothing_there_ = "There is no body here: the mouse turns the view.";
  for (const rviz::CollObjectHandle cover : covers_)
    if (rviz::SelectionHandler* const handler = context_->getSelectionManager()->getHandler(cover))
      handler->setInteractiveObject(rviz::InteractiveObjectWPtr());
  covers_.clear();
  const std::optional<PickedBody> picked = pickBody(*context_, event);
  const bool takes_drags = picked && aimAt(*picked);
  hover(takes_drags ? &*picked : nullptr);
}

// Makes the body under the mouse take the mouse in the way of RViz's interactive objects. Whether it is one that a
// drag moves.
bool InteractTool::aimAt(const PickedBody& picked) {
  picked.handler->setInteractiveObject(rviz::InteractiveObjectWPtr());
  const std::shared_ptr<SimulatorBodies> simulator = bodiesOf(picked.node);
  const QString node = QString::fromStdString(picked.node);
  const rigid_body_sim::BodyDescription* const body = simulator->find(picked.id);
  if (!body) {
    nothing_there_ =
        QString("%1 has not sent the description of this body yet: the mouse turns the view.").arg(node);
    return false;
  }
  if (body->shape == "plane") {
    nothing_there_ = QString("'%1' is a plane, which cannot be dragged: the mouse turns the view.")
                         .arg(QString::fromStdString(body->name));
    return false;
  }
  mouse_->aim(simulator, *body, picked.position, picked.orientation);
  picked.handler->setInteractiveObject(mouse_);
  // RViz looks by itself for what is under the mouse, and finds what covers the body.
  for (const rviz::CollObjectHandle cover : picked.covers)
    if (rviz::SelectionHandler* const handler = context_->getSelectionManager()->getHandler(cover))
      handler->setInteractiveObject(mouse_);
  covers_ = picked.covers;
  return !isSeeThrough(*body);
}

// What would take a drag is brighter.
void InteractTool::hover(const PickedBody* picked) {
  for (BodiesDisplay* const display : BodiesDisplay::allIn(*context_)) {
    const bool has_it = picked && display->node() == picked->node;
    display->setHovered(has_it ? std::make_optional(picked->id) : std::nullopt);
  }
}

std::shared_ptr<SimulatorBodies> InteractTool::bodiesOf(const std::string& node) {
  std::shared_ptr<SimulatorBodies>& bodies = simulators_[node];
  if (!bodies) bodies = std::make_shared<SimulatorBodies>(node);
  return bodies;
}

// A click that has not turned the view drops the selection.
void InteractTool::finishMiss(const QPoint& released_at) {
  missed_ = false;
  if ((released_at - pressed_at_).manhattanLength() > QApplication::startDragDistance()) return;
  SimulationPanel::dropSelections(context_->getWindowManager()->getParentWindow(), nothing_there_);
}

}  // namespace rbs

PLUGINLIB_EXPORT_CLASS(rbs::InteractTool, rviz::Tool)
