// SPDX-License-Identifier: BSD-3-Clause
// ContactsVisual: contact points, their forces as arrows, and their friction cones.
#pragma once

#include "body_catalog.h"
#include "eye.h"
#include "instance_groups.h"

#include <rigid_body_sim/Contacts.h>

namespace rbs {

/// A contact point of two bodies of a catalog.
struct DrawnContact {
  std::size_t a, b;                                ///< places in the catalog
  Ogre::Vector3 position, normal;                  ///< m; unit, from a to b
  Ogre::Vector3 normal_impulse, friction_impulse;  ///< on b, over a step, N s
};

/// The contacts between bodies that the catalog knows. Throws BadMessage for a number that is not finite.
std::vector<DrawnContact> readContacts(const rigid_body_sim::Contacts& message, const BodyCatalog& catalog);

class ContactsVisual {
 public:
  struct Shown {
    bool points = false, forces = false, cones = false;
    bool any() const { return points || forces || cones; }
  };

  explicit ContactsVisual(Ogre::SceneNode& node) : groups_(node) {}

  /// `step`: length of a step, s; 0: not known, no forces. `metres_per_newton`: the length of arrows; 0: the
  /// largest force of all is as long as a typical body is wide. Returns the length that was taken.
  float draw(const BodyCatalog& catalog, const std::vector<DrawnContact>& contacts, const Shown& shown,
             float step, float metres_per_newton, const Eye& eye);
  void clear() { groups_.clear(); }

 private:
  void addArrow(const Ogre::Vector3& from, const Ogre::Vector3& along, float width,
                const Ogre::ColourValue& color);

  InstanceGroups groups_;
};

}  // namespace rbs
