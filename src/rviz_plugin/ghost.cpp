// SPDX-License-Identifier: BSD-3-Clause
#include "ghost.h"

#include <OgreSceneManager.h>
#include <OgreSceneNode.h>

#include <utility>
#include <variant>

namespace rbs {
namespace {

using Ogre::Vector3;

const Ogre::ColourValue kColor(0.2f, 0.5f, 0.8f, 0.5f);

/// The mesh of a shape, and by what an instance multiplies it.
struct Drawing {
  BodyMesh mesh;
  Vec3 size = Vec3::Ones();
  double wall = 0.0;  ///< of a capsule: half the length of its wall, m
};

Drawing drawingOf(const Sphere& ball) {
  return {sphereMesh(24), Vec3::Constant(ball.radius)};
}
Drawing drawingOf(const Box& box) {
  return {boxMesh(), 0.5 * box.size};
}
Drawing drawingOf(const Capsule& capsule) {
  return {capsuleMesh(24), Vec3::Constant(capsule.radius), capsule.half_length};
}
Drawing drawingOf(const Cylinder& cylinder) {
  return {cylinderMesh(48), Vec3(cylinder.radius, cylinder.radius, cylinder.half_length)};
}
Drawing drawingOf(const Cone& cone) {
  return {coneMesh(48), Vec3(cone.radius, cone.radius, cone.height)};
}
Drawing drawingOf(const ConvexHull& hull) {
  return {polyhedronMesh(*hull.polyhedron)};
}
Drawing drawingOf(const Plane&) {
  return {};
}

}  // namespace

Ghost::Ghost(Ogre::SceneManager& scenes)
    : node_(scenes.getRootSceneNode()->createChildSceneNode()), groups_(*node_) {}

Ghost::~Ghost() {
  groups_.clear();
  node_->getCreator()->destroySceneNode(node_);
}

void Ghost::setShape(const Shape& shape) {
  groups_.clear();
  Drawing drawing = std::visit([](const auto& alternative) { return drawingOf(alternative); }, shape);
  mesh_ = std::move(drawing.mesh);
  factors_ = {static_cast<float>(drawing.size.x()), static_cast<float>(drawing.size.y()),
              static_cast<float>(drawing.size.z())};
  wall_ = drawing.wall;
}

void Ghost::show(double size, const Vector3& position, const Ogre::Quaternion& orientation) {
  if (!Instances::areSupported()) return;
  Instance instance = Instance::at(position, orientation, static_cast<float>(size) * factors_, kColor);
  instance.extra = static_cast<float>(size * wall_);
  groups_.begin();
  groups_.add(mesh_, Look::SeeThrough, instance);
  groups_.end(position);
}

void Ghost::hide() {
  groups_.begin();
  groups_.end(Vector3::ZERO);
}

}  // namespace rbs
