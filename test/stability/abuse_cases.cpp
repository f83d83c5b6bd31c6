// SPDX-License-Identifier: BSD-3-Clause
// What people do to a running scene: resizing into overlap, teleporting, dragging, wrong numbers.
#include "base/random.h"
#include "measure.h"

#include "rigid_body_sim/scenes.h"

#include <algorithm>
#include <limits>

namespace rbs::stability {
namespace {

using namespace test;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The largest speed of a body's centre sideways and upwards, m/s: what falls is not pushed.
double fastest(const World& world) {
  double speed = 0.0;
  for (const BodyState& state : world.snapshot().states) {
    Vec3 v = state.twist.v_WB;
    v.z() = std::max(0.0, v.z());
    speed = std::max(speed, v.norm());
  }
  return speed;
}

/// Runs for some seconds after an edit that made an overlap, and says how fast bodies were and how deep they
/// are.
void recover(Sheet& sheet, Watch& watch, double cap, const std::string& what) {
  double speed = 0.0;
  for (int k = 0; k < 300; ++k) watch.step(), speed = std::max(speed, fastest(watch.world()));
  watch.step();
  const double left = watch.world().snapshot().report.deepest_penetration;
  sheet.error("fastest, of √(g L): " + what, "", std::max(0.0, speed / cap - 1.0), fastAndExact(1e-6, 1e-6));
  sheet.error("overlap left after 5 s: " + what, "m", left, fastAndExact(5e-3, 1e-6));
  watch.writeFinite(sheet);
}

SceneDef threeBalls() {
  SceneDef scene = onFloor(kFrame, 0.6);
  for (int k = 0; k < 3; ++k)
    scene.bodies.push_back(ball("ball_" + std::to_string(k), 0.5, Vec3(1.2 * k, 0.0, 0.5)));
  return scene;
}

void resizeIntoOverlap(Sheet& sheet) {
  Watch balls(threeBalls(), sheet.setting());
  balls.run(1.0);
  BodyEdit edit;
  edit.shape = Sphere{1.5};
  balls.world().editBody(balls.world().find("ball_1"), edit);
  recover(sheet, balls, std::sqrt(kGravity * 1.0), "a ball grows from 0.5 to 1.5 m between two");

  SceneDef boxes = onFloor(kFrame, 0.6);
  for (int k = 0; k < 3; ++k)
    boxes.bodies.push_back(box("box_" + std::to_string(k), Vec3::Ones(), Vec3(1.2 * k, 0.0, 0.5)));
  Watch row(boxes, sheet.setting());
  row.run(1.0);
  edit.shape = Box{Vec3(3.0, 1.0, 1.0)};
  row.world().editBody(row.world().find("box_1"), edit);
  recover(sheet, row, std::sqrt(kGravity * 1.0), "a box is stretched through its neighbours");
}

void teleport(Sheet& sheet) {
  struct Trial {
    const char* what;
    Shape one, two;
    Vec3 two_at;  // from one
  };
  for (const Trial& trial :
       {Trial{"two balls with one centre", Sphere{0.5}, Sphere{0.5}, Vec3::Zero()},
        Trial{"two boxes with one centre", Box{Vec3::Ones()}, Box{Vec3::Ones()}, Vec3::Zero()},
        Trial{"a ball in the middle of a box", Box{Vec3::Constant(2.0)}, Sphere{0.3}, Vec3::Zero()},
        Trial{"a box in a large box", Box{Vec3::Constant(3.0)}, Box{Vec3::Constant(0.5)},
              Vec3(0.2, -0.3, 0.1)}}) {
    std::uint64_t hashes[2];
    for (int again = 0; again < 2; ++again) {
      SceneDef scene = onFloor(kFrame, 0.6);
      const double height = 0.5 * fullExtents(trial.one).z();
      scene.bodies.push_back(body("one", trial.one, Vec3(0.0, 0.0, height)));
      scene.bodies.push_back(body("two", trial.two, Vec3(8.0, 0.0, 0.5 * fullExtents(trial.two).z())));
      Watch watch(scene, sheet.setting());
      watch.run(0.5);
      BodyEdit edit;
      edit.pose = Pose{Vec3(0.0, 0.0, height) + trial.two_at, Quat::Identity()};
      watch.world().editBody(watch.world().find("two"), edit);
      const double L = std::min(characteristicLength(trial.one), characteristicLength(trial.two));
      if (again)
        watch.run(301 * kFrame);
      else
        recover(sheet, watch, std::sqrt(kGravity * L), trial.what);
      hashes[again] = watch.world().stateHash();
    }
    sheet.check(std::string("the same twice: ") + trial.what, hashes[0] == hashes[1], every(0.0));
  }
}

void overlapRecovery(Sheet& sheet) {
  for (const double overlap : {0.25, 0.5, 1.0}) {
    if (sheet.isExact() && overlap == 1.0 && !sheet.length(false, true)) continue;  // takes minutes
    SceneDef scene = onFloor(kFrame, 0.6);
    const double pitch = 1.0 - overlap;
    for (int row = 0; row < 4; ++row) {
      for (int column = 0; column < 4 - row; ++column) {
        scene.bodies.push_back(
            box("", Vec3::Ones(), Vec3((column - 0.5 * (3 - row)) * pitch, 0.0, 0.5 + row * pitch)));
      }
    }
    Watch watch(scene, sheet.setting());
    double speed = 0.0;
    for (int k = 0; k < 300; ++k) watch.step(), speed = std::max(speed, fastest(watch.world()));
    const std::string what = named("a pyramid of ten boxes that overlap by %g", overlap);
    sheet.error("fastest, of √(g L): " + what, "", std::max(0.0, speed / std::sqrt(kGravity) - 1.0),
                fastAndExact(1e-6, 1e-6));
    sheet.error("overlap left after 5 s: " + what, "m", watch.world().snapshot().report.deepest_penetration,
                fastAndExact(5e-3, 1e-6));
    watch.writeFinite(sheet);
  }
}

/// Bodies that an edit has put into a place where others are, all at once, and how they part. What the edit
/// may give is, for each body, what lifts it by its own size.
void crowd(Sheet& sheet, const std::string& what, SceneDef scene, const std::vector<BodyDef>& added,
           double seconds) {
  scene.fidelity = sheet.setting();
  World world(scene);
  world.addBodies(added);
  double scale = 0.0;
  for (const BodyDescription& body : *world.snapshot().bodies)
    if (body.kind == BodyKind::Dynamic) scale += body.mass * kGravity * characteristicLength(body.shape);
  const auto energyNow = [&] { return static_cast<double>(energyOf(world)); };
  const double start = energyNow();
  double most = 0.0;
  std::size_t told = 0;
  bool finite = true;
  for (double t = 0.0; t < seconds; t += kFrame) {
    for (const Warning& warning : world.step().warnings) told += warning.kind == "overlap";
    most = std::max(most, energyNow() - start);
    for (const BodyState& state : world.snapshot().states)
      finite &= state.pose.p_WB.allFinite() && state.twist.v_WB.allFinite() && state.twist.w_WB.allFinite();
  }
  sheet.error("energy gained, of the sum of m g L: " + what, "", std::max(0.0, most / scale - 1.0),
              every(1e-6));
  sheet.error("energy gained, as measured: " + what, "of m g L", most / scale, shown());
  sheet.value("warnings of overlaps: " + what, "", static_cast<double>(told), 1.0, every(0.0));
  sheet.check("all numbers finite", finite, every(0.0));
}

void manyInOnePlace(Sheet& sheet) {
  const int count = sheet.length(60, 40, 200);
  const double seconds = sheet.length(2.0, 1.0, 15.0);
  std::vector<BodyDef> boxes, balls, mixed;
  SplitMix64 random(7);
  for (int k = 0; k < count; ++k) {
    boxes.push_back(box("", Vec3::Ones(), Vec3(0.0, 0.0, 0.5)));
    balls.push_back(
        ball("", 0.5, Vec3(random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), random.uniform(0.5, 1.0))));
    balls.back().material.restitution = 1.0;
    const double size = random.uniform(0.3, 1.5);
    const Shape shapes[] = {Box{Vec3::Constant(size)}, Sphere{0.5 * size}, Cylinder{0.5 * size, 0.5 * size}};
    mixed.push_back(
        body("", shapes[k % 3],
             Vec3(random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), random.uniform(0.8, 2.0))));
    mixed.back().material.restitution = 0.5;
  }
  crowd(sheet, "boxes in one place on the floor", onFloor(kFrame, 0.6), boxes, seconds);
  crowd(sheet, "elastic balls in a heap", onFloor(kFrame, 0.6), balls, seconds);
  crowd(sheet, "mixed shapes in a heap", onFloor(kFrame, 0.6), mixed, seconds);
  SceneDef falling = emptySpace(kFrame);
  falling.gravity = Vec3(0.0, 0.0, -kGravity);
  crowd(sheet, "boxes in one place in the air", falling, boxes, seconds);
}

