// SPDX-License-Identifier: BSD-3-Clause
#include "body_catalog.h"

#include "rigid_body_sim/quote.h"
#include "rigid_body_sim/shape.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>
#include <utility>

namespace rbs {
namespace {

using rigid_body_sim::BodyDescription;

constexpr double kMostSize = 1e18;  // whose square a float can hold

const std::map<std::string, BodyShape> kShapes = {
    {"box", BodyShape::Box},         {"sphere", BodyShape::Sphere},     {"plane", BodyShape::Plane},
    {"capsule", BodyShape::Capsule}, {"cylinder", BodyShape::Cylinder}, {"cone", BodyShape::Cone},
    {"hull", BodyShape::Hull}};

template <class... Parts>
[[noreturn]] void refuse(const Parts&... parts) {
  std::ostringstream text;
  (text << ... << parts);
  throw BadMessage(text.str());
}

bool isCoordinate(double value) {
  return std::abs(value) <= kMostSize;  // false for what is not a number
}

template <class Vector>
bool areCoordinates(const Vector& v) {
  return isCoordinate(v.x) && isCoordinate(v.y) && isCoordinate(v.z);
}

template <class Vector>
Ogre::Vector3 toOgre(const Vector& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

Ogre::Vector3 halfSizeOf(const BodyDescription& body) {
  const auto& s = body.size;
  if (!areCoordinates(s) || std::min({s.x, s.y, s.z}) <= 0.0)
    refuse("the size of body ", quoted(body.name), " is (", s.x, ", ", s.y, ", ", s.z,
           ") m; allowed is above 0 and up to ", kMostSize);
  return 0.5f * toOgre(s);
}

Ogre::ColourValue colorOf(const BodyDescription& body) {
  for (const float part : {body.color.r, body.color.g, body.color.b, body.color.a})
    if (!(part >= 0.0f && part <= 1.0f))
      refuse("the colour of body ", quoted(body.name), " has the part ", part, "; allowed is 0 to 1");
  return Ogre::ColourValue(body.color.r, body.color.g, body.color.b, body.color.a);
}

// The extents of a hull need not lie evenly about the centre of mass.
DrawnHull makeDrawnHull(const BodyDescription& description) {
  std::vector<Vec3> points;
  for (const auto& p : description.vertices) points.emplace_back(p.x, p.y, p.z);
  try {
    const PlacedHull made = makeHull(points, "vertices");
    const Vec3 middle = 0.5 * (made.hull.polyhedron->bounds.lo + made.hull.polyhedron->bounds.hi);
    return {std::make_shared<BodyMesh>(polyhedronMesh(*made.hull.polyhedron)),
            {static_cast<float>(middle.x()), static_cast<float>(middle.y()), static_cast<float>(middle.z())}};
  } catch (const std::exception& error) {
    refuse("body ", quoted(description.name), " is no hull: ", error.what());
  }
}

/// The hulls of the last message, and those of this one so far.
struct HullShelf {
  const DrawnHulls& before;
  DrawnHulls now;

  const DrawnHull& find(const BodyDescription& description) {
    std::vector<double> key;
    for (const auto& p : description.vertices) {
      if (!areCoordinates(p)) refuse("a vertex of body ", quoted(description.name), " is not finite");
      key.insert(key.end(), {p.x, p.y, p.z});
    }
    const auto it = now.find(key);
    if (it != now.end()) return it->second;
    const auto known = before.find(key);
    return now.emplace(key, known != before.end() ? known->second : makeDrawnHull(description)).first->second;
  }
};

CatalogBody readBody(const BodyDescription& description, HullShelf& hulls) {
  CatalogBody body;
  body.id = description.id;
  body.name = description.name;
  const auto shape = kShapes.find(description.shape);
  if (shape == kShapes.end())
    refuse("the shape of body ", quoted(description.name), " is ", quoted(description.shape),
           "; allowed are box, sphere, plane, capsule, cylinder, cone and hull");
  body.shape = shape->second;
  if (body.shape != BodyShape::Plane) body.half_size = halfSizeOf(description);
  if (body.shape == BodyShape::Hull) {
    const DrawnHull& hull = hulls.find(description);
    body.hull = hull.mesh;
    body.middle = hull.middle;
  }
  if (body.shape == BodyShape::Cone) body.middle.z = 0.5f * body.half_size.z;
  body.color = colorOf(description);
  body.is_dynamic = description.kind == "dynamic";
  body.is_static = description.kind == "static";
  const auto& friction = description.material.friction;
  body.friction = friction.empty() || !std::isfinite(friction[0]) ? 0.0 : std::max(0.0, friction[0]);
  return body;
}

BodyPlace readPlace(const geometry_msgs::Pose& pose, const geometry_msgs::Twist& twist, std::uint64_t id) {
  if (!areCoordinates(pose.position)) refuse("the position of the body with the id ", id, " is not finite");
  const auto& q = pose.orientation;
  const double norm = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  constexpr double kNearUnit = 0.1;
  if (!(std::abs(norm - 1.0) <= kNearUnit))
    refuse("the orientation of the body with the id ", id, " has the length ", norm, "; allowed is 1");
  if (!areCoordinates(twist.linear) || !areCoordinates(twist.angular))
    refuse("the velocity of the body with the id ", id, " is not finite");
  const auto part = [norm](double value) { return static_cast<float>(value / norm); };
  return {toOgre(pose.position), Ogre::Quaternion(part(q.w), part(q.x), part(q.y), part(q.z)),
          toOgre(twist.linear), toOgre(twist.angular).length()};
}

}  // namespace

std::shared_ptr<const BodyCatalog> readDescriptions(const rigid_body_sim::BodyDescriptions& message,
                                                    DrawnHulls& hulls) {
  HullShelf shelf{hulls, {}};
  auto catalog = std::make_shared<BodyCatalog>();
  catalog->version = message.version;
  catalog->frame = message.header.frame_id;
  catalog->bodies.reserve(message.bodies.size());
  for (const BodyDescription& description : message.bodies) {
    catalog->by_name[description.name] = catalog->bodies.size();
    catalog->bodies.push_back(readBody(description, shelf));
  }
  hulls = std::move(shelf.now);
  return catalog;
}

std::shared_ptr<const BodyFrame> readStates(const rigid_body_sim::BodyStates& message, double arrival) {
  const std::size_t count = message.ids.size();
  if (message.poses.size() != count || message.twists.size() != count)
    refuse("there are ", count, " ids, ", message.poses.size(), " poses and ", message.twists.size(),
           " twists; they must be as many");
  auto frame = std::make_shared<BodyFrame>();
  frame->stamp = message.header.stamp.toSec();
  frame->arrival = arrival;
  frame->version = message.version;
  frame->ids = message.ids;
  frame->places.reserve(count);
  for (std::size_t k = 0; k < count; ++k)
    frame->places.push_back(readPlace(message.poses[k], message.twists[k], message.ids[k]));
  return frame;
}

bool match(const BodyCatalog& catalog, const BodyFrame& frame) {
  return catalog.version == frame.version &&
         std::equal(catalog.bodies.begin(), catalog.bodies.end(), frame.ids.begin(), frame.ids.end(),
                    [](const CatalogBody& body, std::uint64_t id) { return body.id == id; });
}

}  // namespace rbs
