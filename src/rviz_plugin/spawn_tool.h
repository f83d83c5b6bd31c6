// SPDX-License-Identifier: BSD-3-Clause
// SpawnTool: adds bodies where the mouse is.
#pragma once

#include "ghost.h"

#include "rigid_body_sim/shape.h"

#include <OgreVector3.h>
#include <rviz/ogre_helpers/arrow.h>
#include <rviz/properties/bool_property.h>
#include <rviz/properties/enum_property.h>
#include <rviz/properties/float_property.h>
#include <rviz/properties/string_property.h>
#include <rviz/tool.h>

#include <QPoint>

#include <future>
#include <memory>
#include <optional>

namespace rbs {

/// A ghost of the body touches what is under the mouse. The wheel changes its size, a right click its shape. A
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
  /// A point of the scene, and the outward normal of its surface there, in the fixed frame.
  struct Surface {
    Ogre::Vector3 point, normal;
  };

  /// A shape that stands upright.
  struct Standing {
    Shape shape;
    Quat q_WB;
  };

  /// Takes the shape of the properties; one of a mesh when it has been read, on a thread of its own.
  void takeShape();
  void take(const Standing& standing);
  void takeMeshWhenRead();
  void showGhost();
  /// Where there is nothing under the mouse, the plane z = 0.
  std::optional<Surface> surfaceUnder(const rviz::ViewportMouseEvent& event);
  void place(const rviz::ViewportMouseEvent& event);
  void aim(const rviz::ViewportMouseEvent& event);
  bool isNearPress(const rviz::ViewportMouseEvent& event) const;
  void spawn();

  rviz::EnumProperty* shape_;
  rviz::StringProperty* mesh_;
  rviz::FloatProperty *size_, *density_, *friction_, *restitution_, *speed_;
  rviz::BoolProperty* is_static_;
  std::optional<Standing> unit_;  ///< the largest extent is 1 m; empty: there is no mesh
  std::future<Standing> coming_;  ///< the same of the mesh that is being read
  std::unique_ptr<Ghost> ghost_;
  std::unique_ptr<rviz::Arrow> arrow_;
  std::optional<Ogre::Vector3>
      position_;  ///< of the ghost's centre of mass, in the fixed frame; empty: nowhere
  bool drags_ = false;
  QPoint right_pressed_at_;
  Ogre::Vector3 velocity_ = Ogre::Vector3::ZERO;  ///< m/s, in the fixed frame
};

}  // namespace rbs