void dragAbout(Sheet& sheet) {
  SceneDef scene = onFloor(kFrame, 0.6);
  scene.bodies.push_back(box("held", Vec3::Ones(), Vec3(0.0, 0.0, 0.5)));
  for (int k = 0; k < 8; ++k)
    scene.bodies.push_back(
        box("pile_" + std::to_string(k), Vec3::Ones(), Vec3(3.0 + 1.05 * (k % 4), 0.0, 0.5 + k / 4)));
  Watch watch(scene, sheet.setting());
  const BodyId held = watch.world().find("held");
  Grab grab;
  grab.frequency = 60.0;
  grab.max_acceleration = 1e6;
  double deepest = 0.0, others = 0.0;
  for (int k = 0; k < 240; ++k) {
    // To and fro through the pile and into the floor, at up to 100 m/s.
    const double t = k * kFrame;
    grab.p_W = Vec3(4.0 + 8.0 * std::sin(12.5 * t), 0.0, -1.0 + 2.0 * std::sin(7.0 * t));
    watch.world().grab(held, grab);
    watch.step();
    for (const BodyState& state : watch.world().snapshot().states)
      deepest = std::max(deepest, -state.pose.p_WB.z());
    for (int b = 0; b < 8; ++b)
      others = std::max(others, watch["pile_" + std::to_string(b)].twist.v_WB.norm());
  }
  watch.world().release(held);
  watch.run(3.0);
  sheet.error("deepest centre below the floor", "m", std::max(0.0, deepest), every(0.0));
  sheet.error("fastest body that was not held", "m/s", std::max(0.0, others - 100.0), fastAndExact(0.0, 0.0));
  sheet.error("overlap left 3 s after", "m", watch.world().snapshot().report.deepest_penetration,
              fastAndExact(5e-3, 1e-6));
  watch.writeFinite(sheet);
}

