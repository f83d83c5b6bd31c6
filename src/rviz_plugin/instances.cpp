// SPDX-License-Identifier: BSD-3-Clause
#include "instances.h"

#include <OgreCamera.h>
#include <OgreHardwareBufferManager.h>
#include <OgreNode.h>
#include <OgreRenderSystem.h>
#include <OgreRenderSystemCapabilities.h>
#include <OgreRoot.h>

#include <algorithm>

namespace rbs {
namespace {

constexpr unsigned short kMesh = 0, kInstance = 1;  // sources of the vertex data

Ogre::HardwareVertexBufferSharedPtr bufferOf(std::size_t bytes_each, std::size_t count,
                                             Ogre::HardwareBuffer::Usage usage) {
  return Ogre::HardwareBufferManager::getSingleton().createVertexBuffer(bytes_each, count, usage);
}

}  // namespace

Instance Instance::at(const Ogre::Vector3& position, const Ogre::Quaternion& orientation,
                      const Ogre::Vector3& size, const Ogre::ColourValue& color) {
  Instance instance;
  instance.position = position;
  instance.x = orientation.x, instance.y = orientation.y, instance.z = orientation.z;
  instance.w = orientation.w;
  instance.size = size;
  instance.red = color.r, instance.green = color.g, instance.blue = color.b, instance.alpha = color.a;
  return instance;
}

Instances::Instances(const BodyMesh& mesh, const Ogre::MaterialPtr& material) {
  static_assert(sizeof(BodyMesh::Vertex) == 7 * sizeof(float), "as declared below");
  static_assert(sizeof(Instance) == 16 * sizeof(float), "as declared below");
  mRenderOp.vertexData = new Ogre::VertexData;
  mRenderOp.indexData = new Ogre::IndexData;
  mRenderOp.operationType =
      mesh.is_lines ? Ogre::RenderOperation::OT_LINE_LIST : Ogre::RenderOperation::OT_TRIANGLE_LIST;
  mRenderOp.useIndexes = true;
  mRenderOp.useGlobalInstancingVertexBufferIsAvailable = false;

  Ogre::VertexDeclaration& declared = *mRenderOp.vertexData->vertexDeclaration;
  declared.addElement(kMesh, 0, Ogre::VET_FLOAT3, Ogre::VES_POSITION);
  declared.addElement(kMesh, 3 * sizeof(float), Ogre::VET_FLOAT3, Ogre::VES_NORMAL);
  declared.addElement(kMesh, 6 * sizeof(float), Ogre::VET_FLOAT1, Ogre::VES_TEXTURE_COORDINATES, 0);
  for (unsigned short k = 0; k < 4; ++k)
    declared.addElement(kInstance, 4 * k * sizeof(float), Ogre::VET_FLOAT4, Ogre::VES_TEXTURE_COORDINATES,
                        k + 1);

  const auto vertices =
      bufferOf(sizeof(BodyMesh::Vertex), mesh.vertices.size(), Ogre::HardwareBuffer::HBU_STATIC_WRITE_ONLY);
  vertices->writeData(0, vertices->getSizeInBytes(), mesh.vertices.data());
  mRenderOp.vertexData->vertexBufferBinding->setBinding(kMesh, vertices);
  mRenderOp.vertexData->vertexCount = mesh.vertices.size();

  mRenderOp.indexData->indexBuffer = Ogre::HardwareBufferManager::getSingleton().createIndexBuffer(
      Ogre::HardwareIndexBuffer::IT_16BIT, mesh.indices.size(), Ogre::HardwareBuffer::HBU_STATIC_WRITE_ONLY);
  mRenderOp.indexData->indexBuffer->writeData(0, mRenderOp.indexData->indexBuffer->getSizeInBytes(),
                                              mesh.indices.data());
  mRenderOp.indexData->indexCount = mesh.indices.size();

  for (const BodyMesh::Vertex& vertex : mesh.vertices) reach_ = std::max(reach_, vertex.position.length());
  setMaterial(material);
  setCastShadows(false);
  setQueryFlags(0);
  grow(16);
}

Instances::~Instances() {
  delete mRenderOp.vertexData;
  delete mRenderOp.indexData;
}

bool Instances::areSupported() {
  return Ogre::Root::getSingleton().getRenderSystem()->getCapabilities()->hasCapability(
      Ogre::RSC_VERTEX_BUFFER_INSTANCE_DATA);
}

void Instances::grow(std::size_t count) {
  capacity_ = std::max(count, 2 * capacity_);
  const auto buffer =
      bufferOf(sizeof(Instance), capacity_, Ogre::HardwareBuffer::HBU_DYNAMIC_WRITE_ONLY_DISCARDABLE);
  buffer->setIsInstanceData(true);
  buffer->setInstanceDataStepRate(1);
  mRenderOp.vertexData->vertexBufferBinding->setBinding(kInstance, buffer);
}

void Instances::set(const std::vector<Instance>& instances) {
  count_ = instances.size();
  if (count_ == 0) return;
  if (count_ > capacity_) grow(count_);
  mRenderOp.vertexData->vertexBufferBinding->getBuffer(kInstance)->writeData(0, count_ * sizeof(Instance),
                                                                             instances.data(), true);
  mRenderOp.numberOfInstances = count_;

  Ogre::AxisAlignedBox box;
  for (const Instance& instance : instances) {
    const float largest = std::max({instance.size.x, instance.size.y, instance.size.z});
    const Ogre::Vector3 reach(reach_ * largest + instance.extra);
    box.merge(instance.position + reach);
    box.merge(instance.position - reach);
  }
  setBoundingBox(box);
  if (getParentNode()) getParentNode()->needUpdate();
}

// RViz shows all that hangs on the node of a display when it is enabled: what holds nothing too.
void Instances::_updateRenderQueue(Ogre::RenderQueue* queue) {
  if (count_ > 0) SimpleRenderable::_updateRenderQueue(queue);
}

Ogre::Real Instances::getBoundingRadius() const {
  return mBox.isFinite() ? Ogre::Math::Sqrt(
                               std::max(mBox.getMaximum().squaredLength(), mBox.getMinimum().squaredLength()))
                         : 0.0f;
}

Ogre::Real Instances::getSquaredViewDepth(const Ogre::Camera* camera) const {
  const Ogre::Vector3 middle = mBox.isFinite() ? mBox.getCenter() : Ogre::Vector3::ZERO;
  return (getParentNode()->convertLocalToWorldPosition(middle) - camera->getDerivedPosition())
      .squaredLength();
}

}  // namespace rbs
