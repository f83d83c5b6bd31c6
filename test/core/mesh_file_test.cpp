// SPDX-License-Identifier: BSD-3-Clause
// Mesh files: the same block in several formats makes the same hull, transforms and units are heeded, and
// what is no mesh is refused with its name.
#include "rigid_body_sim/mesh_file.h"

#include "rigid_body_sim/scenes.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

namespace rbs {
namespace {

namespace fs = std::filesystem;

// A tetrahedron with its right corner at the origin.
const std::string kObj = R"(v 0 0 0
v 2 0 0
v 0 3 0
v 0 0 4
f 1 3 2
f 1 2 4
f 1 4 3
f 2 3 4
)";

const std::string kStl = R"(solid corner
facet normal 0 0 -1
outer loop
vertex 0 0 0
vertex 0 3 0
vertex 2 0 0
endloop
endfacet
facet normal 0 -1 0
outer loop
vertex 0 0 0
vertex 2 0 0
vertex 0 0 4
endloop
endfacet
facet normal -1 0 0
outer loop
vertex 0 0 0
vertex 0 0 4
vertex 0 3 0
endloop
endfacet
facet normal 1 1 1
outer loop
vertex 2 0 0
vertex 0 3 0
vertex 0 0 4
endloop
endfacet
endsolid corner
)";

/// The corner in centimetres and z up, in a node moved by 100 cm along x in one turned by 90 degrees about z.
const std::string kCollada = R"(<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
  <asset><unit name="centimeter" meter="0.01"/><up_axis>Z_UP</up_axis></asset>
  <library_geometries><geometry id="g"><mesh>
    <source id="p"><float_array id="a" count="12">0 0 0 2 0 0 0 3 0 0 0 4</float_array>
      <technique_common><accessor source="#a" count="4" stride="3">
        <param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>
      </accessor></technique_common></source>
    <vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
    <triangles count="4"><input semantic="VERTEX" source="#v" offset="0"/>
      <p>0 2 1 0 1 3 0 3 2 1 2 3</p></triangles>
  </mesh></geometry></library_geometries>
  <library_visual_scenes><visual_scene id="s">
    <node id="turned"><rotate>0 0 1 90</rotate>
      <node id="moved"><translate>100 0 0</translate><instance_geometry url="#g"/></node></node>
  </visual_scene></library_visual_scenes>
  <scene><instance_visual_scene url="#s"/></scene>
</COLLADA>
)";

class MeshFile : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_ / "sub"); }
  void TearDown() override { fs::remove_all(folder_); }

  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return (folder_ / name).string();
  }
  Problem refusal(const std::string& location, const std::string& folder = "") const {
    try {
      hullOfMesh(location, folder, 1.0, "body.mesh");
    } catch (const InvalidInput& error) {
      EXPECT_EQ(error.problems().size(), 1u);
      return error.problems()[0];
    }
    ADD_FAILURE() << location << " was taken";
    return {};
  }

  fs::path folder_ = fs::temp_directory_path() / ("mesh_file_test_" + std::to_string(getpid()));
};

TEST_F(MeshFile, formatsMakeTheSameHull) {
  const PlacedHull obj = hullOfMesh(write("corner.obj", kObj), "", 1.0, "mesh");
  EXPECT_DOUBLE_EQ(volume(obj.hull), 4.0);
  EXPECT_TRUE(obj.X_PB.p_WB.isApprox(Vec3(0.5, 0.75, 1.0), 1e-15));
  EXPECT_EQ(obj.hull.polyhedron->vertices.size(), 4u);
  const PlacedHull stl = hullOfMesh(write("corner.stl", kStl), "", 1.0, "mesh");
  EXPECT_DOUBLE_EQ(volume(stl.hull), 4.0);
  EXPECT_TRUE(stl.X_PB.p_WB.isApprox(obj.X_PB.p_WB, 1e-15));
}