/// Whether an edit throws and leaves the state as it was.
template <class Change>
bool refused(World& world, Change change) {
  const std::uint64_t hash = world.stateHash();
  try {
    change(world);
  } catch (const InvalidInput&) {
    return world.stateHash() == hash;
  }
  return false;
}

bool sceneRefused(const std::string& text) {
  try {
    parseScene(text, "scene.yaml");
  } catch (const InvalidInput&) {
    return true;
  }
  return false;
}

void badInput(Sheet& sheet) {
  SceneDef scene = threeBalls();
  scene.air = Air{};
  scene.fidelity = sheet.setting();
  World world(scene);
  advance(world, 0.2);
  const BodyId id = world.find("ball_1");
  int tried = 0, right = 0;
  const auto count = [&](bool good) { ++tried, right += good; };
  for (const double bad : {0.0, -1.0, kNaN, kInfinity}) {
    BodyEdit edit;
    edit.mass = bad;
    count(refused(world, [&](World& w) { w.editBody(id, edit); }));
    edit = {};
    edit.shape = Sphere{bad};
    count(refused(world, [&](World& w) { w.editBody(id, edit); }));
  }
  for (const double bad : {1e-300, 1e300}) {
    BodyEdit edit;
    edit.shape = Box{Vec3::Constant(bad)};
    count(refused(world, [&](World& w) { w.editBody(id, edit); }));
  }
  for (const double bad : {-0.5, 1.5, kNaN}) {
    BodyEdit edit;
    edit.restitution = bad;
    count(refused(world, [&](World& w) { w.editBody(id, edit); }));
  }
  BodyEdit edit;
  edit.friction = -1.0;
  count(refused(world, [&](World& w) { w.editBody(id, edit); }));
  edit = {};
  edit.pose = Pose{Vec3::Zero(), Quat(0.0, 0.0, 0.0, 0.0)};
  count(refused(world, [&](World& w) { w.editBody(id, edit); }));
  edit.pose = Pose{Vec3(kNaN, 0.0, 0.0), Quat::Identity()};
  count(refused(world, [&](World& w) { w.editBody(id, edit); }));
  count(refused(world, [&](World& w) { w.setWind(Wind{Vec3(kNaN, 0.0, 0.0), 0.0}); }));
  count(refused(world, [&](World& w) { w.setGravity(Vec3(0.0, 0.0, kInfinity)); }));
  count(refused(world, [&](World& w) { w.applyImpulse(id, Vec3(kNaN, 0.0, 0.0), Vec3::Zero()); }));
  count(
      refused(world, [&](World& w) { w.applyWrench(id, Vec3::UnitX(), Vec3::Zero(), Vec3::Zero(), -1.0); }));
  sheet.value("edits that are refused and change nothing", "", right, tried, every(0.0));

  tried = right = 0;
  for (const char* text :
       {"step: 0", "step: -1", "step: .nan", "step: .inf", "bodies: [{mass: 0}]", "bodies: [{mass: -1}]",
        "bodies: [{mass: .nan}]", "bodies: [{size: 0}]", "bodies: [{size: -1}]", "bodies: [{size: 1.0e-300}]",
        "bodies: [{size: 1.0e+300}]", "bodies: [{orientation: [0, 0, 0, 0]}]",
        "bodies: [{restitution: -0.5}]", "bodies: [{friction: -1}]", "bodies: [{friction: .nan}]",
        "air: {}\nwind: {velocity: [.nan, 0, 0]}", "fidelity: exactest", "gravity: [0, 0]"}) {
    count(sceneRefused(text));
  }
  sheet.value("scene files that are refused", "", right, tried, every(0.0));
}

