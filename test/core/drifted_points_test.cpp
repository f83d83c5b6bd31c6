// SPDX-License-Identifier: BSD-3-Clause
// Contact points are found anew where a pair has moved. Along a plane nothing changes: it is the same everywhere.
#include "solver/solver_contacts.h"

#include "make_scene.h"
#include "solver_scene.h"

#include <gtest/gtest.h>

namespace rbs::test {
namespace {

constexpr double kStep = 1.0 / 60.0, kSize = 0.2;

// Whether the points of a body on another one are found anew when it has moved by `way_W`.
bool areFoundAnew(const Shape& shape, const Shape& under, const Vec3& way_W) {
  SolverScene scene;
  BodyDef carrier = body("carrier", under, Vec3(0.0, 0.0, std::holds_alternative<Plane>(under) ? 0.0 : -0.5));
  carrier.kind = BodyKind::Static;
  scene.store.bodies.append({1}, carrier);
  scene.store.bodies.append({2}, body("carried", shape, Vec3(0.0, 0.0, 0.5 * kSize)));
  scene.begin(kStep);
  scene.touch(0, 1);
  SolverContacts::Stores stores;
  SolverContacts contacts(scene.context, scene.batch, stores);
  contacts.find(0.0, kStep, kStep / 8.0);
  EXPECT_GT(contacts.blocks.front().size, 0);
  EXPECT_TRUE(contacts.drifted().empty()) << "it has not moved";
  for (SolverBody& s : contacts.bodies)
    if (s.inv_mass > 0.0) s.moved += way_W;
  return !contacts.drifted().empty();
}

TEST(DriftedPoints, AlongAPlaneNoneAreFoundAnew) {
  const Shape plane = Plane{}, slab = Box{Vec3(10.0, 10.0, 1.0)};
  for (const Shape& shape : {Shape(Sphere{0.5 * kSize}), Shape(Box{Vec3(kSize, kSize, kSize)})}) {
    EXPECT_FALSE(areFoundAnew(shape, plane, Vec3(3.0, -2.0, 0.0)));
    EXPECT_TRUE(areFoundAnew(shape, plane, Vec3(3.0, -2.0, 0.1 * kSize))) << "it comes off";
    EXPECT_TRUE(areFoundAnew(shape, slab, Vec3(0.1 * kSize, 0.0, 0.0))) << "a box has an end";
    EXPECT_FALSE(areFoundAnew(shape, slab, Vec3(0.01 * kSize, 0.0, 0.0)));
  }
}

}  // namespace
}  // namespace rbs::test
