// SPDX-License-Identifier: BSD-3-Clause
#include "daylight.h"

#include "bodies_display.h"

#include <OgreLight.h>
#include <OgreSceneManager.h>
#include <OgreSceneNode.h>
#include <pluginlib/class_list_macros.hpp>

namespace rbs {

Daylight::~Daylight() {
  if (!initialized()) return;
  scene_manager_->setAmbientLight(ambient_before_);
  scene_manager_->destroyLight(sun_);
  scene_manager_->destroyLight(fill_);
}

void Daylight::onInitialize() {
  ambient_before_ = scene_manager_->getAmbientLight();
  sun_ = addLight({0.45f, 0.6f, -1.0f}, 0.75f);
  fill_ = addLight({-1.0f, 0.3f, -0.3f}, 0.25f);
}

// RViz shows and hides the node of a display, and with it what hangs on it.
Ogre::Light* Daylight::addLight(const Ogre::Vector3& direction, float strength) {
  Ogre::Light* const light = scene_manager_->createLight();
  light->setType(Ogre::Light::LT_DIRECTIONAL);
  light->setDiffuseColour(strength, strength, strength);
  Ogre::SceneNode* const node = scene_node_->createChildSceneNode();
  node->setDirection(direction, Ogre::Node::TS_PARENT);
  node->attachObject(light);
  return light;
}

void Daylight::onEnable() {
  constexpr float kStrength = 0.6f;  // RViz gives a marker half of its colour for the light from everywhere
  scene_manager_->setAmbientLight(Ogre::ColourValue(kStrength, kStrength, kStrength));
}

void Daylight::onDisable() {
  scene_manager_->setAmbientLight(ambient_before_);
}

void Daylight::update(float, float) {
  const std::vector<BodiesDisplay*> displays = BodiesDisplay::allIn(*context_);
  scene_node_->setOrientation(displays.empty() ? Ogre::Quaternion::IDENTITY
                                               : displays.front()->getSceneNode()->getOrientation());
}

}  // namespace rbs

PLUGINLIB_EXPORT_CLASS(rbs::Daylight, rviz::Display)
