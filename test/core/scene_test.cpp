// SPDX-License-Identifier: BSD-3-Clause
// validate() finds every fault of a definition, by its path, and none in what is sound.
#include "rigid_body_sim/scene.h"

#include "base/text.h"
#include "rigid_body_sim/quote.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

namespace rbs {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::vector<std::string> paths(const std::vector<Problem>& problems) {
  std::vector<std::string> paths;
  for (const Problem& problem : problems) paths.push_back(problem.path);
  return paths;
}

std::vector<std::string> bodyFaults(const std::function<void(BodyDef&)>& spoil) {
  BodyDef body;
  spoil(body);
  return paths(validate(body, "b"));
}

std::vector<std::string> sceneFaults(const std::function<void(SceneDef&)>& spoil) {
  SceneDef scene;
  spoil(scene);
  return paths(validate(scene));
}

using Paths = std::vector<std::string>;

TEST(Scene, defaultsAreSound) {
  EXPECT_TRUE(validate(BodyDef{}, "b").empty());
  EXPECT_TRUE(validate(SceneDef{}).empty());
  SceneDef windy;
  windy.air = Air{};
  windy.wind = Wind{};
  EXPECT_TRUE(validate(windy).empty());
}

TEST(Scene, bodyNamesFollowTheRule) {
  const auto faults = [](const std::string& name) {
    return bodyFaults([&](BodyDef& b) { b.name = name; }).size();
  };
  for (const char* good : {"", "a", "box_1", "left/arm-2", "_x", "worlds", "a/world", "World"})
    EXPECT_EQ(faults(good), 0u) << good;
  for (const char* bad :
       {"1box", "a b", "caf\xc3\xa9", "a.b", "a\n", "world", "/a", "a/", "/", "a//b", "-x", "--json", "\xff"})
    EXPECT_EQ(faults(bad), 1u) << bad;
  EXPECT_EQ(faults(std::string("a\0b", 3)), 1u);
  EXPECT_EQ(faults(std::string(64, 'a')), 0u);
  EXPECT_EQ(faults(std::string(65, 'a')), 1u);
}

TEST(Scene, noBodyHasTheNameOfTheWorldsFrame) {
  BodyDef body;
  body.name = "map";
  EXPECT_TRUE(validate(body, "b").empty());
  nameFrames("map", "");
  EXPECT_EQ(paths(validate(body, "b")), Paths{"b.name"});
  nameFrames("sim/map", "sim/");
  EXPECT_EQ(paths(validate(body, "b")), Paths{"b.name"});
  nameFrames("map", "sim/");  // which requests would take for the world all the same
  EXPECT_EQ(paths(validate(body, "b")), Paths{"b.name"});
  body.name = "world";
  EXPECT_EQ(paths(validate(body, "b")), Paths{"b.name"});
  for (const char* bad : {"", "/map", "map/", "a//b", "a b", "\xff"})
    EXPECT_THROW(nameFrames(bad, ""), InvalidInput) << bad;
  for (const char* bad : {"/sim/", "a//", "a b", "\n"})
    EXPECT_THROW(nameFrames("map", bad), InvalidInput) << bad;
  EXPECT_EQ(worldFrame(), "map");  // what was refused changed nothing
  nameFrames("world", "");
}

TEST(Scene, messagesQuoteLittleAndOnlyText) {
  const auto message = [](const std::string& name) {
    BodyDef body;
    body.name = name;
    return std::string(InvalidInput(validate(body, "b")).what());
  };
  EXPECT_LT(message(std::string(100'000, 'a')).size(), 300u);
  EXPECT_NE(message(std::string(100'000, 'a')).find("100000 bytes"), std::string::npos);
  EXPECT_NE(message("\xff\n\x1b[2J").find("'\\xff\\x0a\\x1b[2J'"), std::string::npos);
  EXPECT_NE(message("caf\xc3\xa9").find("'caf\xc3\xa9'"), std::string::npos);
  const std::string two_bytes = "\xc3\xa9";
  std::string many;
  for (int k = 0; k < 100; ++k) many += two_bytes;
  EXPECT_EQ(printable("a" + many).substr(0, 7), "a" + two_bytes + two_bytes + two_bytes);
  EXPECT_EQ(printable("a" + many).find("\xc3..."), std::string::npos) << "half a character";
  for (const char* bad : {"\xc0\xaf", "\xed\xa0\x80", "\xf5\x80\x80\x80", "\xe2\x82", "\x80"})
    EXPECT_EQ(printable(bad).substr(0, 2), "\\x") << bad;
  EXPECT_LT(
      std::string(InvalidInput({{std::string(9999, 'p'), std::string(9999, 'v'), "less"}}).what()).size(),
      1200u);
}

TEST(Scene, numbersThatAreNoneAreToldAsSuch) {
  EXPECT_EQ(text(-kNan), "nan");
  EXPECT_EQ(text(kInfinity - kInfinity), "nan");
  EXPECT_EQ(text(-kInfinity), "-inf");
}

TEST(Scene, sizesOutOfRangeAreFound) {
  for (const double bad : {0.0, -1.0, 1e-300, 1e300, kNan, kInfinity}) {
    EXPECT_EQ(bodyFaults([&](BodyDef& b) { b.shape = Sphere{bad}; }), Paths{"b.size"}) << bad;
    EXPECT_EQ(bodyFaults([&](BodyDef& b) { b.shape = Box{Vec3(1.0, bad, 1.0)}; }), Paths{"b.size"}) << bad;
  }
}

TEST(Scene, massesOutOfRangeAreFound) {
  for (const double bad : {0.0, -1.0, 1e300, kNan, kInfinity}) {
    EXPECT_EQ(bodyFaults([&](BodyDef& b) { b.mass = bad; }), Paths{"b.mass"}) << bad;
    EXPECT_EQ(bodyFaults([&](BodyDef& b) { b.density = bad; }), Paths{"b.density"}) << bad;
  }
  EXPECT_EQ(bodyFaults([](BodyDef& b) { b.mass = b.density = 1.0; }), Paths{"b.density"});
}

TEST(Scene, massThatFollowsFromSizeAndDensityIsChecked) {
  const auto heavy = [](BodyDef& b) { b.shape = Box{Vec3::Constant(1e6)}; };  // 1e21 kg
  EXPECT_EQ(bodyFaults(heavy), Paths{"b.size"});
  const auto light = [](BodyDef& b) {  // 1e-21 kg
    b.shape = Box{Vec3::Constant(1e-6)};
    b.density = 1e-3;
  };
  EXPECT_EQ(bodyFaults(light), Paths{"b.size"});
  EXPECT_EQ(bodyFaults([&](BodyDef& b) {
              heavy(b);
              b.kind = BodyKind::Static;
            }),
            Paths{});
}

TEST(Scene, orientationNeedsADirection) {
  const auto faults = [](const Quat& q) { return bodyFaults([&](BodyDef& b) { b.pose.q_WB = q; }); };
  EXPECT_EQ(faults(Quat(2.0, 0.0, 0.0, 2.0)), Paths{});
  for (const double bad : {0.0, 1e-4, 1e4, 1e200, kNan, kInfinity}) {
    EXPECT_EQ(faults(Quat(bad, 0.0, 0.0, 0.0)), Paths{"b.orientation"}) << bad;
  }
}

TEST(Scene, motionOutOfRangeIsFound) {
  for (const double bad : {1e10, 1e200, kNan, -kInfinity}) {
    EXPECT_EQ(bodyFaults([&](BodyDef& b) { b.pose.p_WB.y() = bad; }), Paths{"b.position"}) << bad;
    EXPECT_EQ(bodyFaults([&](BodyDef& b) { b.twist.v_WB.y() = bad; }), Paths{"b.velocity"}) << bad;
    EXPECT_EQ(bodyFaults([&](BodyDef& b) { b.twist.w_WB.y() = bad; }), Paths{"b.spin"}) << bad;
  }
}

TEST(Scene, staticBodyDoesNotMove) {
  const auto faults = [](BodyKind kind) {
    return bodyFaults([&](BodyDef& b) {
      b.kind = kind;
      b.twist = {Vec3::UnitX(), Vec3::UnitY()};
    });
  };
  EXPECT_EQ(faults(BodyKind::Static), (Paths{"b.velocity", "b.spin"}));
  EXPECT_EQ(faults(BodyKind::Kinematic), Paths{});
  EXPECT_EQ(faults(BodyKind::Dynamic), Paths{});
}

TEST(Scene, planeIsNotDynamicAndHasNoMass) {
  const auto faults = [](BodyKind kind, std::optional<double> mass) {
    return bodyFaults([&](BodyDef& b) {
      b.shape = Plane{};
      b.kind = kind;
      b.mass = mass;
    });
  };
  EXPECT_EQ(faults(BodyKind::Static, {}), Paths{});
  EXPECT_EQ(faults(BodyKind::Dynamic, {}), Paths{"b.kind"});
  EXPECT_EQ(faults(BodyKind::Static, 1.0), Paths{"b.mass"});
}

TEST(Scene, materialAndColorOutOfRangeAreFound) {
  for (const double bad : {-1.0, 1e300, kNan, kInfinity}) {
    EXPECT_EQ(bodyFaults([&](BodyDef& b) { b.material.friction = bad; }), Paths{"b.material.friction"})
        << bad;
    EXPECT_EQ(bodyFaults([&](BodyDef& b) { b.material.restitution = bad; }), Paths{"b.material.restitution"});
    EXPECT_EQ(bodyFaults([&](BodyDef& b) { b.material.drag_coefficient = bad; }),
              Paths{"b.material.drag_coefficient"});
    EXPECT_EQ(bodyFaults([&](BodyDef& b) {
                b.color = Color{0, 0, static_cast<float>(bad), 1};
              }),
              Paths{"b.color"});
  }
  EXPECT_EQ(bodyFaults([](BodyDef& b) { b.material = {0.0, 1.0, 0.0}; }), Paths{});
  EXPECT_EQ(bodyFaults([](BodyDef& b) { b.material.restitution = 1.0001; }), Paths{"b.material.restitution"});
}

TEST(Scene, surroundingsOutOfRangeAreFound) {
  for (const double bad : {1e300, kNan, kInfinity}) {
    EXPECT_EQ(sceneFaults([&](SceneDef& s) { s.gravity.z() = bad; }), Paths{"gravity"});
    EXPECT_EQ(sceneFaults([&](SceneDef& s) { s.step = bad; }), Paths{"step"});
    EXPECT_EQ(sceneFaults([&](SceneDef& s) { s.air = Air{bad}; }), Paths{"air.density"});
    EXPECT_EQ(sceneFaults([&](SceneDef& s) { s.view.eye.x() = bad; }), Paths{"view.eye"});
    const auto windFaults = [](const Wind& wind) {
      return sceneFaults([&](SceneDef& s) {
        s.air = Air{};
        s.wind = wind;
      });
    };
    EXPECT_EQ(windFaults({Vec3(0.0, bad, 0.0), 0.0}), Paths{"wind.velocity"});
    EXPECT_EQ(windFaults({Vec3::Zero(), bad}), Paths{"wind.gust"});
    EXPECT_EQ(windFaults({Vec3::Zero(), -1.0}), Paths{"wind.gust"});
  }
  for (const double bad : {0.0, -0.1, 1e-7, 1.1}) {
    EXPECT_EQ(sceneFaults([&](SceneDef& s) { s.step = bad; }), Paths{"step"}) << bad;
  }
  EXPECT_EQ(sceneFaults([](SceneDef& s) { s.wind = Wind{}; }), Paths{"wind"});
  EXPECT_EQ(sceneFaults([](SceneDef& s) { s.view.eye = s.view.target; }), Paths{"view.target"});
}

TEST(Scene, everyFaultIsReportedAtOnce) {
  SceneDef scene;
  scene.step = 0.0;
  scene.bodies.resize(4);
  scene.bodies[0].name = scene.bodies[2].name = scene.bodies[3].name = "twin";
  scene.bodies[1].mass = -1.0;
  scene.bodies[1].material.friction = kNan;
  EXPECT_EQ(paths(validate(scene)), (Paths{"step", "bodies[1].mass", "bodies[1].material.friction",
                                           "bodies[2].name", "bodies[3].name"}));
}

TEST(Scene, messageNamesPlaceValueAndWhatIsAllowed) {
  SceneDef scene;
  scene.bodies.resize(1);
  scene.bodies[0].material.restitution = 1.5;
  EXPECT_STREQ(InvalidInput(validate(scene)).what(), "bodies[0].material.restitution: 1.5 (allowed: 0 to 1)");
  EXPECT_STREQ(InvalidInput({{"a", "", "b"}, {"c", "d", "e"}}).what(), "a; b\nc: d (allowed: e)");
}

TEST(Scene, longListsOfFaultsAreCut) {
  const std::string text = InvalidInput(std::vector<Problem>(1000, {"a", "b", "c"})).what();
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 20);
  EXPECT_NE(text.find("and 980 more"), std::string::npos);
}

}  // namespace
}  // namespace rbs