TEST_F(MeshFile, nodesAndUnitsOfColladaAreHeeded) {
  const std::vector<Vec3> points = readMesh(write("corner.dae", kCollada), "", "mesh");
  std::vector<Vec3> expected{{0, 1, 0}, {0, 1.02, 0}, {-0.03, 1, 0}, {0, 1, 0.04}};
  for (const Vec3& corner : expected) {
    bool found = false;
    for (const Vec3& p : points) found |= (p - corner).norm() < 1e-6;
    EXPECT_TRUE(found) << corner.transpose();
  }
}

TEST_F(MeshFile, scaleMultipliesTheCoordinates) {
  const PlacedHull large = hullOfMesh(write("corner.obj", kObj), "", 10.0, "mesh");
  EXPECT_DOUBLE_EQ(volume(large.hull), 4000.0);
  EXPECT_TRUE(large.X_PB.p_WB.isApprox(Vec3(5.0, 7.5, 10.0), 1e-15));
}

TEST_F(MeshFile, isFoundByPathBesideTheSceneAndInAPackage) {
  const std::string file = write("sub/corner.obj", kObj);
  EXPECT_EQ(readMesh("sub/corner.obj", folder_.string(), "mesh").size(), readMesh(file, "", "mesh").size());
  findPackagesBy([this](const std::string& package) { return package == "mine" ? folder_.string() : ""; });
  EXPECT_FALSE(readMesh("package://mine/sub/corner.obj", "", "mesh").empty());
  EXPECT_EQ(refusal("package://other/sub/corner.obj").allowed, "a package that can be found");
  EXPECT_EQ(refusal("package://mine").value, "'package://mine'");

  const std::string scene = write("scene.yaml", R"(
bodies:
  - {name: near, shape: hull, mesh: sub/corner.obj, position: [1, 2, 3]}
  - {name: far, shape: hull, mesh: package://mine/sub/corner.obj, scale: 2, repeat: {count: [3, 1, 1], spacing: [9, 0, 0]}}
)");
  const std::vector<BodyDef> bodies = readScene(scene).scene.bodies;
  ASSERT_EQ(bodies.size(), 4u);
  EXPECT_TRUE(bodies[0].pose.p_WB.isApprox(Vec3(1.5, 2.75, 4.0), 1e-15));
  EXPECT_DOUBLE_EQ(volume(bodies[3].shape), 32.0);
  EXPECT_EQ(std::get<ConvexHull>(bodies[1].shape).polyhedron,
            std::get<ConvexHull>(bodies[3].shape).polyhedron);
}

TEST_F(MeshFile, whatIsNoMeshIsRefusedByItsName) {
  const std::string missing = (folder_ / "missing.stl").string();
  EXPECT_EQ(refusal(missing).value, "'" + missing + "': no such file");
  EXPECT_EQ(refusal(missing).path, "body.mesh");
  EXPECT_EQ(refusal(folder_.string()).value, "'" + folder_.string() + "': not a regular file");
  EXPECT_EQ(refusal("relative.stl").allowed, "an absolute path or package://NAME/FILE");
  EXPECT_EQ(refusal("").allowed, "an absolute path or package://NAME/FILE");

  const std::string binary("\x00\x01\x02\xff garbage", 13);
  const std::pair<const char*, std::string> files[] = {
      {"empty.stl", ""},
      {"empty.obj", ""},
      {"empty.dae", ""},
      {"garbage.stl", binary},
      {"garbage.obj", binary},
      {"garbage.ply", binary},
      {"no_faces.stl", "solid none\nendsolid none\n"},
      {"cut.dae", kCollada.substr(0, kCollada.size() / 2)},
      {"cut.stl", std::string(80, '\0') + std::string("\xff\xff\xff\x7f", 4) + std::string(50, '\0')},
      {"text.xyz", "hello"},
      {"nan.obj", "v nan 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 1 3 4\nf 2 3 4\n"},
      {"flat.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n"},
      {"index.obj", "v 0 0 0\nv 1 0 0\nf 1 2 99\n"},
  };
  for (const auto& [name, text] : files) {
    const std::string file = write(name, text);
    const Problem problem = refusal(file);
    EXPECT_NE(problem.value.find(file), std::string::npos) << name << ": " << problem.value;
    EXPECT_GT(problem.value.size(), file.size() + 5) << name;
  }
}

}  // namespace
}  // namespace rbs
