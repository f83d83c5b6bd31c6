// SPDX-License-Identifier: BSD-3-Clause
// BodiesVisual: the bodies themselves, drawn and to be picked.
#pragma once

#include "body_catalog.h"
#include "body_handler.h"
#include "eye.h"
#include "instance_groups.h"

#include <memory>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

namespace rbs {

class BodiesVisual {
 public:
  /// Draws in the frame of this node.
  BodiesVisual(rviz::DisplayContext& context, Ogre::SceneNode& node);

  /// These are the bodies from now on, of the simulator with this node name; null: none.
  void setCatalog(std::shared_ptr<const BodyCatalog> catalog, const std::string& node_name);
  /// Draws each body at its place, in its colour. Both lists have the order of the catalog.
  void draw(const std::vector<BodyPlace>& places, const std::vector<Ogre::ColourValue>& colors,
            const Eye& eye);
  /// Makes the bodies of these names brighter than they are.
  void setHighlighted(const std::set<std::string>& names);
  /// Makes the body whose id has these lower 31 bits a little brighter; empty: none.
  void setHovered(std::optional<std::uint64_t> low_id);

 private:
  void add(const CatalogBody& body, const BodyPlace& place, Instance instance, const Eye& eye);
  void addPlane(const BodyPlace& place, Instance instance, const Eye& eye);
  void mark();

  rviz::DisplayContext& context_;
  Ogre::SceneNode& node_;
  std::shared_ptr<const BodyCatalog> catalog_;
  std::unordered_map<std::uint64_t, std::unique_ptr<BodyHandler>> handlers_;  ///< by id
  std::vector<BodyHandler*> in_order_;                                        ///< of the catalog
  std::set<std::string> highlighted_names_;
  std::optional<std::uint64_t> hovered_id_;
  std::vector<bool> highlighted_;       ///< in the order of the catalog
  std::optional<std::size_t> hovered_;  ///< place in the catalog
  float tile_ = 1.0f;                   ///< side of the fields on planes, m
  InstanceGroups groups_;
};

}  // namespace rbs
