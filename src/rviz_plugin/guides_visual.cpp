// SPDX-License-Identifier: BSD-3-Clause
#include "guides_visual.h"

#include "body_handler.h"

namespace rbs {
namespace {

using Ogre::ColourValue;
using Ogre::Vector3;

struct GuideMeshes {
  BodyMesh arm = boxMesh(Pattern::None), ball = sphereMesh(12), edges = boxEdges();
};

const GuideMeshes& guideMeshes() {
  static const GuideMeshes all;
  return all;
}

// Red, green and blue along x, y and z, as everywhere in RViz.
void addAxes(InstanceGroups& groups, const CatalogBody& body, const BodyPlace& place) {
  const float length = 1.4f * body.reach(), width = 0.025f * body.reach();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Vector3 half(width), middle = Vector3::ZERO;
    half[axis] = middle[axis] = 0.5f * length;
    ColourValue color(0.1f, 0.1f, 0.1f);
    color[axis] = 0.9f;
    groups.add(guideMeshes().arm, Look::OnTop,
               Instance::at(place.position + place.orientation * middle, place.orientation, half, color));
  }
}

// The chequered ball of drawings.
void addCentre(InstanceGroups& groups, const CatalogBody& body, const BodyPlace& place) {
  groups.add(guideMeshes().ball, Look::OnTop,
             Instance::at(place.position, place.orientation, Vector3(0.12f * body.reach()),
                          ColourValue(1.0f, 0.92f, 0.27f)));
}

void addBounds(InstanceGroups& groups, const CatalogBody& body, const BodyPlace& place) {
  const Ogre::AxisAlignedBox box = boundsOf(body, place.position, place.orientation);
  groups.add(guideMeshes().edges, Look::Plain,
             Instance::at(box.getCenter(), Ogre::Quaternion::IDENTITY, box.getHalfSize(),
                          ColourValue(0.05f, 0.1f, 0.2f, 0.9f)));
}

}  // namespace

void GuidesVisual::draw(const BodyCatalog& catalog, const std::vector<BodyPlace>& places, const Shown& shown,
                        const Eye& eye) {
  groups_.begin();
  for (std::size_t k = 0; k < places.size(); ++k) {
    const CatalogBody& body = catalog.bodies[k];
    if (body.is_static) continue;
    if (shown.axes) addAxes(groups_, body, places[k]);
    if (shown.centres) addCentre(groups_, body, places[k]);
    if (shown.bounds) addBounds(groups_, body, places[k]);
  }
  groups_.end(eye.position);
}

}  // namespace rbs
