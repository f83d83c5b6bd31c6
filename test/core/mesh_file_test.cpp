// SPDX-License-Identifier: BSD-3-Clause
// Mesh files: the same block in several formats makes the same hull, transforms and units are heeded, and
// what is no mesh is refused with its name.
#include "rigid_body_sim/mesh_file.h"

#include "rigid_body_sim/file_access.h"
#include "rigid_body_sim/scenes.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
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
  /// The coordinates of the corner as glTF holds them.
  static std::string cornerBuffer() {
    const float numbers[] = {0, 0, 0, 2, 0, 0, 0, 3, 0, 0, 0, 4};
    return {reinterpret_cast<const char*>(numbers), sizeof numbers};
  }
  static std::string gltf(const std::string& uri, int count = 4) {
    return R"({"scene": 0, "scenes": [{"nodes": [0]}],
      "nodes": [{"children": [1], "translation": [1, 0, 0]}, {"mesh": 0, "rotation": [0, 0, 0.70710678, 0.70710678]}],
      "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
      "accessors": [{"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": )" +
           std::to_string(count) + R"(}], "bufferViews": [{"buffer": 0, "byteLength": 48}],
      "buffers": [{"byteLength": 48)" +
           uri + "}]}";
  }
  static std::string glb(std::string json, const std::string& buffer) {
    json.resize((json.size() + 3) / 4 * 4, ' ');
    const auto word = [](std::size_t n) {
      const auto bits = static_cast<std::uint32_t>(n);
      return std::string(reinterpret_cast<const char*>(&bits), 4);
    };
    return "glTF" + word(2) + word(28 + json.size() + buffer.size()) + word(json.size()) + "JSON" + json +
           word(buffer.size()) + std::string("BIN\0", 4) + buffer;
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

TEST_F(MeshFile, plyIsReadAsTextAndBinaryOfBothByteOrders) {
  const std::vector<Vec3> corners{{0, 0, 0}, {2, 0, 0}, {0, 3, 0}, {0, 0, 4}};
  const std::string head =
      "\nelement extra 1\nproperty list uchar short s\nelement vertex 4\nproperty float nx\n"
      "property double x\nproperty double y\nproperty double z\nend_header\n";
  EXPECT_EQ(readMesh(write("text.ply",
                           "ply\nformat ascii 1.0" + head + "2 7 7\n9 0 0 0\n9 2 0 0\n9 0 3 0\n9 0 0 4\n"),
                     "", "mesh"),
            corners);
  for (const bool big : {false, true}) {
    std::string bytes = std::string("ply\nformat binary_") + (big ? "big" : "little") + "_endian 1.0" + head;
    const auto put = [&](auto number) {
      std::string raw(sizeof number, '\0');
      std::memcpy(raw.data(), &number, sizeof number);
      if (big) std::reverse(raw.begin(), raw.end());
      bytes += raw;
    };
    put(std::uint8_t{2}), put(std::int16_t{7}), put(std::int16_t{7});
    for (const Vec3& p : corners) put(9.0f), put(p.x()), put(p.y()), put(p.z());
    EXPECT_EQ(readMesh(write("binary.ply", bytes), "", "mesh"), corners) << big;
    bytes.pop_back();
    EXPECT_NE(refusal(write("cut.ply", bytes)).value.find("ends"), std::string::npos);
  }
}

TEST_F(MeshFile, gltfIsReadWithItsNodesAndBuffers) {
  const std::vector<Vec3> expected{
      {1, 0, 0}, {1, 2, 0}, {-2, 0, 0}, {1, 0, 4}};  // a quarter turn about z, then 1 m along x
  const auto isExpected = [&](const std::vector<Vec3>& points) {
    ASSERT_EQ(points.size(), expected.size());
    for (std::size_t k = 0; k < points.size(); ++k) EXPECT_TRUE((points[k] - expected[k]).norm() < 1e-6) << k;
  };
  write("sub/corner.bin", cornerBuffer());
  isExpected(readMesh(write("beside.gltf", gltf(R"(, "uri": "sub/corner.bin")")), "", "mesh"));
  const std::string data = "AAAAAAAAAAAAAAAAAAAAQAAAAAAAAAAAAAAAAAAAQEAAAAAAAAAAAAAAAAAAAIBA";
  isExpected(
      readMesh(write("data.gltf", gltf(R"(, "uri": "data:application/octet-stream;base64,)" + data + '"')),
               "", "mesh"));
  isExpected(readMesh(write("corner.glb", glb(gltf(""), cornerBuffer())), "", "mesh"));
}

TEST_F(MeshFile, buffersOfGltfDoNotLeadOutOfItsFolder) {
  std::ofstream(folder_ / "secret.bin") << cornerBuffer();
  fs::create_symlink(folder_ / "secret.bin", folder_ / "sub/link.bin");
  for (const std::string& uri :
       {std::string("../secret.bin"), (folder_ / "secret.bin").string(), std::string("link.bin"),
        std::string("/dev/zero"), std::string("missing.bin")}) {
    const Problem problem = refusal(write("sub/out.gltf", gltf(", \"uri\": \"" + uri + '"')));
    EXPECT_TRUE(problem.value.find("the buffer") != std::string::npos ||
                problem.value.find("no such file") != std::string::npos)
        << problem.value;
  }
}

// A file of some hundred bytes may place a mesh very often, and nodes that place nodes that place nodes.
TEST_F(MeshFile, pointsAreCountedBeforeThereIsRoomForThem) {
  std::string nodes, indices;
  for (int k = 0; k < 300'000; ++k) {
    nodes += k ? ",{\"mesh\":0}" : "{\"mesh\":0}";
    indices += (k ? "," : "") + std::to_string(k);
  }
  const std::string many =
      R"({"scenes":[{"nodes":[)" + indices + R"(]}],"nodes":[)" + nodes +
      R"(],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"accessors":[{"count":4}]})";
  const Problem placed = refusal(write("many.gltf", many));
  EXPECT_NE(placed.allowed.find("100000"), std::string::npos) << placed.value << ": " << placed.allowed;
  EXPECT_NE(refusal(write("huge.gltf", gltf("", 4'000'000))).allowed.find("1000000 points"),
            std::string::npos);
  EXPECT_NE(refusal(write("huge.ply",
                          "ply\nformat ascii 1.0\nelement vertex 9999999999\nproperty float x\nend_header\n"))
                .allowed.find("1000000 points"),
            std::string::npos);

  std::string library;
  for (int level = 0; level < 30; ++level) {
    const std::string next = "<instance_node url=\"#n" + std::to_string(level + 1) + "\"/>";
    library += "<node id=\"n" + std::to_string(level) + "\">" + next + next + "</node>";
  }
  std::string laughs = kCollada;
  laughs.replace(laughs.find("<library_visual_scenes>"), 0,
                 "<library_nodes>" + library +
                     "<node id=\"n30\"><instance_geometry url=\"#g\"/></node></library_nodes>");
  laughs.replace(laughs.find("<instance_geometry url=\"#g\"/></node></node>"), 29,
                 "<instance_node url=\"#n0\"/>");
  EXPECT_NE(refusal(write("laughs.dae", laughs)).allowed.find("1000000"), std::string::npos);
  std::string loop = kCollada;
  loop.replace(loop.find("<instance_geometry"), 29, "<instance_node url=\"#turned\"/>");
  EXPECT_NE(refusal(write("loop.dae", loop)).value.find("nested"), std::string::npos);
}

TEST_F(MeshFile, filesAreConfinedToAFolder) {
  const std::string inside = write("sub/corner.obj", kObj), outside = write("corner.obj", kObj);
  confineFilesTo((folder_ / "sub").string());
  EXPECT_EQ(readMesh(inside, "", "mesh").size(), 4u);
  EXPECT_NE(refusal(outside).allowed.find("confined"), std::string::npos);
  EXPECT_NE(refusal((folder_ / "sub/../corner.obj").string()).allowed.find("confined"), std::string::npos);
  fs::create_symlink(outside, folder_ / "sub/link.obj");
  EXPECT_NE(refusal((folder_ / "sub/link.obj").string()).allowed.find("confined"), std::string::npos);
  EXPECT_EQ(readMesh("corner.obj", folder_.string(), "mesh").size(), 4u) << "beside its scene";
  confineFilesTo("");
  EXPECT_EQ(readMesh(outside, "", "mesh").size(), 4u);
  EXPECT_THROW(confineFilesTo("relative"), InvalidInput);
  EXPECT_THROW(confineFilesTo((folder_ / "nowhere").string()), InvalidInput);
}

TEST_F(MeshFile, readingIsInterrupted) {
  const std::string file = write("corner.obj", kObj);
  interruptReadingBy([] { return true; });
  const Problem problem = refusal(file);
  interruptReadingBy(nullptr);
  EXPECT_EQ(problem.value, "interrupted");
  EXPECT_EQ(readMesh(file, "", "mesh").size(), 4u);
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
      {"scene.blend", "BLENDER"},
      {"empty.gltf", "{}"},
      {"deep.gltf", std::string(100'000, '[')},
      {"version.glb", "glTF" + std::string(30, '\1')},
      {"list.ply",
       "ply\nformat ascii 1.0\nelement vertex 1\nproperty list float float x\nend_header\n1e18 1 2 3\n"},
      {"deep.dae", "<COLLADA>" +
                       [] {
                         std::string nested;
                         for (int k = 0; k < 100'000; ++k) nested += "<node>";
                         return nested;
                       }()},
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
