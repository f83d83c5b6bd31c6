// SPDX-License-Identifier: BSD-3-Clause
#include "picked_body.h"

#include "body_handler.h"

#include <rviz/default_plugin/markers/marker_selection_handler.h>
#include <rviz/display_context.h>
#include <rviz/interactive_object.h>
#include <rviz/properties/property.h>
#include <rviz/selection/selection_manager.h>
#include <rviz/viewport_mouse_event.h>

#include <OgreMovableObject.h>
#include <QRegularExpression>

#include <memory>
#include <vector>

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
  return PickedBody{&handler,           handler.node(),        handler.body().id & kLowId,
                    handler.position(), handler.orientation(), {}};
}

// The namespace of a marker names the node.
std::optional<PickedBody> bodyOf(rviz::MarkerSelectionHandler& handler, const QString& title) {
  static const QRegularExpression kTitle("^Marker (/.+)/bodies(_dark)?/(\\d+)$");
  const QRegularExpressionMatch match = kTitle.match(title);
  if (!match.hasMatch()) return std::nullopt;
  return PickedBody{&handler,
                    match.captured(1).toStdString(),
                    match.captured(3).toULongLong(),
                    handler.getPosition(),
                    handler.getOrientation(),
                    {}};
}

bool isOfGhost(const QString& title) {
  static const QRegularExpression kTitle("^Marker /.+/ghost(_dark)?/\\d+$");
  return kTitle.match(title).hasMatch();
}

// Opens what a handler draws; there is never an object of this type.
struct Tracked : rviz::SelectionHandler {
  static const S_Movable& of(const rviz::SelectionHandler& handler) {
    return handler.*&Tracked::tracked_objects_;
  }
};

// Hides what a handler draws for as long as it lives.
class Hidden {
 public:
  explicit Hidden(const rviz::SelectionHandler& handler) {
    for (Ogre::MovableObject* const object : Tracked::of(handler))
      if (object->getVisible()) objects_.push_back(object);
    for (Ogre::MovableObject* const object : objects_) object->setVisible(false);
  }
  ~Hidden() {
    for (Ogre::MovableObject* const object : objects_) object->setVisible(true);
  }
  Hidden(const Hidden&) = delete;
  Hidden& operator=(const Hidden&) = delete;

 private:
  std::vector<Ogre::MovableObject*> objects_;
};

}  // namespace

// The bodies of a reference run lie on those of the simulation, and are looked through.
std::optional<PickedBody> pickBody(rviz::DisplayContext& context, const rviz::ViewportMouseEvent& event) {
  constexpr std::size_t kMostCovers = 16;
  rviz::SelectionManager& manager = *context.getSelectionManager();
  std::vector<std::unique_ptr<Hidden>> hidden;
  std::vector<rviz::CollObjectHandle> covers;
  while (covers.size() <= kMostCovers) {
    rviz::M_Picked results;
    manager.pick(event.viewport, event.x, event.y, event.x + 1, event.y + 1, results, true);
    if (results.empty()) break;
    const rviz::Picked& picked = results.begin()->second;
    rviz::SelectionHandler* const handler = manager.getHandler(picked.handle);
    std::optional<PickedBody> body;
    if (auto* const drawn = dynamic_cast<BodyHandler*>(handler)) {
      body = bodyOf(*drawn);
    } else if (auto* const marker = dynamic_cast<rviz::MarkerSelectionHandler*>(handler)) {
      const QString title = titleOf(manager, *marker, picked);
      if (isOfGhost(title)) {
        hidden.push_back(std::make_unique<Hidden>(*marker));
        covers.push_back(picked.handle);
        continue;
      }
      body = bodyOf(*marker, title);
    }
    if (body) body->covers = covers;
    return body;
  }
  return std::nullopt;
}

}  // namespace rbs