/// Random edits of a small world; the same seed gives the same ones.
std::uint64_t fuzz(Fidelity setting, int operations, bool& finite, double& fastest_ever) {
  SceneDef scene = onFloor(kFrame, 0.6);
  scene.fidelity = setting;
  World world(scene);
  SplitMix64 random(99);
  std::vector<BodyId> ids;
  const auto place = [&] {
    return Vec3(random.uniform(-3.0, 3.0), random.uniform(-3.0, 3.0), random.uniform(0.3, 4.0));
  };
  for (int k = 0; k < operations; ++k) {
    const auto what = random.below(8);
    if (ids.size() < 5 || (what == 0 && ids.size() < 25)) {
      const double size = random.uniform(0.2, 1.0);
      BodyDef def = random.below(2) ? ball("", 0.5 * size, place()) : box("", Vec3(size, 0.7, 0.4), place());
      def.material.restitution = 0.5 * random.below(2);
      ids.push_back(world.addBody(def));
    } else {
      const std::size_t which = random.below(ids.size());
      BodyEdit edit;
      if (what == 1) {
        world.removeBody(ids[which]);
        ids.erase(ids.begin() + which);
      } else if (what == 2) {
        edit.kind = random.below(2) ? BodyKind::Static : BodyKind::Dynamic;
        world.editBody(ids[which], edit);
      } else if (what == 3) {
        edit.mass = std::pow(10.0, random.uniform(-2.0, 4.0));
        world.editBody(ids[which], edit);
      } else if (what == 4) {
        edit.shape = random.below(2) ? Shape(Sphere{random.uniform(0.1, 0.6)})
                                     : Shape(Box{Vec3(random.uniform(0.2, 1.2), 0.5, 0.3)});
        world.editBody(ids[which], edit);
      } else if (what == 5) {
        edit.pose = Pose{place(), Quat::Identity()};
        world.editBody(ids[which], edit);
      } else {
        world.setGravity(kGravity * Vec3(random.uniform(-0.3, 0.3), 0.0, -1.0));
      }
    }
    world.step();
    for (const BodyState& state : world.snapshot().states) {
      finite &= state.pose.p_WB.allFinite() && state.twist.v_WB.allFinite() && state.twist.w_WB.allFinite();
      fastest_ever = std::max(fastest_ever, state.twist.v_WB.norm());
    }
  }
  return world.stateHash();
}

void randomOperations(Sheet& sheet) {
  const int operations = sheet.length(400, 200, 10000);
  bool finite = true;
  double speed = 0.0;
  const std::uint64_t one = fuzz(sheet.setting(), operations, finite, speed);
  const std::uint64_t two = fuzz(sheet.setting(), operations, finite, speed);
  sheet.check("all numbers finite", finite, every(0.0));
  sheet.check("a replay gives the same bits", one == two, every(0.0));
  // A fall of some seconds among bodies of some metres.
  sheet.error("fastest body", "m/s", speed, every(60.0));
}

