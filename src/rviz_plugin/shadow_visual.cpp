// SPDX-License-Identifier: BSD-3-Clause
#include "shadow_visual.h"

#include "body_handler.h"

#include <algorithm>
#include <limits>

namespace rbs {
namespace {

using Ogre::Vector3;

struct Floor {
  Vector3 point, normal;
  float heightAt(const Vector3& p) const {
    return point.z - (normal.x * (p.x - point.x) + normal.y * (p.y - point.y)) / normal.z;
  }
};

std::vector<Floor> floorsOf(const BodyCatalog& catalog, const std::vector<BodyPlace>& places) {
  constexpr float kUp = 0.5f;  // at most 60 degrees of slope
  std::vector<Floor> floors;
  for (std::size_t k = 0; k < places.size(); ++k) {
    const Vector3 normal = places[k].orientation.zAxis();
    if (catalog.bodies[k].shape == BodyShape::Plane && normal.z > kUp)
      floors.push_back({places[k].position, normal});
  }
  return floors;
}

// The light that a ball of radius r takes at height h above a point, of a sky as bright everywhere, falls
// like r^2 / (r^2 + h^2).
Instance spotUnder(const Ogre::AxisAlignedBox& bounds, const Floor& floor) {
  constexpr float kDarkest = 0.5f, kNoWider = 3.0f;
  Vector3 at = bounds.getCenter();
  at.z = floor.heightAt(at);
  const Vector3 reach = bounds.getHalfSize();
  const float r = std::max(std::max(reach.x, reach.y), 1e-6f);
  const float height = std::max(0.0f, bounds.getMinimum().z - at.z) / r;
  const float wider = (0.25f + std::min(0.5f * height, kNoWider)) * std::min(reach.x, reach.y);
  Instance spot = Instance::at(at, Vector3::UNIT_Z.getRotationTo(floor.normal),
                               Vector3(reach.x + wider, reach.y + wider, 1.0f),
                               Ogre::ColourValue(0.02f, 0.03f, 0.05f, kDarkest / (1.0f + height * height)));
  spot.extra = 0.6f / (1.0f + height);
  return spot;
}

const BodyMesh& square() {
  static const BodyMesh mesh = squareMesh(Pattern::None);
  return mesh;
}

}  // namespace

void ShadowVisual::draw(const BodyCatalog& catalog, const std::vector<BodyPlace>& places, const Eye& eye) {
  constexpr float kFaintest = 0.01f;
  const std::vector<Floor> floors = floorsOf(catalog, places);
  groups_.begin();
  for (std::size_t k = 0; k < places.size(); ++k) {
    const CatalogBody& body = catalog.bodies[k];
    constexpr float kOpaque = 0.998f;
    if (body.shape == BodyShape::Plane || body.color.a < kOpaque) continue;
    const Ogre::AxisAlignedBox bounds = boundsOf(body, places[k].position, places[k].orientation);
    const Floor* under = nullptr;
    for (const Floor& floor : floors) {
      const float height = floor.heightAt(bounds.getCenter());
      if (height < bounds.getMaximum().z && (!under || height > under->heightAt(bounds.getCenter())))
        under = &floor;
    }
    if (!under) continue;
    const Instance spot = spotUnder(bounds, *under);
    if (spot.alpha > kFaintest) groups_.add(square(), Look::Shadow, spot);
  }
  groups_.end(eye.position);
}

}  // namespace rbs
