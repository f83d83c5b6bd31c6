// SPDX-License-Identifier: BSD-3-Clause
#include "bodies_visual.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace rbs {
namespace {

using Ogre::Vector3;

/// The meshes of a shape by fineness.
struct ShapeMeshes {
  std::array<BodyMesh, 4> sphere{sphereMesh(4), sphereMesh(6), sphereMesh(12), sphereMesh(24)};
  std::array<BodyMesh, 4> capsule{capsuleMesh(4), capsuleMesh(6), capsuleMesh(12), capsuleMesh(24)};
  std::array<BodyMesh, 4> cylinder{cylinderMesh(8), cylinderMesh(12), cylinderMesh(24), cylinderMesh(48)};
  std::array<BodyMesh, 4> cone{coneMesh(8), coneMesh(12), coneMesh(24), coneMesh(48)};
  BodyMesh box = boxMesh();
  BodyMesh plane = squareMesh(Pattern::Tiles);
};

const ShapeMeshes& shapeMeshes() {
  static const ShapeMeshes all;
  return all;
}

// By the radius in the picture. Where no graphics card helps, triangles are what takes the time.
std::size_t finenessOf(const CatalogBody& body, float distance, const Eye& eye) {
  const float radius = body.shape == BodyShape::Sphere ? body.half_size.x : body.reach();
  const float pixels = eye.pixels * radius / std::max(distance, 1e-6f);
  return pixels > 40.0f ? 3 : pixels > 9.0f ? 2 : pixels > 3.5f ? 1 : 0;
}

const BodyMesh& meshOf(const CatalogBody& body, std::size_t fineness) {
  switch (body.shape) {
    case BodyShape::Sphere:
      return shapeMeshes().sphere[fineness];
    case BodyShape::Capsule:
      return shapeMeshes().capsule[fineness];
    case BodyShape::Cylinder:
      return shapeMeshes().cylinder[fineness];
    case BodyShape::Cone:
      return shapeMeshes().cone[fineness];
    case BodyShape::Hull:
      return *body.hull;
    case BodyShape::Box:
      return shapeMeshes().box;
    case BodyShape::Plane:
      break;
  }
  return shapeMeshes().plane;
}

// By what the instance multiplies the mesh of its shape.
void setSize(const CatalogBody& body, Instance& instance) {
  instance.size = body.half_size;
  if (body.shape == BodyShape::Hull) instance.size = Vector3::UNIT_SCALE;
  if (body.shape == BodyShape::Cone) instance.size.z = 2.0f * body.half_size.z;
  if (body.shape != BodyShape::Capsule) return;
  instance.size = Vector3(body.half_size.x);
  instance.extra = std::max(0.0f, body.half_size.z - body.half_size.x);
}

float powerOfTwoNear(float value) {
  return std::exp2(std::round(std::log2(std::clamp(value, 1e-6f, 1e9f))));
}

// A few bodies wide, so that the floor measures what lies on it.
float tileFor(const BodyCatalog& catalog) {
  std::vector<float> reaches;
  for (const CatalogBody& body : catalog.bodies)
    if (body.is_dynamic) reaches.push_back(body.reach());
  if (reaches.empty()) return 1.0f;
  const auto middle = reaches.begin() + static_cast<std::ptrdiff_t>(reaches.size() / 2);
  std::nth_element(reaches.begin(), middle, reaches.end());
  return powerOfTwoNear(3.0f * *middle);
}

constexpr float kSelected = 0.3f, kHovered = 0.25f;  // shares of white
constexpr float kOutline = 3.0f;                     // pixels
const Ogre::ColourValue kOutlineColor(1.0f, 0.5f, 0.0f);

// Of a body, its shape grown by so much on all sides, m.
Instance outlineOf(const CatalogBody& body, Instance instance, float width) {
  setSize(body, instance);
  if (body.shape == BodyShape::Hull)
    instance.size *= 1.0f + width / body.reach();
  else if (body.shape == BodyShape::Cone)
    instance.size += width * Vector3(1.5f, 1.5f, 4.0f);  // its origin is at a quarter of its height
  else
    instance.size += Vector3(width);
  instance.handle = 0.0f;
  instance.red = kOutlineColor.r, instance.green = kOutlineColor.g, instance.blue = kOutlineColor.b;
  instance.alpha = 1.0f;
  return instance;
}

Ogre::ColourValue brightened(const Ogre::ColourValue& color, float share) {
  Ogre::ColourValue bright = color + share * (Ogre::ColourValue::White - color);
  bright.a = std::max(color.a, share);
  return bright;
}

}  // namespace

