// SPDX-License-Identifier: BSD-3-Clause
// BodyHandler: a drawn body, as RViz picks, selects and frames it.
#pragma once

#include "body_catalog.h"

#include <rviz/selection/selection_handler.h>

#include <string>

namespace rbs {

class BodyHandler : public rviz::SelectionHandler {
 public:
  /// `node`: the resolved name of the simulator's node.
  BodyHandler(rviz::DisplayContext& context, std::string node, CatalogBody body);

  /// This is its description from now on.
  void describe(CatalogBody body) { body_ = std::move(body); }
  /// It is drawn here now; `parent` is the node in whose frame `place` is.
  void move(const BodyPlace& place, const Ogre::SceneNode& parent);

  const std::string& node() const { return node_; }
  const CatalogBody& body() const { return body_; }
  /// In RViz's fixed frame, m.
  const Ogre::Vector3& position() const { return position_; }
  const Ogre::Quaternion& orientation() const { return orientation_; }

  void createProperties(const rviz::Picked& picked, rviz::Property* parent) override;
  void updateProperties() override;
  void getAABBs(const rviz::Picked& picked, rviz::V_AABB& boxes) override;

 private:
  Ogre::AxisAlignedBox bounds() const;

  const std::string node_;
  CatalogBody body_;
  Ogre::Vector3 position_ = Ogre::Vector3::ZERO, velocity_ = Ogre::Vector3::ZERO;
  Ogre::Quaternion orientation_;
};

/// The bounds of a body at a place along the axes of the frame that the place is in, m. Of a plane: a point.
Ogre::AxisAlignedBox boundsOf(const CatalogBody& body, const Ogre::Vector3& position,
                              const Ogre::Quaternion& orientation);

}  // namespace rbs
