// SPDX-License-Identifier: BSD-3-Clause
#include "wind_arrow.h"

#include <OgreSceneNode.h>
#include <rviz/display_context.h>
#include <rviz/frame_manager.h>
#include <pluginlib/class_list_macros.hpp>

#include <algorithm>
#include <cmath>

namespace rbs {

WindArrow::WindArrow()
    : position_(new rviz::VectorProperty("Position", {0.0f, 0.0f, 3.0f},
                                         "Where the arrow begins, m, in the frame of the wind.", this)),
      scale_(new rviz::FloatProperty("Scale", 0.25f, "Length of the arrow, m, for each m/s.", this)),
      color_(new rviz::ColorProperty("Color", QColor(0x20, 0x60, 0xa0), "Color of the arrow.", this)) {
  scale_->setMin(1e-3f);
  for (rviz::Property* const property : std::initializer_list<rviz::Property*>{position_, scale_, color_})
    connect(property, &rviz::Property::changed, this, [this] { draw(); });
}

WindArrow::~WindArrow() = default;

void WindArrow::onInitialize() {
  MFDClass::onInitialize();
  arrow_ = std::make_unique<rviz::Arrow>(scene_manager_, scene_node_);
  draw();
}

void WindArrow::reset() {
  MFDClass::reset();
  wind_.reset();
  draw();
}

void WindArrow::processMessage(const rigid_body_sim::WindConstPtr& wind) {
  wind_ = wind;
  draw();
}

void WindArrow::draw() {
  if (!arrow_) return;
  constexpr double kStill = 1e-3, kFastest = 1e4;  // m/s
  const geometry_msgs::Vector3 v = wind_ ? wind_->velocity : geometry_msgs::Vector3();
  const double speed = std::hypot(v.x, v.y, v.z);
  Ogre::Vector3 position;
  Ogre::Quaternion orientation;
  const bool is_shown =
      wind_ && wind_->enabled && speed > kStill && speed < kFastest &&
      context_->getFrameManager()->getTransform(wind_->header.frame_id, ros::Time(), position, orientation);
  arrow_->getSceneNode()->setVisible(is_shown);
  context_->queueRender();
  if (!is_shown) return;
  const float length = scale_->getFloat() * static_cast<float>(speed);
  const float head = std::min(0.35f * length, 0.35f), thickness = 0.06f + 0.02f * length;
  arrow_->set(length - head, thickness, head, 2.5f * thickness);
  arrow_->setPosition(position + orientation * position_->getVector());
  arrow_->setDirection(orientation * Ogre::Vector3(v.x, v.y, v.z));
  const QColor color = color_->getColor();
  arrow_->setColor(color.redF(), color.greenF(), color.blueF(), 0.8f);
}

}  // namespace rbs

PLUGINLIB_EXPORT_CLASS(rbs::WindArrow, rviz::Display)
