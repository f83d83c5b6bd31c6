// SPDX-License-Identifier: BSD-3-Clause
// Instances: a mesh drawn at many places by one draw call (hardware instancing).
#pragma once

#include "body_mesh.h"

#include <OgreColourValue.h>
#include <OgreHardwareVertexBuffer.h>
#include <OgreQuaternion.h>
#include <OgreSimpleRenderable.h>

#include <cstdint>
#include <vector>

namespace rbs {

/// One place at which a mesh is drawn, as the vertex shader reads it.
struct Instance {
  Ogre::Vector3 position;            ///< in the frame of the scene node, m
  float handle = 0.0f;               ///< what RViz picks there: a handle of its SelectionManager; 0: nothing
  float x = 0, y = 0, z = 0, w = 1;  ///< unit quaternion
  Ogre::Vector3 size;                ///< factors of the mesh
  float extra = 0.0f;             ///< of a capsule: half the length of its wall, m; of tiles: their side, m
  float red, green, blue, alpha;  ///< 0 to 1

  static Instance at(const Ogre::Vector3& position, const Ogre::Quaternion& orientation,
                     const Ogre::Vector3& size, const Ogre::ColourValue& color);
};

/// All places of one mesh with one material. The material's vertex program must read instances
/// (instance_material.h).
class Instances : public Ogre::SimpleRenderable {
 public:
  Instances(const BodyMesh& mesh, const Ogre::MaterialPtr& material);
  ~Instances() override;

  /// Whether the graphics driver can draw instances.
  static bool areSupported();

  /// Draws these, in their order, from now on.
  void set(const std::vector<Instance>& instances);
  std::size_t count() const { return count_; }

  void _updateRenderQueue(Ogre::RenderQueue* queue) override;
  Ogre::Real getBoundingRadius() const override;
  Ogre::Real getSquaredViewDepth(const Ogre::Camera* camera) const override;

 private:
  void grow(std::size_t count);

  std::size_t count_ = 0, capacity_ = 0;
  float reach_ = 1.0f;  ///< of the mesh from its origin
};

}  // namespace rbs
