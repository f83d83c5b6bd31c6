// SPDX-License-Identifier: BSD-3-Clause
// SpawnTool: adds bodies where the mouse is.
#pragma once

#include <OgreQuaternion.h>
#include <OgreVector3.h>
#include <rviz/ogre_helpers/arrow.h>
#include <rviz/ogre_helpers/shape.h>
#include <rviz/properties/bool_property.h>
#include <rviz/properties/enum_property.h>
#include <rviz/properties/float_property.h>
#include <rviz/tool.h>

#include <QPoint>

#include <memory>
#include <optional>

namespace rbs {

/// A ghost of the body stands on what is under the mouse. The wheel changes its size, a right click its shape. A
/// click adds the body; a drag gives it a velocity, which an arrow shows. It is added to the simulator whose panel
/// was used last.
class SpawnTool : public rviz::Tool {
  Q_OBJECT
 public:
  SpawnTool();
  ~SpawnTool() override;

  void onInitialize() override;
  void activate() override;
  void deactivate() override;
  int processMouseEvent(rviz::ViewportMouseEvent& event) override;

 private:
  void showGhost();
  /// The point of the scene under the mouse, in the fixed frame; where there is none, that of the plane z = 0.
  std::optional<Ogre::Vector3> surfaceUnder(const rviz::ViewportMouseEvent& event);
  void place(const rviz::ViewportMouseEvent& event);
  void aim(const rviz::ViewportMouseEvent& event);
  bool isNearPress(const rviz::ViewportMouseEvent& event) const;
  void spawn();
  /// Full extents, m.
  Ogre::Vector3 extents() const;

  rviz::EnumProperty* shape_;
  rviz::FloatProperty *size_, *density_, *friction_, *restitution_, *speed_;
  rviz::BoolProperty* is_static_;
  std::unique_ptr<rviz::Shape> ghost_;
  std::unique_ptr<rviz::Arrow> arrow_;
  std::optional<Ogre::Vector3> position_;  ///< of the centre of the ghost, in the fixed frame; empty: nowhere
  bool drags_ = false;
  QPoint right_pressed_at_;
  Ogre::Vector3 velocity_ = Ogre::Vector3::ZERO;  ///< m/s, in the fixed frame
};

}  // namespace rbs
