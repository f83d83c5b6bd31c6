// SPDX-License-Identifier: BSD-3-Clause
// The parts of the Bodies display that need no RViz: reading messages, playback, colours, meshes.
#include "body_catalog.h"
#include "body_colors.h"
#include "body_details.h"
#include "body_mesh.h"
#include "body_playback.h"
#include "length_text.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rbs {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

rigid_body_sim::BodyDescriptions descriptions(std::uint64_t version, std::size_t count) {
  rigid_body_sim::BodyDescriptions message;
  message.version = version;
  for (std::size_t k = 0; k < count; ++k) {
    rigid_body_sim::BodyDescription body;
    body.id = k + 1;
    body.name = "body_" + std::to_string(k + 1);
    body.shape = "box";
    body.kind = "dynamic";
    body.size.x = body.size.y = body.size.z = 1.0;
    body.color.a = 1.0f;
    message.bodies.push_back(body);
  }
  return message;
}

std::shared_ptr<const BodyCatalog> read(const rigid_body_sim::BodyDescriptions& message) {
  DrawnHulls hulls;
  return readDescriptions(message, hulls);
}

rigid_body_sim::BodyStates states(std::uint64_t version, double stamp, const std::vector<double>& xs,
                                  double speed = 0.0) {
  rigid_body_sim::BodyStates message;
  message.version = version;
  message.header.stamp = ros::Time(stamp);
  for (std::size_t k = 0; k < xs.size(); ++k) {
    message.ids.push_back(k + 1);
    geometry_msgs::Pose pose;
    pose.position.x = xs[k];
    pose.orientation.w = 1.0;
    message.poses.push_back(pose);
    geometry_msgs::Twist twist;
    twist.linear.x = speed;
    message.twists.push_back(twist);
  }
  return message;
}

/// One body at x(t) = t, seen ten times a second.
BodyPlayback steadyMotion() {
  BodyPlayback playback;
  playback.add(read(descriptions(1, 1)));
  for (int k = 0; k <= 10; ++k)
    playback.add(readStates(states(1, 1.0 + 0.1 * k, {1.0 + 0.1 * k}, 1.0), 100.0 + 0.1 * k));
  return playback;
}

TEST(BodyPlayback, MovesEvenlyBetweenMessages) {
  BodyPlayback playback = steadyMotion();
  double last = playback.at(100.87)[0].position.x;
  for (double now = 100.88; now < 101.1; now += 0.01) {
    const double x = playback.at(now)[0].position.x;
    EXPECT_NEAR(x - last, 0.01, 1e-4) << now;
    last = x;
  }
}

TEST(BodyPlayback, DoesNotExtrapolate) {
  BodyPlayback playback = steadyMotion();
  EXPECT_FLOAT_EQ(playback.at(200.0)[0].position.x, 2.0f);
  EXPECT_DOUBLE_EQ(playback.stamp(), 2.0);
}

TEST(BodyPlayback, DoesNotInterpolateAJump) {
  BodyPlayback playback = steadyMotion();
  playback.add(readStates(states(1, 2.1, {50.0}, 1.0), 101.1));
  for (double now = 101.0; now < 101.4; now += 0.01) {
    const double x = playback.at(now)[0].position.x;
    EXPECT_TRUE(x <= 2.0 + 1e-4 || x == 50.0) << x;
  }
  EXPECT_FLOAT_EQ(playback.at(102.0)[0].position.x, 50.0f);
}

TEST(BodyPlayback, ShowsAStampThatGoesBackAtOnce) {
  BodyPlayback playback = steadyMotion();
  playback.at(101.0);
  playback.add(readStates(states(1, 1.0, {0.5}), 101.1));
  EXPECT_FLOAT_EQ(playback.at(101.1)[0].position.x, 0.5f);
}

TEST(BodyPlayback, WaitsForTheDescriptionsOfAState) {
  BodyPlayback playback = steadyMotion();
  playback.add(readStates(states(2, 2.1, {3.0, 4.0}), 101.1));
  EXPECT_TRUE(playback.waits());
  EXPECT_EQ(playback.awaitedVersion(), 2u);
  EXPECT_EQ(playback.at(102.0).size(), 1u);
  playback.add(read(descriptions(2, 2)));
  EXPECT_FALSE(playback.waits());
  EXPECT_EQ(playback.at(102.0).size(), 2u);
  EXPECT_EQ(playback.catalog()->version, 2u);
}

