// SPDX-License-Identifier: BSD-3-Clause
// InteractTool: RViz's Interact tool, for bodies as well as for interactive markers.
#pragma once

#include "body_mouse.h"

#include <rviz/default_plugin/tools/interaction_tool.h>
#include <rviz/selection/forwards.h>

#include <QPoint>

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace rbs {

struct PickedBody;

/// Where the mouse is at no interactive marker but at a drawn body, it takes that body: any of thousands,
/// since bodies need no marker. A press on anything else turns the view and says so; a click there, or
/// Escape, drops the selection, and Delete deletes the selected bodies. A click with Ctrl adds a body to the
/// selection, or takes it away.
class InteractTool : public rviz::InteractionTool {
  Q_OBJECT
 public:
  void onInitialize() override;
  void deactivate() override;
  void update(float wall_dt, float ros_dt) override;
  int processMouseEvent(rviz::ViewportMouseEvent& event) override;

 private:
  /// Adds the body under the mouse to the selection, or takes it away.
  void toggle(const rviz::ViewportMouseEvent& event);
  void aim(const rviz::ViewportMouseEvent& event);
  bool aimAt(const PickedBody& picked);
  void hover(const PickedBody* picked);
  std::shared_ptr<SimulatorBodies> bodiesOf(const std::string& node);
  void finishMiss(const QPoint& released_at);

  boost::shared_ptr<BodyMouse> mouse_;
  std::map<std::string, std::shared_ptr<SimulatorBodies>> simulators_;  ///< by node
  QString nothing_there_;                                               ///< why the mouse is at no body
  std::vector<rviz::CollObjectHandle> covers_;  ///< drawn before the body at the mouse
  bool missed_ = false;                         ///< the last press was at nothing that takes it
  QPoint pressed_at_;
};

}  // namespace rbs
