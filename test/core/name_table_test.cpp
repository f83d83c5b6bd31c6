// SPDX-License-Identifier: BSD-3-Clause
// The table of names against a map, whatever comes, goes and is renamed.
#include "state/name_table.h"
#include "core/narrowphase_oracles.h"
#include "make_scene.h"
#include "rigid_body_sim/world.h"

#include <gtest/gtest.h>

#include <map>

using namespace rbs;
using namespace rbs::test;
using rbs::oracle::Random;

namespace {

TEST(NameTable, FindsWhatAMapFinds) {
  const std::uint64_t seed = 91;
  Random random(seed);
  NameTable table;
  std::map<std::string, BodyId> ids;
  std::map<BodyId, std::string> names;
  const auto nameOf = [&](BodyId id) { return names.at(id); };
  std::uint64_t serial = 0;
  for (int k = 0; k < 60000; ++k) {
    // Grows to some hundred names, shrinks to none, and so on.
    const std::string name = std::to_string(random.below(700));
    const bool grows = k / 3000 % 2 == 0;
    const auto known = ids.find(name);
    if (known != ids.end() && random.below(3) > (grows ? 1 : 0)) {
      table.erase(name, known->second);
      names.erase(known->second), ids.erase(known);
    } else if (known == ids.end() && random.below(3) > (grows ? 0 : 1)) {
      const BodyId id{++serial};
      table.insert(name, id);
      ids[name] = id, names[id] = name;
    }
    const std::string other = std::to_string(random.below(700));
    for (const std::string& one : {name, other}) {
      const auto expected = ids.find(one);
      ASSERT_EQ(table.find(one, nameOf), expected == ids.end() ? BodyId{} : expected->second)
          << "seed " << seed << ", change " << k << ", name " << one;
    }
  }
  for (const auto& [name, id] : ids) ASSERT_EQ(table.find(name, nameOf), id);
}

TEST(World, FindsBodiesByNamesThatChange) {
  const std::uint64_t seed = 92;
  Random random(seed);
  World world{SceneDef()};
  std::map<std::string, BodyId> expected;
  const auto anyName = [&] { return "body_" + std::to_string(random.below(60)); };
  for (int k = 0; k < 3000; ++k) {
    const std::string name = anyName(), to = anyName();
    const auto known = expected.find(name);
    if (known == expected.end()) {
      expected[name] = world.addBody(ball(name, 0.1, random.inCube(5.0)));
      EXPECT_THROW(world.addBody(ball(name, 0.1, Vec3::Zero())), InvalidInput);
    } else if (random.below(2) == 0) {
      world.removeBody(known->second);
      expected.erase(known);
    } else {
      BodyEdit edit;
      edit.name = to;
      const BodyId id = known->second;
      if (to != name && expected.count(to) > 0) {
        EXPECT_THROW(world.editBody(id, edit), InvalidInput);
      } else {
        world.editBody(id, edit);
        expected.erase(known);
        expected[to] = id;
      }
    }
    if (k % 100 == 0) world = World(world);
    for (int n = 0; n < 60; ++n) {
      const std::string one = "body_" + std::to_string(n);
      const auto place = expected.find(one);
      ASSERT_EQ(world.find(one), place == expected.end() ? BodyId{} : place->second)
          << "seed " << seed << ", change " << k << ", " << one;
    }
  }
}

}  // namespace
