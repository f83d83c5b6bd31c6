// SPDX-License-Identifier: BSD-3-Clause
#include "contacts_visual.h"

#include <algorithm>
#include <cmath>

namespace rbs {
namespace {

using Ogre::ColourValue;
using Ogre::Vector3;

const ColourValue kPoint(0.05f, 0.05f, 0.05f), kNormal(0.00f, 0.45f, 0.70f), kFriction(0.84f, 0.37f, 0.00f),
    kCone(0.34f, 0.71f, 0.91f, 0.25f);

struct ArrowMeshes {
  BodyMesh ball = sphereMesh(6, Pattern::None), shaft = cylinderMesh(8, Pattern::None),
           head = coneMesh(12, Pattern::None), cone = coneMesh(24, Pattern::None);
};

const ArrowMeshes& arrowMeshes() {
  static const ArrowMeshes all;
  return all;
}

template <class Vector>
Vector3 finiteVector(const Vector& v, const char* what) {
  constexpr double kMost = 1e18;  // whose square a float can hold
  for (const double part : {v.x, v.y, v.z})
    if (!(std::abs(part) <= kMost)) throw BadMessage(std::string(what) + " of a contact is not finite");
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

// Half the size of the bodies in contact, on the average, m.
float typicalReach(const BodyCatalog& catalog, const std::vector<DrawnContact>& contacts) {
  float sum = 0.0f, count = 0.0f;
  for (const DrawnContact& contact : contacts) {
    for (const std::size_t k : {contact.a, contact.b}) {
      if (!catalog.bodies[k].is_dynamic) continue;
      sum += catalog.bodies[k].reach();
      count += 1.0f;
    }
  }
  return count > 0.0f ? sum / count : 0.5f;
}

float largestImpulse(const std::vector<DrawnContact>& contacts) {
  float largest = 0.0f;
  for (const DrawnContact& contact : contacts)
    largest = std::max({largest, contact.normal_impulse.length(), contact.friction_impulse.length()});
  return largest;
}

}  // namespace

std::vector<DrawnContact> readContacts(const rigid_body_sim::Contacts& message, const BodyCatalog& catalog) {
  std::vector<DrawnContact> contacts;
  for (const rigid_body_sim::Contact& contact : message.contacts) {
    const auto a = catalog.by_name.find(contact.body_a), b = catalog.by_name.find(contact.body_b);
    DrawnContact drawn{};
    drawn.position = finiteVector(contact.position, "the position");
    drawn.normal = finiteVector(contact.normal, "the normal");
    drawn.friction_impulse = finiteVector(contact.friction_impulse, "the friction impulse");
    if (!std::isfinite(static_cast<float>(contact.normal_impulse)))
      throw BadMessage("the normal impulse of a contact is not finite");
    drawn.normal_impulse = static_cast<float>(contact.normal_impulse) * drawn.normal;
    if (a == catalog.by_name.end() || b == catalog.by_name.end()) continue;
    drawn.a = a->second, drawn.b = b->second;
    contacts.push_back(drawn);
  }
  return contacts;
}

float ContactsVisual::draw(const BodyCatalog& catalog, const std::vector<DrawnContact>& contacts,
                           const Shown& shown, float step, float metres_per_newton, const Eye& eye) {
  const float reach = typicalReach(catalog, contacts), largest = largestImpulse(contacts);
  float scale = metres_per_newton;
  if (scale <= 0.0f && largest > 0.0f) scale = 2.0f * reach * step / largest;
  groups_.begin();
  for (const DrawnContact& contact : contacts) {
    if (shown.points)
      groups_.add(arrowMeshes().ball, Look::OnTop,
                  Instance::at(contact.position, Ogre::Quaternion::IDENTITY, Vector3(0.06f * reach), kPoint));
    if (shown.forces && step > 0.0f) {
      addArrow(contact.position, scale / step * contact.normal_impulse, 0.035f * reach, kNormal);
      addArrow(contact.position, scale / step * contact.friction_impulse, 0.035f * reach, kFriction);
    }
    if (!shown.cones) continue;
    constexpr double kWidest = 5.0;
    const auto friction = static_cast<float>(std::min(
        kWidest, std::sqrt(catalog.bodies[contact.a].friction * catalog.bodies[contact.b].friction)));
    const float height = 0.6f * reach, radius = std::max(1e-3f, friction) * height;
    groups_.add(
        arrowMeshes().cone, Look::SeeThrough,
        Instance::at(contact.position + 0.75f * height * contact.normal,
                     Vector3::UNIT_Z.getRotationTo(-contact.normal), Vector3(radius, radius, height), kCone));
  }
  groups_.end(eye.position);
  return scale;
}

// The head is part of the length.
void ContactsVisual::addArrow(const Vector3& from, const Vector3& along, float width,
                              const ColourValue& color) {
  const float length = along.length();
  if (!(length > 0.2f * width) || !std::isfinite(length)) return;
  const float head = std::min(5.0f * width, 0.5f * length), shaft = length - head;
  const Vector3 direction = along / length;
  const Ogre::Quaternion turned = Vector3::UNIT_Z.getRotationTo(direction);
  groups_.add(
      arrowMeshes().shaft, Look::OnTop,
      Instance::at(from + 0.5f * shaft * direction, turned, Vector3(width, width, 0.5f * shaft), color));
  groups_.add(arrowMeshes().head, Look::OnTop,
              Instance::at(from + (shaft + 0.25f * head) * direction, turned,
                           Vector3(2.4f * width, 2.4f * width, head), color));
}

}  // namespace rbs