TEST(BodyPlayback, KeepsWhatIsShownUntilAStateGoesWithNewDescriptions) {
  BodyPlayback playback = steadyMotion();
  playback.add(read(descriptions(2, 2)));
  EXPECT_EQ(playback.catalog()->version, 1u);
  EXPECT_EQ(playback.at(102.0).size(), 1u);
  playback.add(readStates(states(2, 2.1, {3.0, 4.0}), 101.1));
  EXPECT_EQ(playback.catalog()->version, 2u);
}

// A simulator that starts again counts its versions again.
TEST(BodyPlayback, DoesNotMixOneVersionOfTwoSimulators) {
  BodyPlayback playback = steadyMotion();
  playback.add(readStates(states(1, 1.0, {3.0, 4.0}), 101.1));
  EXPECT_TRUE(playback.waits());
  playback.add(read(descriptions(1, 2)));
  EXPECT_EQ(playback.at(102.0).size(), 2u);
}

TEST(PlaybackClock, NeverGoesBackWhereMessagesAreLate) {
  PlaybackClock clock;
  double last = 0.0;
  for (int k = 0; k < 100; ++k) {
    const double late = k % 20 == 0 ? 0.2 : 0.0;
    clock.add(0.0125 * k, 10.0 + 0.0125 * k + late);
    const double shown = clock.at(10.0 + 0.0125 * k + late);
    EXPECT_GE(shown, last);
    EXPECT_LE(shown, 0.0125 * k);
    last = shown;
  }
  EXPECT_DOUBLE_EQ(clock.at(1000.0), 0.0125 * 99);
}

TEST(ReadStates, RefusesWhatIsNotFinite) {
  for (const double bad : {kNan, std::numeric_limits<double>::infinity(), 1e300})
    EXPECT_THROW(readStates(states(1, 1.0, {bad}), 0.0), BadMessage);
  auto message = states(1, 1.0, {0.0});
  message.poses[0].orientation.w = 0.0;
  EXPECT_THROW(readStates(message, 0.0), BadMessage);
  message = states(1, 1.0, {0.0});
  message.twists.clear();
  EXPECT_THROW(readStates(message, 0.0), BadMessage);
}