void wildGravity(Sheet& sheet) {
  SceneDef scene = room(4.0);
  for (int k = 0; k < 8; ++k)
    scene.bodies.push_back(box("box_" + std::to_string(k), Vec3::Constant(0.8),
                               Vec3(k % 2, k / 2 % 2, k / 4) - Vec3::Constant(0.5)));
  Watch watch(scene, sheet.setting());
  double out = 0.0;
  const auto run = [&](int steps, const std::function<Vec3(int)>& gravity) {
    for (int k = 0; k < steps; ++k) {
      watch.world().setGravity(gravity(k));
      watch.step();
      for (int b = 0; b < 8; ++b)
        out = std::max(out, watch["box_" + std::to_string(b)].pose.p_WB.lpNorm<Eigen::Infinity>());
    }
  };
  run(120, [](int k) { return Vec3(0.0, 0.0, k % 2 ? kGravity : -kGravity); });
  sheet.error("gravity turned over every step: out of the room by", "m", std::max(0.0, out - 2.0),
              every(0.0));
  out = 0.0;
  run(60, [](int) { return Vec3(0.0, 0.0, -1e6); });
  sheet.error("gravity of 1e6 m/s²: out of the room by", "m", std::max(0.0, out - 2.0), every(0.0));
  watch.writeFinite(sheet);

  SceneDef weightless = emptySpace(kFrame);
  SplitMix64 random(3);
  for (int k = 0; k < 27; ++k) {
    weightless.bodies.push_back(
        box("box_" + std::to_string(k), Vec3::Constant(0.8), Vec3(k % 3, k / 3 % 3, k / 9)));
    for (int axis = 0; axis < 3; ++axis)
      weightless.bodies.back().twist.v_WB[axis] = random.uniform(-2.0, 2.0);
  }
  Watch cloud(weightless, sheet.setting());
  const Totals before = cloud.world().totals();
  cloud.run(2.0);
  const Totals after = cloud.world().totals();
  const double scale = 27 * 512.0 * 2.0;
  sheet.error("weightless: momentum, of that of all", "", (after.momentum - before.momentum).norm() / scale,
              exact(1e-12));
  sheet.error("weightless: angular momentum, of that of all", "",
              (after.angular_momentum - before.angular_momentum).norm() / (3.0 * scale), exact(1e-12));
}

}  // namespace

std::vector<Case> abuseCases() {
  return {
      {"A63", "Resized into its neighbours",
       "A ball grows from 0.5 to 1.5 m radius between two others; a box is stretched to 3 m through two. "
       "They are to part no "
       "faster than √(g L), L the smaller length.",
       resizeIntoOverlap},
      {"A64", "Teleported into another body",
       "Balls and boxes are moved to where another one is, with the same centre too, where no direction is "
       "the right one.",
       teleport},
      {"A65", "A pile that overlaps",
       "Ten boxes of 1 m in a pyramid begin with overlaps of 0.25, 0.5 and 1 m (all in one place).",
       overlapRecovery},
      {"A82", "Many in one place",
       "200 bodies (40 to 60 in the tests) are spawned into one place: boxes of the same pose on the floor "
       "and in the air, "
       "elastic balls, and boxes, balls and cylinders of 0.3 to 1.5 m at random. They are to gain no more "
       "energy than what lifts "
       "each by its own size, and a warning says that they overlap.",
       manyInOnePlace},
      {"A66", "Dragged with all force",
       "A box on a spring of 60 Hz is swung through a pile and into the floor at up to 100 m/s for 4 s, "
       "then let go.",
       dragAbout},
      {"A67", "Bad input",
       "Zero, negative, NaN and infinite masses, sizes, steps, frictions and more, through the C++ interface "
       "and in scene "
       "files: refused, and the state's hash unchanged.",
       badInput},
      {"A68", "Random operations",
       "10,000 (400 in the tests) random additions, removals and edits, a step after each, twice.",
       randomOperations},
      {"A69", "Wild gravity",
       "Eight boxes in a closed room with gravity that turns over every step, then of 1e6 m/s². 27 boxes "
       "collide without "
       "gravity.",
       wildGravity},
  };
}

}  // namespace rbs::stability
