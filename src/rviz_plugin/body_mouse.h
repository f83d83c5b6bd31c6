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
/// its surface, in the frame of the world. `then` is called as SimulatorBodies::meet() does. Where that frame is not known it is
/// called at once, as for no body.
void askBodyUnder(const rviz::ViewportMouseEvent& event, rviz::DisplayContext& context,
                  SimulatorBodies& simulator, const SimulatorBodies::WithAnswer& then);

/// One for all bodies: aim() says which one is under the mouse. RViz's Interact tool hands it the mouse like
/// a control of an interactive marker, and the simulator gets the same feedback. The left button drags in the
/// plane of the view, with Shift or the wheel nearer and farther, the right one opens the menu, all else moves the view. A press
/// on a see-through body is meant for what is behind it. The simulator is asked for that, and the press goes on when it
/// answers. Where it does not answer, the press is dropped.
class BodyMouse : public rviz::InteractiveObject {
 public:
  explicit BodyMouse(rviz::DisplayContext& context);

  /// What comes is meant for this body, which is drawn here in the fixed frame, m. A drag and a menu stay with theirs.
  void aim(const std::shared_ptr<SimulatorBodies>& simulator, const rigid_body_sim::BodyDescription& body,
           const Ogre::Vector3& position, const Ogre::Quaternion& orientation);
  bool drags() const { return drag_ || (press_ && !press_->released); }
  /// Ends the drag, if there is one.
  void letGo();
  /// Ends the drag, and drops a press or a menu that still waits for the simulator.
  void cancel();

  bool isInteractive() override { return true; }
  void enableInteraction(bool) override {}
  void handleMouseEvent(rviz::ViewportMouseEvent& event) override;
  const QCursor& getCursor() const override { return cursor_; }

 private:
  using Feedback = visualization_msgs::InteractiveMarkerFeedback;

  /// A body as it is drawn, in the fixed frame.
  struct Target {
    std::shared_ptr<SimulatorBodies> simulator;
    rigid_body_sim::BodyDescription body;
    Ogre::Vector3 position;
    Ogre::Quaternion orientation;
  };

  /// A drag in a plane; everything in RViz's fixed frame.
  struct Drag {
    Target target;
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

  using Hit = std::optional<Ogre::Vector3>;
  using WithHit = std::function<void(const Target&, const Hit&)>;

  /// What waits for the simulator to say what is behind a see-through body.
  struct Query {
    Target seen;
    Hit hit;
    WithHit then;
  };

  void showHints();
  /// Calls `then` with the body under the mouse and its point there, at once or later. Behind a see-through body it is the body
  /// there. A later call takes the place of one that still waits.
  void withHitPoint(const rviz::ViewportMouseEvent& event, const WithHit& then);
  void answer(const SimulatorBodies::Answer& answer);
  void press(rviz::ViewportMouseEvent& event);
  void begin(const Press& press, const Target& target, const Ogre::Vector3& hit);
  void move(const rviz::ViewportMouseEvent& event);
  void moveTo(const Ogre::Ray& ray);
  void showMenu(rviz::ViewportMouseEvent& event);
  void fillMenu(const Target& target, const Hit& hit);
  void send(const Target& target, std::uint8_t event_type, const Hit& hit = std::nullopt,
            std::uint32_t entry = 0);

  rviz::DisplayContext& context_;
  const QCursor cursor_{Qt::OpenHandCursor};
  Target target_;  ///< under the mouse
  std::optional<Query> query_;
  unsigned asked_ = 0;  ///< the number of the last query: answers to others are late
  std::optional<Press> press_;
  std::optional<Drag> drag_;
  QTimer still_there_;             ///< sends to the simulator that a mouse at rest still drags
  boost::shared_ptr<QMenu> menu_;  ///< that is open
};

}  // namespace rbs