TEST(ReadDescriptions, RefusesWhatCannotBeDrawnAndNamesTheBody) {
  const auto complaintOf = [](auto change) {
    auto message = descriptions(1, 1);
    change(message.bodies[0]);
    try {
      read(message);
    } catch (const BadMessage& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const auto names = [](const std::string& text) { return text.find("'body_1'") != std::string::npos; };
  EXPECT_PRED1(names, complaintOf([](auto& body) { body.size.y = kNan; }));
  EXPECT_PRED1(names, complaintOf([](auto& body) { body.size.y = 0.0; }));
  EXPECT_PRED1(names, complaintOf([](auto& body) { body.shape = "pear"; }));
  EXPECT_PRED1(names, complaintOf([](auto& body) { body.shape = "hull"; }));
  EXPECT_PRED1(names, complaintOf([](auto& body) { body.color.g = std::nanf(""); }));
}

using rigid_body_sim::BodyDetails;

BodyDetails details(const std::vector<std::uint64_t>& ids) {
  BodyDetails message;
  message.ids = ids;
  message.methods.assign(ids.size(), BodyDetails::SOFT_STEP);
  message.islands.assign(ids.size(), 1);
  return message;
}

TEST(ReadDetails, FindsEachBodyByItsId) {
  const auto catalog = read(descriptions(1, 3));
  BodyDetails message = details({3, 7, 1});
  message.methods[0] = BodyDetails::FLIGHT;
  message.islands[0] = 3;
  message.reference_distances = {0.25, 9.0, 0.0};
  const auto read = readDetails(message, *catalog);
  ASSERT_EQ(read.size(), 3u);
  EXPECT_EQ(read[2].method, BodyDetails::FLIGHT);
  EXPECT_EQ(read[2].island, 3u);
  EXPECT_EQ(read[2].distance, 0.25f);
  EXPECT_EQ(read[0].distance, 0.0f);
  EXPECT_EQ(read[1].method, BodyDetails::NONE) << "the message does not know it";
  EXPECT_FALSE(read[1].distance);
}

TEST(ReadDetails, RefusesWhatMakesNoSense) {
  const auto catalog = read(descriptions(1, 2));
  const auto refuses = [&](auto change) {
    BodyDetails message = details({1, 2});
    change(message);
    EXPECT_THROW(readDetails(message, *catalog), BadMessage);
  };
  refuses([](BodyDetails& message) { message.methods.pop_back(); });
  refuses([](BodyDetails& message) { message.islands.pop_back(); });
  refuses([](BodyDetails& message) { message.methods[1] = 200; });
  refuses([](BodyDetails& message) { message.reference_distances = {0.0}; });
  refuses([](BodyDetails& message) { message.reference_distances = {0.0, kNan}; });
  refuses([](BodyDetails& message) { message.reference_distances = {0.0, -1.0}; });
}

/// The colours of bodies with these details; the last body is static.
std::vector<Ogre::ColourValue> coloursOf(const std::vector<BodyDetail>& details, const Coloring& coloring) {
  auto message = descriptions(1, details.size());
  message.bodies.back().kind = "static";
  return colorsOf(*read(message), std::vector<BodyPlace>(details.size()), details, coloring);
}

TEST(Colors, OfIslandsAreSharedWithinThemAlone) {
  const auto colors = coloursOf({{BodyDetails::SOFT_STEP, 1, {}},
                                 {BodyDetails::SOFT_STEP, 1, {}},
                                 {BodyDetails::NEWTON, 3, {}},
                                 {BodyDetails::FLIGHT, 4, {}},
                                 {BodyDetails::BALLISTIC, 0, {}},
                                 {BodyDetails::NONE, 0, {}}},
                                {ColorBy::Island});
  EXPECT_EQ(colors[0], colors[1]);
  EXPECT_NE(colors[0], colors[2]);
  EXPECT_EQ(colors[3], colors[4]) << "both touch nothing";
  EXPECT_NE(colors[3], colors[5]);
}

// One for each method, and all of them in the legend.
TEST(Colors, OfMethodsAreAllDifferent) {
  std::vector<BodyDetail> details;
  for (std::uint8_t method = BodyDetails::NONE; method <= BodyDetails::ADMM; ++method)
    details.push_back({method, 1, {}});
  details.push_back({BodyDetails::NEWTON, 0, {}});  // the static one
  const auto colors = coloursOf(details, {ColorBy::Solver});
  const auto legend = legendOf({ColorBy::Solver});
  for (std::size_t k = 0; k + 1 < colors.size(); ++k) {
    for (std::size_t j = 0; j < k; ++j) EXPECT_NE(colors[k], colors[j]) << k << " and " << j;
    EXPECT_EQ(std::count_if(legend.begin(), legend.end(),
                            [&](const LegendEntry& entry) { return entry.colors.front() == colors[k]; }),
              1);
  }
  EXPECT_EQ(colors.back(), colors.front()) << "the static body";
}

TEST(Colors, OfErrorsGoByDecades) {
  Coloring coloring{ColorBy::Error};
  coloring.largest = 1e-2f;
  const auto colors = coloursOf({{BodyDetails::NEWTON, 1, 0.0f},
                                 {BodyDetails::NEWTON, 1, 1e-5f},
                                 {BodyDetails::NEWTON, 1, 1e-2f / std::pow(10.0f, 1.5f)},
                                 {BodyDetails::NEWTON, 1, 1e-2f},
                                 {BodyDetails::NEWTON, 1, 1e9f},
                                 {BodyDetails::NEWTON, 1, {}},
                                 {BodyDetails::NONE, 0, 0.0f}},
                                coloring);
  EXPECT_EQ(colors[0], scaleColor(0.0f));
  EXPECT_EQ(colors[1], scaleColor(0.0f));
  for (int part = 0; part < 3; ++part) EXPECT_NEAR(colors[2][part], scaleColor(0.5f)[part], 1e-4f);
  EXPECT_EQ(colors[3], scaleColor(1.0f));
  EXPECT_EQ(colors[4], scaleColor(1.0f));
  EXPECT_EQ(colors[5], colors[6]) << "not compared is grey, as what does not move";
}

TEST(ErrorRange, IsAPowerOfTenThatStaysWhileItFits) {
  const auto rangeOf = [](float error, float last) { return errorRange({{0, 0, error}}, last); };
  EXPECT_NEAR(rangeOf(0.02f, 0.0f), 0.1f, 1e-6f);
  EXPECT_NEAR(rangeOf(0.1f, 0.0f), 0.1f, 1e-6f);
  EXPECT_NEAR(rangeOf(0.002f, 0.1f), 0.1f, 1e-6f) << "it stays";
  EXPECT_NEAR(rangeOf(0.0005f, 0.1f), 0.001f, 1e-8f) << "it was far too wide";
  EXPECT_NEAR(rangeOf(0.2f, 0.1f), 1.0f, 1e-5f);
  EXPECT_NEAR(rangeOf(0.0f, 0.0f), 1e-6f, 1e-10f);
  EXPECT_NEAR(errorRange({}, 0.0f), 1e-6f, 1e-10f);
}

TEST(LengthText, HasTheUnitThatSuits) {
  EXPECT_EQ(lengthText(0.1), "100 mm");
  EXPECT_EQ(lengthText(static_cast<double>(1e-3f)), "1 mm");
  EXPECT_EQ(lengthText(1e-6), "1 µm");
  EXPECT_EQ(lengthText(1e-9), "1 nm");
  EXPECT_EQ(lengthText(0.0), "0");
  EXPECT_EQ(lengthText(2.8e-11), "0.028 nm");
  EXPECT_EQ(lengthText(1e-12), "0.001 nm");
  EXPECT_EQ(lengthText(1.3e-15), "1.3e-15 m");
  EXPECT_EQ(lengthText(2500.0), "2.5 km");
  EXPECT_EQ(lengthText(0.99951), "1 m");
}

// The volume that a closed surface encloses is the sum of the tetrahedra from the origin to its triangles,
// positive where these face outward.
double volumeOf(const BodyMesh& mesh) {
  double volume = 0.0;
  for (std::size_t k = 0; k + 2 < mesh.indices.size(); k += 3) {
    const auto corner = [&](std::size_t i) { return mesh.vertices[mesh.indices[i]].position; };
    volume += static_cast<double>(corner(k).dotProduct(corner(k + 1).crossProduct(corner(k + 2)))) / 6.0;
  }
  return volume;
}

TEST(BodyMesh, FacesOutwardAndHasItsVolume) {
  EXPECT_NEAR(volumeOf(boxMesh()), 8.0, 1e-5);
  EXPECT_NEAR(volumeOf(sphereMesh(24)), 4.0 / 3.0 * M_PI, 0.05);
  EXPECT_NEAR(volumeOf(capsuleMesh(24)), 4.0 / 3.0 * M_PI, 0.05);
  EXPECT_NEAR(volumeOf(cylinderMesh(48)), 2.0 * M_PI, 0.05);
  EXPECT_NEAR(volumeOf(coneMesh(48)), M_PI / 3.0, 0.02);
}

// The half balls apart, the wall between them closes the surface.
TEST(BodyMesh, OfACapsuleHasAWall) {
  BodyMesh mesh = capsuleMesh(24);
  for (BodyMesh::Vertex& vertex : mesh.vertices) vertex.position.z += vertex.end;
  EXPECT_NEAR(volumeOf(mesh), 4.0 / 3.0 * M_PI + 2.0 * M_PI, 0.1);
}

TEST(BodyCatalog, EqualHullsShareAMeshThatLasts) {
  rigid_body_sim::BodyDescriptions message = descriptions(1, 3);
  for (auto& body : message.bodies) {
    body.shape = "hull";
    body.vertices.resize(4);
    body.vertices[1].x = body.vertices[2].y = body.vertices[3].z = 1.0;
  }
  message.bodies[2].vertices[3].z = 2.0;
  DrawnHulls hulls;
  const auto first = readDescriptions(message, hulls);
  EXPECT_EQ(first->bodies[0].hull, first->bodies[1].hull);
  EXPECT_NE(first->bodies[0].hull, first->bodies[2].hull);
  EXPECT_EQ(hulls.size(), 2u);
  message.bodies.pop_back();
  const auto second = readDescriptions(message, hulls);
  EXPECT_EQ(second->bodies[0].hull, first->bodies[0].hull);
  EXPECT_EQ(hulls.size(), 1u);
  message.bodies[1].vertices[3].z = kNan;
  EXPECT_THROW(readDescriptions(message, hulls), BadMessage);
}

}  // namespace
}  // namespace rbs

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
