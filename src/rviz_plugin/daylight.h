// SPDX-License-Identifier: BSD-3-Clause
// Daylight: a display that lights the scene.
#pragma once

#include <OgreColourValue.h>
#include <rviz/display.h>

namespace Ogre {
class Light;
}

namespace rbs {

/// RViz's own light sits on the camera and leaves whatever it grazes black, so that a floor is dark. This is
/// a sun that stays where it is in the world of the first Bodies display, whatever the fixed frame is, a weak light
/// from across, and light from everywhere. Without a Bodies display it stays where it is in the fixed frame. To be used with the "Default Light" of the global options off.
class Daylight : public rviz::Display {
  Q_OBJECT
 public:
  ~Daylight() override;

 protected:
  void onInitialize() override;
  void onEnable() override;
  void onDisable() override;
  void update(float wall_dt, float ros_dt) override;

 private:
  Ogre::Light* addLight(const Ogre::Vector3& direction, float strength);

  Ogre::Light* sun_ = nullptr;
  Ogre::Light* fill_ = nullptr;
  Ogre::ColourValue ambient_before_;
};

}  // namespace rbs
