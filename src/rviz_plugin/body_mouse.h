// SPDX-License-Identifier: BSD-3-Clause
// What the mouse does to a drawn body: dragging it, and its menu.
#pragma once

#include "simulator_bodies.h"

#include <OgrePlane.h>
#include <OgreVector3.h>
#include <rviz/interactive_object.h>

#include <QCursor>
#include <QMenu>
#include <QTimer>

#include <memory>
#include <optional>
#include <string>

namespace rviz {
class DisplayContext;
}

namespace rbs {

/// The first body of a simulator under the mouse that hides what lies behind it and can be dragged, and the
/// point of its surface, in the frame of the world. Empty where there is none, where the simulator does not
/// answer within 0.2 s, and where that frame is not known.
std::optional<SimulatorBodies::Met> bodyUnder(const rviz::ViewportMouseEvent& event,
                                              rviz::DisplayContext& context,
                                              const SimulatorBodies& simulator);

/// One for all bodies: aim() says which one is under the mouse. RViz's Interact tool hands it the mouse like
/// a control of an interactive marker, and the simulator gets the same feedback. The left button drags in the
/// plane of the view, with Shift or the wheel nearer and farther, the right one opens the menu, all else moves the view.
class BodyMouse : public rviz::InteractiveObject {
 public:
  explicit BodyMouse(rviz::DisplayContext& context);

  /// From now on it stands for this body, which is drawn here in the fixed frame, m. Not while it drags.
  void aim(const std::shared_ptr<SimulatorBodies>& simulator, const rigid_body_sim::BodyDescription& body,
           const Ogre::Vector3& position, const Ogre::Quaternion& orientation);
  bool drags() const { return drag_.has_value(); }
  /// Ends the drag, if there is one.
  void letGo();

  bool isInteractive() override { return true; }
  void enableInteraction(bool) override {}
  void handleMouseEvent(rviz::ViewportMouseEvent& event) override;
  const QCursor& getCursor() const override { return cursor_; }

 private:
  using Feedback = visualization_msgs::InteractiveMarkerFeedback;

  /// A drag in a plane; everything in RViz's fixed frame.
  struct Drag {
    Ogre::Plane plane;  ///< of the view, through the gripped point
    Ogre::Vector3 grip, moved_by;
  };

  void showHints();
  /// The point under the mouse. Behind a see-through body it is that of the body there, for which this stands
  /// then.
  std::optional<Ogre::Vector3> hitPoint(const rviz::ViewportMouseEvent& event);
  std::optional<Ogre::Vector3> lookThrough(const rviz::ViewportMouseEvent& event);
  void press(rviz::ViewportMouseEvent& event);
  void move(const rviz::ViewportMouseEvent& event);
  void showMenu(rviz::ViewportMouseEvent& event);
  void send(std::uint8_t event_type, const std::optional<Ogre::Vector3>& hit = std::nullopt,
            std::uint32_t entry = 0);

  rviz::DisplayContext& context_;
  const QCursor cursor_{Qt::OpenHandCursor};
  std::shared_ptr<SimulatorBodies> simulator_;
  rigid_body_sim::BodyDescription body_;
  Ogre::Vector3 position_;  ///< of the body as it is drawn, in the fixed frame
  Ogre::Quaternion orientation_;
  std::optional<Drag> drag_;
  QTimer still_there_;             ///< sends to the simulator that a mouse at rest still drags
  boost::shared_ptr<QMenu> menu_;  ///< that is open
};

}  // namespace rbs