BodiesVisual::BodiesVisual(rviz::DisplayContext& context, Ogre::SceneNode& node)
    : context_(context), node_(node), groups_(node) {}

// Who is still there keeps its handler, and with it its selection.
void BodiesVisual::setCatalog(std::shared_ptr<const BodyCatalog> catalog, const std::string& node_name) {
  groups_.clear();
  catalog_ = std::move(catalog);
  auto before = std::move(handlers_);
  handlers_.clear();
  in_order_.clear();
  if (!catalog_) return;
  tile_ = tileFor(*catalog_);
  handlers_.reserve(catalog_->bodies.size());
  for (const CatalogBody& body : catalog_->bodies) {
    std::unique_ptr<BodyHandler>& handler = handlers_[body.id];
    if (const auto it = before.find(body.id); it != before.end() && it->second->node() == node_name)
      handler = std::move(it->second);
    if (handler)
      handler->describe(body);
    else
      handler = std::make_unique<BodyHandler>(context_, node_name, body);
    in_order_.push_back(handler.get());
  }
  mark();
}

void BodiesVisual::setHighlighted(const std::set<std::string>& names) {
  highlighted_names_ = names;
  mark();
}

void BodiesVisual::setHovered(std::optional<std::uint64_t> low_id) {
  if (low_id == hovered_id_) return;
  hovered_id_ = low_id;
  mark();
}

void BodiesVisual::mark() {
  highlighted_.clear();
  hovered_.reset();
  if (!catalog_) return;
  for (const CatalogBody& body : catalog_->bodies) {
    if (hovered_id_ == (body.id & kLowId)) hovered_ = highlighted_.size();
    highlighted_.push_back(!highlighted_names_.empty() && highlighted_names_.count(body.name) > 0);
  }
}

void BodiesVisual::draw(const std::vector<BodyPlace>& places, const std::vector<Ogre::ColourValue>& colors,
                        const Eye& eye) {
  groups_.begin();
  for (std::size_t k = 0; k < places.size(); ++k) {
    const BodyPlace& place = places[k];
    Ogre::ColourValue color = colors[k];
    if (highlighted_[k]) color = brightened(color, kSelected);
    if (k == hovered_) color = brightened(color, kHovered);
    Instance instance = Instance::at(place.position, place.orientation, Vector3::UNIT_SCALE, color);
    instance.handle = static_cast<float>(in_order_[k]->getHandle());
    in_order_[k]->move(place, node_);
    const CatalogBody& body = catalog_->bodies[k];
    if (body.shape == BodyShape::Plane) {
      addPlane(place, instance, eye);
      continue;
    }
    add(body, place, instance, eye);
    if (highlighted_[k]) {
      const float distance = (place.position - eye.position).length(), pixel = distance / eye.pixels;
      groups_.add(meshOf(body, finenessOf(body, distance, eye)), Look::Outline,
                  outlineOf(body, instance, kOutline * pixel));
    }
  }
  groups_.end(eye.position);
}

void BodiesVisual::add(const CatalogBody& body, const BodyPlace& place, Instance instance, const Eye& eye) {
  setSize(body, instance);
  const std::size_t fineness = finenessOf(body, (place.position - eye.position).length(), eye);
  constexpr float kOpaque = 0.998f;
  groups_.add(meshOf(body, fineness), instance.alpha < kOpaque ? Look::SeeThrough : Look::Solid, instance);
}

// Without end: what is drawn of it goes with the eye, by whole pairs of tiles, and fades in the distance.
void BodiesVisual::addPlane(const BodyPlace& place, Instance instance, const Eye& eye) {
  const Vector3 eye_B = place.orientation.Inverse() * (eye.position - place.position);
  if (eye_B.z < 0.0f) return;  // one looks out of the solid half-space
  const float far = 60.0f * tile_ + 15.0f * std::abs(eye_B.z);
  const auto snapped = [this](float x) { return 2.0f * tile_ * std::round(x / (2.0f * tile_)); };
  const Vector3 middle_B(snapped(eye_B.x), snapped(eye_B.y), 0.0f);
  instance.position = place.position + place.orientation * middle_B;
  instance.size = Vector3(far, far, 1.0f);
  instance.extra = tile_;
  groups_.add(shapeMeshes().plane, Look::Ground, instance);
}

}  // namespace rbs
