// SPDX-License-Identifier: BSD-3-Clause
#include "body_handler.h"

#include <OgreMatrix3.h>
#include <OgreSceneNode.h>
#include <rviz/properties/quaternion_property.h>
#include <rviz/properties/vector_property.h>

namespace rbs {

BodyHandler::BodyHandler(rviz::DisplayContext& context, std::string node, CatalogBody body)
    : rviz::SelectionHandler(&context), node_(std::move(node)), body_(std::move(body)) {}

void BodyHandler::move(const BodyPlace& place, const Ogre::SceneNode& parent) {
  position_ = parent._getDerivedPosition() + parent._getDerivedOrientation() * place.position;
  orientation_ = parent._getDerivedOrientation() * place.orientation;
  velocity_ = parent._getDerivedOrientation() * place.velocity;
  for (const auto& [handles, box] : boxes_) createBox(handles, bounds(), "RVIZ/Cyan");
}

void BodyHandler::createProperties(const rviz::Picked&, rviz::Property* parent) {
  const QString name = QString::fromStdString(node_ + ": " + body_.name);
  auto* const group = new rviz::Property("Body " + name, QVariant(), "", parent);
  properties_.push_back(group);
  group->addChild(new rviz::VectorProperty("Position", position_));
  group->addChild(new rviz::QuaternionProperty("Orientation", orientation_));
  group->addChild(new rviz::VectorProperty("Velocity", velocity_));
  for (int k = 0; k < group->numChildren(); ++k) group->childAt(k)->setReadOnly(true);
  group->expand();
}

void BodyHandler::updateProperties() {
  for (rviz::Property* const group : properties_) {
    static_cast<rviz::VectorProperty*>(group->childAt(0))->setVector(position_);
    static_cast<rviz::QuaternionProperty*>(group->childAt(1))->setQuaternion(orientation_);
    static_cast<rviz::VectorProperty*>(group->childAt(2))->setVector(velocity_);
  }
}

void BodyHandler::getAABBs(const rviz::Picked&, rviz::V_AABB& boxes) {
  boxes.push_back(bounds());
}

Ogre::AxisAlignedBox BodyHandler::bounds() const {
  return boundsOf(body_, position_, orientation_);
}

Ogre::AxisAlignedBox boundsOf(const CatalogBody& body, const Ogre::Vector3& position,
                              const Ogre::Quaternion& orientation) {
  Ogre::Matrix3 rotation;
  orientation.ToRotationMatrix(rotation);
  const Ogre::Vector3 middle = position + orientation * body.middle;
  Ogre::Vector3 reach;
  const bool is_round = body.shape == BodyShape::Sphere;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    reach[axis] = is_round ? body.half_size[axis]
                           : std::abs(rotation[axis][0]) * body.half_size.x +
                                 std::abs(rotation[axis][1]) * body.half_size.y +
                                 std::abs(rotation[axis][2]) * body.half_size.z;
  }
  return {middle - reach, middle + reach};
}

}  // namespace rbs
