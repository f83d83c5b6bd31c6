// SPDX-License-Identifier: BSD-3-Clause
// What the mouse does to a drawn body: dragging it, and its menu.
#pragma once

#include "simulator_bodies.h"

#include <OgrePlane.h>
#include <OgreRay.h>
#include <OgreVector3.h>
#include <rviz/interactive_object.h>

#include <QCursor>
#include <QMenu>
#include <QTimer>

#include <functional>
#include <memory>
#include <optional>
#include <string>

namespace rviz {
class DisplayContext;
}

namespace rbs {

/// Asks for the first body of a simulator under the mouse that hides what lies behind it and can be dragged, and the point of
/// its surface, in the frame of the world. `then` is called as SimulatorBodies::meet() does, and at once with nothing where that
/// frame is not known.
void askBodyUnder(const rviz::ViewportMouseEvent& event, rviz::DisplayContext& context,
                  SimulatorBodies& simulator, const SimulatorBodies::WithMet& then);

/// One for all bodies: aim() says which one is under the mouse. RViz's Interact tool hands it the mouse like
/// a control of an interactive marker, and the simulator gets the same feedback. The left button drags in the
/// plane of the view, with Shift or the wheel nearer and farther, the right one opens the menu, all else moves the view. A press
/// on a see-through body is meant for what is behind it: the simulator is asked for that, and the press goes on when it
/// answers, with the mouse as it is then.
class BodyMouse : public rviz::InteractiveObject {
 public:
  explicit BodyMouse(rviz::DisplayContext& context);

  /// From now on it stands for this body, which is drawn here in the fixed frame, m. Not while it drags.
  void aim(const std::shared_ptr<SimulatorBodies>& simulator, const rigid_body_sim::BodyDescription& body,
           const Ogre::Vector3& position, const Ogre::Quaternion& orientation);
  bool drags() const { return drag_ || press_; }
  /// Ends the drag, if there is one.
  void letGo();

  bool isInteractive() override { return true; }
  void enableInteraction(bool) override {}
  void handleMouseEvent(rviz::ViewportMouseEvent& event) override;
  const QCursor& getCursor() const override { return cursor_; }

 private:
  using Feedback = visualization_msgs::InteractiveMarkerFeedback;

  /// A body as it is drawn, in the fixed frame.
  struct Target {
    rigid_body_sim::BodyDescription body;
    Ogre::Vector3 position;
    Ogre::Quaternion orientation;
  };

  /// A drag in a plane; everything in RViz's fixed frame.
  struct Drag {
    Ogre::Plane plane;  ///< of the view, through the gripped point
    Ogre::Vector3 grip, moved_by;
  };

  /// A press whose body is not known yet.
  struct Press {
    Ogre::Ray ray;       ///< of the mouse as it was pressed
    Ogre::Vector3 view;  ///< direction
    std::optional<Ogre::Ray> moved_to;
    bool released = false;
  };

  using WithHit = std::function<void(const std::optional<Ogre::Vector3>&)>;

  void showHints();
  /// Calls `then` with the point under the mouse, at once or later. Behind a see-through body it is that of the body there, for
  /// which this stands then, and not for what has come under the mouse meanwhile.
  void withHitPoint(const rviz::ViewportMouseEvent& event, const WithHit& then);
  std::optional<Ogre::Vector3> standFor(const std::optional<SimulatorBodies::Met>& met);
  void press(rviz::ViewportMouseEvent& event);
  void begin(const Press& press, const Ogre::Vector3& hit);
  void move(const rviz::ViewportMouseEvent& event);
  void moveTo(const Ogre::Ray& ray);
  void showMenu(rviz::ViewportMouseEvent& event);
  void fillMenu(const std::optional<Ogre::Vector3>& hit);
  void send(std::uint8_t event_type, const std::optional<Ogre::Vector3>& hit = std::nullopt,
            std::uint32_t entry = 0);

  rviz::DisplayContext& context_;
  const QCursor cursor_{Qt::OpenHandCursor};
  std::shared_ptr<SimulatorBodies> simulator_;
  Target target_;
  std::optional<Press> press_;
  std::optional<Drag> drag_;
  QTimer still_there_;             ///< sends to the simulator that a mouse at rest still drags
  boost::shared_ptr<QMenu> menu_;  ///< that is open
};

}  // namespace rbs
