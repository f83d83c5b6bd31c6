// SPDX-License-Identifier: BSD-3-Clause
// Contacts: what persists from step to step, what waits aside, and where impulses go.
#include "state/contact.h"
#include "make_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>

using namespace rbs;
using namespace rbs::test;

namespace {

using Pairs = std::vector<std::pair<Index, Index>>;

Bodies balls(Index n) {
  Bodies bodies;
  for (Index k = 0; k < n; ++k)
    bodies.append(BodyId{k + 1}, ball("ball_" + std::to_string(k), 0.5, Vec3::Zero()));
  return bodies;
}

SolvedPoint pointWith(std::uint32_t feature, const Vec3& impulse_W, const Vec3& n_W = Vec3::UnitZ()) {
  SolvedPoint point;
  point.feature = feature;
  point.n_W = n_W;
  point.setImpulse(impulse_W);
  return point;
}

Vec3 impulseOf(const SolvedPoint& point) {
  return point.normal_impulse * point.n_W + point.friction_impulse_W;
}

bool never(const Contact&) {
  return false;
}

TEST(Contact, EarlierImpulsesAddUpWhateverTheirNormals) {
  Contact contact;
  const Vec3 first(1.0, 2.0, 3.0), second(-4.0, 0.5, 1.0), other(0.0, 0.0, 7.0);
  contact.addEarlier(pointWith(5, first));
  contact.addEarlier(pointWith(2, other));
  contact.addEarlier(pointWith(5, second, Vec3(0.6, 0.0, 0.8)));
  contact.addEarlier(pointWith(9, Vec3::Zero()));
  ASSERT_EQ(contact.earlier.size(), 2u);
  EXPECT_EQ(contact.earlier[0].feature, 2u);
  EXPECT_EQ(contact.earlier[1].n_W, Vec3(0.6, 0.0, 0.8));
  EXPECT_LE((impulseOf(contact.earlier[1]) - first - second).norm(), 1e-15);
}

TEST(Contact, ALastNormalIsThatOfAForceElseOfAnOverlapThatHasASide) {
  Contact contact;
  EXPECT_TRUE(contact.lastNormal(0.0).n_W.isZero(0.0));
  const auto add = [&](std::uint32_t feature, const Vec3& n_W, double separation, double force) {
    contact.points.push_back(pointWith(feature, Vec3::Zero(), n_W));
    contact.points.back().separation = separation, contact.points.back().normal = force;
  };
  add(1, Vec3::UnitX(), 1e-3, 0.0);
  add(SolvedPoint::kNoSide, Vec3::UnitZ(), -0.1, 0.0);
  EXPECT_TRUE(contact.lastNormal(0.0).n_W.isZero(0.0)) << "apart, and with one centre";
  add(2, Vec3::UnitY(), -1e-3, 0.0);
  EXPECT_EQ(contact.lastNormal(0.0).n_W, Vec3(Vec3::UnitY()));
  EXPECT_FALSE(contact.lastNormal(0.0).loaded);
  add(3, -Vec3::UnitX(), 1e-4, 5.0);
  EXPECT_EQ(contact.lastNormal(5.0).n_W, Vec3(Vec3::UnitY())) << "a force that is too small";
  EXPECT_EQ(contact.lastNormal(4.0).n_W, Vec3(-Vec3::UnitX()));
  EXPECT_TRUE(contact.lastNormal(4.0).loaded);
}

TEST(Contact, ASecondSolveKeepsTheImpulsesOfThisStepAndNotThoseOfTheLast) {
  Contact contact;
  contact.points = {pointWith(1, Vec3(0.0, 0.0, 2.0))};
  contact.beginSolve();
  EXPECT_TRUE(contact.points.empty() && contact.earlier.empty());
  contact.points = {pointWith(1, Vec3(0.0, 0.0, 3.0))};
  contact.beginSolve();
  ASSERT_EQ(contact.earlier.size(), 1u);
  EXPECT_EQ(contact.earlier[0].normal_impulse, 3.0);
}

// A step that begins again twice goes back to the points that the contact had when it began.
TEST(Contact, SolvesThatAreTakenBackLeaveThePointsOfTheStepBefore) {
  Contact contact;
  contact.points = {SolvedPoint()};
  contact.points[0].feature = 7;
  contact.exact = true;
  for (const std::uint32_t feature : {8u, 9u, 10u}) {
    contact.beginSolve();
    EXPECT_TRUE(contact.points.empty());
    contact.points = {SolvedPoint()};
    contact.points[0].feature = feature;
    contact.exact = false;
    contact.solved = false;  // the step begins again
  }
  contact.takeBackSolves();
  ASSERT_EQ(contact.points.size(), 1u);
  EXPECT_EQ(contact.points[0].feature, 7u);
  EXPECT_TRUE(contact.exact);
}

TEST(Contacts, KeepTheirPointsAsLongAsThePairIsFound) {
  const Bodies bodies = balls(4);
  Contacts contacts;
  contacts.update(bodies, {{0, 1}, {1, 3}}, never);
  contacts.active[1].beginSolve();
  contacts.active[1].points = {pointWith(7, Vec3::UnitZ())};
  contacts.active[1].exact = true;
  contacts.endStep(never);
  contacts.update(bodies, {{0, 2}, {1, 3}, {2, 3}}, never);
  ASSERT_EQ(contacts.active.size(), 3u);
  EXPECT_EQ(contacts.active[1].points.size(), 1u);
  EXPECT_TRUE(contacts.active[1].exact);
  EXPECT_FALSE(contacts.active[1].solved);
  contacts.endStep(never);
  EXPECT_TRUE(contacts.active[1].points.empty()) << "not solved in this step";
  EXPECT_FALSE(contacts.active[1].exact);
}

TEST(Contacts, ThatRestOrHaveGivenImpulsesWaitAside) {
  const Bodies bodies = balls(6);
  Contacts contacts;
  contacts.update(bodies, {{0, 1}, {2, 3}, {4, 5}}, never);
  for (Contact& contact : contacts.active) {
    contact.beginSolve();
    contact.points = {pointWith(1, Vec3::UnitZ())};
  }
  contacts.active[1].addEarlier();
  contacts.endStep(never);
  const auto restsFirst = [&](const Contact& contact) { return contact.key.i == bodies.id[0]; };
  contacts.update(bodies, {}, restsFirst);
  ASSERT_EQ(contacts.dormant.size(), 2u);
  EXPECT_EQ(contacts.dormant[0].key.j, bodies.id[1]);
  EXPECT_EQ(contacts.dormant[0].points.size(), 1u);
  EXPECT_EQ(contacts.dormant[1].key.j, bodies.id[3]);
  EXPECT_TRUE(contacts.dormant[1].points.empty()) << "what they gave is counted";
  EXPECT_EQ(contacts.dormant[1].earlier.size(), 1u);
  contacts.beginWorldStep();
  contacts.update(bodies, {{0, 1}}, restsFirst);
  EXPECT_EQ(contacts.active[0].points.size(), 1u) << "it comes back with its points";
  EXPECT_TRUE(contacts.dormant.empty()) << "what has given nothing in this step is dropped";
}

TEST(Contacts, APairThatAnImpactAddsIsListedOnceWithWhatItHasGiven) {
  const Bodies bodies = balls(4);
  Contacts contacts;
  contacts.update(bodies, {{0, 1}, {2, 3}}, never);
  contacts.dormantOf(bodies, 1, 2).addEarlier(pointWith(3, Vec3::UnitX()));
  contacts.dormantOf(bodies, 1, 2).addEarlier(pointWith(3, Vec3::UnitX()));
  EXPECT_EQ(contacts.find(1, 2, 2), kNone);
  ASSERT_EQ(contacts.withPoints().size(), 1u);
  const Index place = contacts.add(bodies, 1, 2);
  EXPECT_EQ(place, 2u);
  EXPECT_EQ(contacts.find(1, 2, 2), place);
  EXPECT_TRUE(contacts.dormant.empty());
  EXPECT_EQ(impulseOf(contacts.active[place].earlier.at(0)), Vec3(2.0, 0.0, 0.0));
  contacts.add(bodies, 0, 3);
  contacts.endStep(never);
  for (std::size_t k = 1; k < contacts.active.size(); ++k)
    EXPECT_TRUE(contacts.active[k - 1].key < contacts.active[k].key);
}

// Against a map of maps: any order of steps, removals and edits.
TEST(Contacts, FollowAModelThroughRandomSteps) {
  std::mt19937 random(16);
  for (int run = 0; run < 200; ++run) {
    Bodies bodies = balls(6);
    Contacts contacts;
    std::map<std::pair<BodyId, BodyId>, double> model;  // force of the only point of a pair
    std::set<BodyId> resting;
    const auto rests = [&](const Contact& c) { return resting.count(c.key.i) && resting.count(c.key.j); };
    for (int step = 0; step < 30; ++step) {
      resting.clear();
      for (const BodyId id : bodies.id)
        if (random() % 3 == 0) resting.insert(id);
      Pairs found;
      for (Index i = 0; i < bodies.size(); ++i)
        for (Index j = i + 1; j < bodies.size(); ++j)
          if (random() % 2 && !(resting.count(bodies.id[i]) && resting.count(bodies.id[j])))
            found.emplace_back(i, j);
      contacts.beginWorldStep();
      contacts.update(bodies, found, rests);
      std::map<std::pair<BodyId, BodyId>, double> next;
      for (const auto& [key, force] : model)
        if (resting.count(key.first) && resting.count(key.second)) next[key] = force;
      for (Contact& contact : contacts.active) {
        const std::pair key(contact.key.i, contact.key.j);
        const auto known = model.find(key);
        ASSERT_EQ(contact.points.size(), known == model.end() ? 0u : 1u);
        if (known != model.end()) ASSERT_EQ(contact.points[0].normal, known->second);
        if (random() % 2) continue;
        contact.beginSolve();
        contact.points.emplace_back().normal = next[key] = static_cast<double>(random() % 1000);
      }
      contacts.endStep(never);
      model = next;
      if (random() % 5 == 0 && bodies.size() > 2) {
        const Index gone = random() % bodies.size();
        const BodyId id = bodies.id[gone];
        contacts.remove(id);
        bodies.erase(gone);
        for (auto it = model.begin(); it != model.end();)
          it = it->first.first == id || it->first.second == id ? model.erase(it) : std::next(it);
      } else if (random() % 5 == 0) {
        const BodyId id = bodies.id[random() % bodies.size()];
        contacts.forget(id);
        for (auto it = model.begin(); it != model.end();)
          it = it->first.first == id || it->first.second == id ? model.erase(it) : std::next(it);
      }
      std::map<std::pair<BodyId, BodyId>, double> kept;
      for (const Contact* contact : contacts.withPoints())
        ASSERT_TRUE(
            kept.emplace(std::pair(contact->key.i, contact->key.j), contact->points.at(0).normal).second);
      ASSERT_EQ(kept, model) << "run " << run << ", step " << step;
    }
  }
}

}  // namespace
