// SPDX-License-Identifier: BSD-3-Clause
// The catalogue: every scene is sound, says what it shows, starts without overlaps, and is found by name.
#include "rigid_body_sim/scenes.h"

#include "narrowphase/collide.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>

namespace rbs {
namespace {

SceneDef scene(const std::string& name) {
  return readScene(findScene(RBS_SCENES, name)).scene;
}

std::string messageFor(const std::string& name) {
  try {
    findScene(RBS_SCENES, name);
    return "";
  } catch (const InvalidInput& error) {
    return error.what();
  }
}

const BodyDef& body(const SceneDef& scene, const std::string& name) {
  const auto found = std::find_if(scene.bodies.begin(), scene.bodies.end(),
                                  [&](const BodyDef& candidate) { return candidate.name == name; });
  if (found == scene.bodies.end()) throw std::out_of_range(name);
  return *found;
}

class Catalogue : public testing::TestWithParam<std::string> {};

std::vector<std::string> names() {
  std::vector<std::string> names;
  for (const SceneEntry& entry : listScenes(RBS_SCENES)) names.push_back(entry.name);
  return names;
}

INSTANTIATE_TEST_SUITE_P(Scenes, Catalogue, testing::ValuesIn(names()),
                         [](const auto& info) { return info.param; });

TEST_P(Catalogue, saysWhatItShows) {
  const SceneDef def = scene(GetParam());
  EXPECT_EQ(def.name, GetParam());
  EXPECT_GT(def.property.size(), 20u);
  EXPECT_EQ(def.property.back(), '.');
}

TEST_P(Catalogue, startsWithoutOverlaps) {
  const SceneDef def = scene(GetParam());
  const std::vector<BodyDef>& bodies = def.bodies;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    for (std::size_t j = i + 1; j < bodies.size(); ++j) {
      if (bodies[i].kind != BodyKind::Dynamic && bodies[j].kind != BodyKind::Dynamic) continue;
      const double reach = boundingRadius(bodies[i].shape) + boundingRadius(bodies[j].shape);
      if ((bodies[i].pose.p_WB - bodies[j].pose.p_WB).norm() > reach) continue;
      const Gap between = gap(bodies[i].shape, bodies[i].pose, bodies[j].shape, bodies[j].pose);
      const double rounding = 1e-12 * (bodies[i].pose.p_WB.norm() + bodies[j].pose.p_WB.norm());
      EXPECT_GE(between.distance, -rounding) << bodies[i].name << " and " << bodies[j].name;
    }
  }
}

TEST_P(Catalogue, isWrittenAndReadBack) {
  const SceneDef def = scene(GetParam());
  EXPECT_EQ(writeScene(parseScene(writeScene(def), "again.yaml").scene), writeScene(def));
}

TEST(Scenes, catalogueHoldsTheDocumentedScenes) {
  EXPECT_EQ(names(),
            (std::vector<std::string>{
                "ball_hits_wall", "balls_666",      "bouncing_49", "boxes_on_slope", "bullet_and_paper",
                "card_house",     "domino_ring",    "dominoes",    "elastic_666",    "gas",
                "harbour",        "heavy_on_light", "jenga",       "kapla",          "marbles",
                "mixed_rain",     "newtons_cradle", "playground",  "pyramid",        "rolling_balls",
                "shapes",         "sphere_column",  "sphere_rain", "spinning_box",   "tower",
                "windy_day"}));
}

TEST(Scenes, sizesAreAsDescribed) {
  EXPECT_EQ(scene("tower").bodies.size(), 1u + 10u);
  EXPECT_EQ(scene("dominoes").bodies.size(), 1u + 15u + 1u);
  EXPECT_EQ(scene("pyramid").bodies.size(), 1u + 210u);
  EXPECT_EQ(scene("sphere_rain").bodies.size(), 5u + 500u);
  EXPECT_EQ(scene("mixed_rain").bodies.size(), 5u + 500u);
}

TEST(Scenes, cradleBallsTouchExactly) {
  const SceneDef def = scene("newtons_cradle");
  const char* const row[] = {"first", "ball_1", "ball_2", "ball_3", "last"};
  for (int i = 0; i + 1 < 5; ++i) {
    const double distance = body(def, row[i + 1]).pose.p_WB.x() - body(def, row[i]).pose.p_WB.x();
    EXPECT_EQ(distance, fullExtents(body(def, row[i]).shape).x());
  }
}

TEST(Scenes, slopeFrictionSpansTheAngleOfRepose) {
  const SceneDef def = scene("boxes_on_slope");
  const double slope = body(def, "slope").material.friction;
  const auto pair = [&](const char* name) { return std::sqrt(slope * body(def, name).material.friction); };
  const double steepness = std::tan(25.0 * 3.14159265358979323846 / 180.0);
  EXPECT_GT(pair("rough"), steepness);
  EXPECT_LT(pair("smooth"), steepness);
  const Vec3 tall = fullExtents(body(def, "tall").shape);
  EXPECT_GT(pair("tall"), steepness);
  EXPECT_LT(tall.x() / tall.z(), steepness);
}

TEST(Scenes, unknownNameListsTheCatalogue) {
  const std::string message = messageFor("towr");
  EXPECT_EQ(message.find(
                "unknown scene 'towr'; did you mean 'tower'? scenes: ball_hits_wall, balls_666, bouncing_49"),
            0u)
      << message;
  EXPECT_EQ(messageFor("qqqqqq").find("unknown scene 'qqqqqq'; scenes: ball_hits_wall"), 0u);
  EXPECT_NE(messageFor(""), "");
}

TEST(Scenes, pathsAreTakenAsTheyAre) {
  EXPECT_EQ(findScene(RBS_SCENES, "/no/such/x"), "/no/such/x");
  EXPECT_EQ(findScene(RBS_SCENES, "x.yaml"), "x.yaml");
}

TEST(Scenes, theEndingOfAPathMayBeLeftOut) {
  const std::string file = RBS_SCENES "/tower.yaml";
  EXPECT_EQ(findScene("/no/such/folder", RBS_SCENES "/tower"), file);
  EXPECT_EQ(findScene("/no/such/folder", file), file);
}

TEST(Scenes, missingFolderIsRefused) {
  EXPECT_THROW(listScenes("/no/such/folder"), InvalidInput);
}

TEST(Scenes, faultySceneHidesNoOther) {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("scenes_test_" + std::to_string(std::random_device{}()));
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "good.yaml") << "property: It is good.";
  std::ofstream(folder / "bad.yaml") << "step: -1";
  std::ofstream(folder / "notes.txt") << "no scene";
  const std::vector<SceneEntry> entries = listScenes(folder.string());
  std::filesystem::remove_all(folder);
  ASSERT_EQ(entries.size(), 2u);
  EXPECT_EQ(entries[0].name, "bad");
  EXPECT_EQ(entries[0].property.find("faulty: "), 0u);
  EXPECT_EQ(entries[1].property, "It is good.");
}

}  // namespace
}  // namespace rbs
