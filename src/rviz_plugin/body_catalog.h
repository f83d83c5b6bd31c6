// SPDX-License-Identifier: BSD-3-Clause
// What the messages about bodies say, checked and made ready for drawing. No number in it is not finite.
#pragma once

#include "body_mesh.h"

#include <OgreColourValue.h>
#include <OgreQuaternion.h>
#include <OgreVector3.h>
#include <rigid_body_sim/BodyDescriptions.h>
#include <rigid_body_sim/BodyStates.h>

#include <cstdint>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <vector>

namespace rbs {

/// A message that cannot be drawn. what() names the body and the value.
struct BadMessage : std::runtime_error {
  using std::runtime_error::runtime_error;
};

enum class BodyShape { Box, Sphere, Plane, Capsule, Cylinder, Cone, Hull };

/// The bits of an id that a marker's id has room for, and by which what is picked in the view is known.
inline constexpr std::uint64_t kLowId = 0x7fffffff;

/// A body by its description.
struct CatalogBody {
  std::uint64_t id = 0;
  std::string name;
  BodyShape shape = BodyShape::Box;
  Ogre::Vector3 half_size = Ogre::Vector3::ZERO;  ///< half of the extents, m; of a plane: zero
  Ogre::Vector3 middle = Ogre::Vector3::ZERO;     ///< of the extents, in the body's frame, m
  std::shared_ptr<const BodyMesh> hull;           ///< null for other shapes
  Ogre::ColourValue color;
  bool is_dynamic = false, is_static = false;
  double friction = 0.0;  ///< coefficient

  bool isSeeThrough() const { return is_static && color.a < 1.0f; }  ///< as isSeeThrough() of a description
  /// Radius of a ball about the body's origin that holds it, m; of a plane: 0.
  float reach() const { return (half_size + middle.length()).length(); }
};

/// All bodies, by the descriptions of one version.
struct BodyCatalog {
  std::uint64_t version;
  std::string frame;  ///< in which the bodies are
  std::vector<CatalogBody> bodies;
  std::unordered_map<std::string, std::size_t> by_name;  ///< place in `bodies`
};

/// Where a body is.
struct BodyPlace {
  Ogre::Vector3 position;  ///< m
  Ogre::Quaternion orientation;
  Ogre::Vector3 velocity;  ///< m/s
  float turn_rate;         ///< size of the angular velocity, rad/s
};

/// Where all bodies are at one time; the order is that of the catalog.
struct BodyFrame {
  double stamp;    ///< s
  double arrival;  ///< s of wall time
  std::uint64_t version;
  std::vector<std::uint64_t> ids;
  std::vector<BodyPlace> places;
};

/// What is drawn of a hull.
struct DrawnHull {
  std::shared_ptr<const BodyMesh> mesh;
  Ogre::Vector3 middle;  ///< of its extents, m
};
/// By the coordinates of the vertices: equal hulls share a mesh, and are drawn by one call.
using DrawnHulls = std::map<std::vector<double>, DrawnHull>;

/// `hulls` are those of the last message, and are those of this one afterwards. Throws BadMessage.
std::shared_ptr<const BodyCatalog> readDescriptions(const rigid_body_sim::BodyDescriptions& message,
                                                    DrawnHulls& hulls);
/// Throws BadMessage.
std::shared_ptr<const BodyFrame> readStates(const rigid_body_sim::BodyStates& message, double arrival);

/// Whether the frame is of the bodies of the catalog: the same version, and the same ids. A simulator that
/// starts again counts its versions again.
bool match(const BodyCatalog& catalog, const BodyFrame& frame);

}  // namespace rbs
