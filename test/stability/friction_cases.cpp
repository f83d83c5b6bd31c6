// SPDX-License-Identifier: BSD-3-Clause
// Coulomb friction. A slope is a level floor under tilted gravity.
#include "measure.h"

#include <algorithm>
#include <limits>

namespace rbs::stability {
namespace {

using namespace test;

/// A scene with a floor and one body on it, both of this friction.
SceneDef oneBody(const BodyDef& body, double friction) {
  SceneDef scene = onFloor(kFrame, friction);
  scene.bodies.push_back(body);
  scene.bodies.back().material.friction = friction;
  return scene;
}

void slope(Sheet& sheet) {
  for (const double d : {1e-2, 1e-3, 1e-6}) {
    const Bound of_branch = d > 1e-4 ? fastAndExact(0.0, 0.0) : exact(0.0);
    for (const bool slides : {false, true}) {
      const double th = std::atan(0.5 * (slides ? 1.0 + d : 1.0 - d));
      SceneDef scene = oneBody(box("box", Vec3::Ones(), Vec3(0.0, 0.0, 0.5)), 0.5);
      scene.gravity = slopeGravity(th);
      Watch watch(scene, sheet.setting());
      watch.run(1.0);
      const BodyState early = watch["box"];
      const double seconds = sheet.length(4.0, 99.0);
      watch.run(slides ? 2.0 : seconds);
      const BodyState late = watch["box"];
      if (slides) {
        const double a = kGravity * (std::sin(th) - 0.5 * std::cos(th));
        const double error = (late.twist.v_WB.x() - early.twist.v_WB.x()) / 2.0 / a - 1.0;
        sheet.error(named("acceleration above the threshold by %g, relative", d), "", error,
                    d == 1e-2 ? exact(1e-6) : shown());
        sheet.check(named("slides above the threshold by %g", d), std::abs(error) < 0.5, of_branch);
      } else {
        const double creep = (late.pose.p_WB - early.pose.p_WB).norm() / seconds;
        sheet.error(named("creep below the threshold by %g", d), "m/s", creep, referenceOnly(1e-9));
        sheet.check(named("stays below the threshold by %g", d), creep < 1e-5, of_branch);
      }
    }
  }
}

// v0²/(2 mu g)
void slidingStop(Sheet& sheet) {
  BodyDef body = box("box", Vec3(1.0, 1.0, 0.2), Vec3(0.0, 0.0, 0.1));
  body.twist.v_WB.x() = 5.0;
  Watch watch(oneBody(body, 0.4), sheet.setting());
  watch.run(3.0);
  const double expected = 25.0 / (2.0 * 0.4 * kGravity);
  sheet.error("braking distance, relative", "", watch["box"].pose.p_WB.x() / expected - 1.0,
              fastAndExact(1e-2, 1e-6));
  sheet.error("speed after", "m/s", watch["box"].twist.v_WB.norm(), fastAndReference(1e-4, 1e-12));
  watch.writePromises(sheet);
}

void isotropy(Sheet& sheet) {
  SceneDef scene = onFloor(kFrame, 0.6);
  for (int k = 0; k < 16; ++k) {
    const double angle = 2.0 * kPi * k / 16;
    scene.bodies.push_back(
        box("puck_" + std::to_string(k), Vec3(0.4, 0.4, 0.02), Vec3(100.0 * k, 0.0, 0.01)));
    scene.bodies.back().twist.v_WB = 10.0 * Vec3(std::cos(angle), std::sin(angle), 0.0);
  }
  Watch watch(scene, sheet.setting());
  watch.run(3.0);
  double nearest = 1e300, farthest = 0.0, heading = 0.0;
  for (int k = 0; k < 16; ++k) {
    const Vec3 way = watch["puck_" + std::to_string(k)].pose.p_WB - Vec3(100.0 * k, 0.0, 0.0);
    const double angle = 2.0 * kPi * k / 16, distance = way.head<2>().norm();
    heading = std::max(heading, std::abs(way.y() * std::cos(angle) - way.x() * std::sin(angle)) / distance);
    nearest = std::min(nearest, distance), farthest = std::max(farthest, distance);
  }
  const double expected = 100.0 / (2.0 * 0.6 * kGravity);
  sheet.error("heading", "rad", heading, exact(1e-6));
  sheet.error("spread of the distances, relative", "", (farthest - nearest) / farthest, exact(1e-6));
  sheet.error("distance, relative", "", farthest / expected - 1.0, fastAndExact(1e-2, 1e-6));
}

// With F the pull, M and m the masses, f1 = mu 35 g the floor's friction, and f2 that of each of the 25
// balls: f2 = (F - f1)/M/(7/2 m + 25/M), a_plate = (F - f1 - 25 f2)/M, a_ball = f2/m.
void rollingBalls(Sheet& sheet) {
  for (const bool oblique : {true, false}) {
    SceneDef scene = fromCatalogue("rolling_balls");
    scene.step = 1e-3;
    const Vec3 along = oblique ? Vec3(0.5, std::sqrt(0.75), 0.0) : Vec3(0.0, 1.0, 0.0);
    Watch watch(scene, sheet.setting());
    const double f1 = 0.4 * 35.0 * kGravity, f2 = (150.0 - f1) / 10.0 / (3.5 + 2.5);
    const double a_plate = (150.0 - f1 - 25.0 * f2) / 10.0, a_ball = f2;
    const long steps = std::lround(sheet.length(0.5, 4.0) / scene.step);
    double sum = 0.0;
    for (long k = 0; k < steps; ++k) {
      World& world = watch.world();
      world.applyWrench(world.find("plate"), 150.0 * along, Vec3::Zero(), watch["plate"].pose.p_WB,
                        scene.step);
      watch.step();
      const Snapshot snapshot = world.snapshot();
      for (std::size_t b = 1; b < snapshot.states.size(); ++b) {
        const Vec3 expected = (b == 1 ? a_plate : a_ball) * world.time() * along;
        sum += (snapshot.states[b].twist.v_WB - expected).squaredNorm();
      }
    }
    sheet.error(
        std::string("mean squared error of the velocities, pulled ") + (oblique ? "obliquely" : "straight"),
        "(m/s)²", sum / steps / 26.0, fastAndReference(1e-6, 1e-20));
  }
}

// v = 5/7 v0 from t = 2 v0/(7 mu g) on, after 12 v0²/(49 mu g) of slipping; with backspin w0, (5 v0 + 2 R
// w0)/7.
void slidingToRolling(Sheet& sheet) {
  BodyDef body = ball("ball", 0.5, Vec3(0.0, 0.0, 0.5));
  body.twist.v_WB.x() = 7.0;
  Watch watch(oneBody(body, 0.2), sheet.setting());
  watch.run(2.0);
  const double mu_g = 0.2 * kGravity, t = watch.world().time();
  const double slipped = 12.0 * 49.0 / (49.0 * mu_g), rolls_from = 2.0 * 7.0 / (7.0 * mu_g);
  const BodyState rolling = watch["ball"];
  sheet.error("speed of rolling, relative", "", rolling.twist.v_WB.x() / 5.0 - 1.0, exact(1e-9));
  sheet.error("place when it rolls, relative", "",
              rolling.pose.p_WB.x() / (slipped + 5.0 * (t - rolls_from)) - 1.0, exact(1e-6));
  watch.run(sheet.length(10.0, 100.0));
  sheet.error("change of the speed while it rolls on, relative", "",
              watch["ball"].twist.v_WB.x() / rolling.twist.v_WB.x() - 1.0, exact(1e-10));
  watch.writePromises(sheet);

  body.twist = {Vec3(2.0, 0.0, 0.0), Vec3(0.0, -30.0, 0.0)};
  Watch back(oneBody(body, 0.3), sheet.setting());
  back.run(4.0);
  sheet.error("speed after backspin, relative", "", back["ball"].twist.v_WB.x() / ((10.0 - 30.0) / 7.0) - 1.0,
              exact(1e-9));
}

// a = 5/7 g sin th while tan th <= 7/2 mu, and else g (sin th - mu cos th).
void rollingOnSlope(Sheet& sheet) {
  for (const double share : {0.5, 0.99, 1.01, 1.5}) {
    const double mu = 0.2, th = std::atan(3.5 * mu * share);
    SceneDef scene = oneBody(ball("ball", 0.5, Vec3(0.0, 0.0, 0.5)), mu);
    scene.gravity = slopeGravity(th);
    Watch watch(scene, sheet.setting());
    watch.run(0.5);
    const double v = watch["ball"].twist.v_WB.x();
    watch.run(1.0);
    const double rolls = 5.0 / 7.0 * kGravity * std::sin(th);
    const double slips = kGravity * (std::sin(th) - mu * std::cos(th));
    sheet.error(named("acceleration at %g of the threshold, relative", share), "",
                (watch["ball"].twist.v_WB.x() - v) / (share < 1.0 ? rolls : slips) - 1.0, exact(1e-6));
  }
}

// Four corners at sqrt(2) half sides, each with a quarter of the weight: tau = mu m g sqrt(2), I = 2/3 m.
void spinningCube(Sheet& sheet) {
  const double mu = 0.2449, w0 = 10.0;
  BodyDef body = box("cube", Vec3::Constant(2.0), Vec3(0.0, 0.0, 1.0));
  body.twist.w_WB.z() = w0;
  Watch watch(oneBody(body, mu), sheet.setting());
  const double slowing = mu * kGravity * std::sqrt(2.0) * 1.5;
  watch.run(1.0);
  sheet.error("spin after 1 s, relative", "", watch["cube"].twist.w_WB.z() / (w0 - slowing) - 1.0,
              fastAndExact(1e-2, 1e-6));
  double turned = 0.0;
  Quat before = watch["cube"].pose.q_WB;
  while (watch.world().time() < 3.0) {
    watch.step();
    turned += angleBetween(before, watch["cube"].pose.q_WB);
    before = watch["cube"].pose.q_WB;
  }
  const double w1 = w0 - slowing;
  sheet.error("angle from 1 s to the stop, relative", "", turned / (w1 * w1 / (2.0 * slowing)) - 1.0,
              fastAndExact(1e-2, 1e-6));
  sheet.error("spin at the end", "rad/s", watch["cube"].twist.w_WB.norm(), fastAndReference(1e-4, 1e-12));
}

// Width 0.5, height 1: on a slope it slides at tan th > mu and tips at tan th > 1/2; pulled at its top it
// slides at F > mu m g and tips at F > m g/4.
void tipOrSlide(Sheet& sheet) {
  struct Trial {
    bool slope;
    double mu, pull;  // tan th, or F/(m g)
    bool tips, slides;
  };
  for (const Trial& trial :
       {Trial{true, 0.45, 0.45 * 0.99, false, false}, Trial{true, 0.45, 0.45 * 1.01, false, true},
        Trial{true, 0.55, 0.50 * 0.99, false, false}, Trial{true, 0.55, 0.50 * 1.01, true, false},
        Trial{false, 0.2, 0.2 * 0.99, false, false}, Trial{false, 0.2, 0.2 * 1.01, false, true},
        Trial{false, 0.3, 0.25 * 0.99, false, false}, Trial{false, 0.3, 0.25 * 1.01, true, false}}) {
    SceneDef scene = oneBody(box("box", Vec3(0.5, 0.5, 1.0), Vec3(0.0, 0.0, 0.5)), trial.mu);
    if (trial.slope) scene.gravity = slopeGravity(std::atan(trial.pull));
    Watch watch(scene, sheet.setting());
    const BodyId id = watch.world().find("box");
    const double weight = (*watch.world().snapshot().bodies)[1].mass * kGravity;
    const auto tilt = [&] { return 1.0 - (watch["box"].pose.q_WB * Vec3::UnitZ()).z(); };
    for (int k = 0; k < 240 && tilt() < 0.1; ++k) {
      const Pose pose = watch["box"].pose;
      if (!trial.slope) {
        watch.world().applyWrench(id, trial.pull * weight * Vec3::UnitX(), Vec3::Zero(),
                                  pose.p_WB + pose.q_WB * Vec3(0.0, 0.0, 0.5), kFrame);
      }
      watch.step();
    }
    const bool tips = tilt() >= 0.1, slides = !tips && watch["box"].pose.p_WB.x() > 0.05;
    sheet.check(
        named(trial.slope ? "right on a slope of tan %g" : "right under a pull of %g m g", trial.pull) +
            named(", friction %g", trial.mu),
        tips == trial.tips && slides == trial.slides, fastAndExact(0.0, 0.0));
  }
}

// Statics: the wall pushes with N at the height r + l sin th, the weight acts at l cos th/2 from the foot,
// and the floor holds N by friction: mu = N/(m g) = cos th/(2 sin th + 2 r/l) at the threshold.
void ladder(Sheet& sheet) {
  const double r = 0.05, l = 2.0;
  for (const double th : {0.7, 1.0, 1.25}) {
    const double threshold = std::cos(th) / (2.0 * std::sin(th) + 2.0 * r / l);
    for (const bool slips : {false, true}) {
      const double mu = threshold * (slips ? 0.99 : 1.01);
      SceneDef scene = onFloor(kFrame, mu);
      BodyDef wall = body("wall", Plane{}, Vec3(l * std::cos(th) + r, 0.0, 0.0));
      wall.kind = BodyKind::Static;
      wall.material.friction = 0.0;
      wall.pose.q_WB = Quat(Eigen::AngleAxisd(-0.5 * kPi, Vec3::UnitY()));  // it faces -x
      BodyDef def =
          body("ladder", Capsule{r, 0.5 * l}, Vec3(0.5 * l * std::cos(th), 0.0, r + 0.5 * l * std::sin(th)));
      def.pose.q_WB = Quat(Eigen::AngleAxisd(0.5 * kPi - th, Vec3::UnitY()));
      def.material.friction = mu;
      scene.bodies.push_back(wall);
      scene.bodies.push_back(def);
      Watch watch(scene, sheet.setting());
      watch.run(1.0);
      const Vec3 early = watch["ladder"].pose.p_WB;
      watch.run(slips ? 4.0 : sheet.length(6.0, 99.0));
      const double moved = (watch["ladder"].pose.p_WB - early).norm();
      if (slips) {
        sheet.check(named("slips at 0.99 of the threshold, %g rad", th), moved > 0.1, fastAndExact(0.0, 0.0));
      } else {
        sheet.error(named("creep at 1.01 of the threshold, %g rad", th), "m", moved, exact(1e-6));
        sheet.check(named("stands at 1.01 of the threshold, %g rad", th), moved < 0.01,
                    fastAndExact(0.0, 0.0));
      }
    }
  }
}

void extremeFriction(Sheet& sheet) {
  SceneDef steep = oneBody(box("box", Vec3(1.0, 1.0, 0.1), Vec3(0.0, 0.0, 0.05)), 1e6);
  steep.gravity = slopeGravity(std::atan(5.0));
  Watch sticks(steep, sheet.setting());
  sticks.run(1.0);
  const Vec3 early = sticks["box"].pose.p_WB;
  sticks.run(4.0);
  sheet.error("creep with friction 1e6 on a slope of tan 5", "m", (sticks["box"].pose.p_WB - early).norm(),
              fastAndReference(5e-3, 1e-9));
  sticks.writePromises(sheet);

  SceneDef ring = emptySpace(kFrame);
  for (int k = 0; k < 12; ++k) {
    const double angle = 2.0 * kPi * k / 12;
    BodyDef def = box("box_" + std::to_string(k), Vec3(0.4, 0.6, 0.5),
                      3.0 * Vec3(std::cos(angle), std::sin(angle), 0.0));
    def.pose.q_WB = Quat(Eigen::AngleAxisd(angle, Vec3::UnitZ()));
    def.twist.v_WB = -2.0 * def.pose.p_WB / 3.0;
    def.material.friction = 0.0;
    def.material.restitution = 1.0;
    ring.bodies.push_back(def);
  }
  ring.bodies[0].twist.v_WB *= 1.1;
  Watch watch(ring, sheet.setting());
  const Totals before = watch.world().totals();
  watch.run(3.0);
  const Totals after = watch.world().totals();
  const double scale = 12.0 * 120.0 * 2.0;  // kg m/s of all of them
  sheet.error("momentum of a frictionless elastic ring, relative", "",
              (after.momentum - before.momentum).norm() / scale, every(1e-12));
  sheet.error("energy of the ring, relative", "", after.kinetic_energy / before.kinetic_energy - 1.0,
              closedForm(1e-9));

  for (const double mu :
       {-1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    World world(steep);
    const std::uint64_t hash = world.stateHash();
    bool refused = false;
    BodyEdit edit;
    edit.friction = mu;
    try {
      world.editBody(world.find("box"), edit);
    } catch (const InvalidInput&) {
      refused = world.stateHash() == hash;
    }
    sheet.check(named("friction %g is refused and changes nothing", mu), refused, every(0.0));
  }
}

}  // namespace

std::vector<Case> frictionCases() {
  return {
      {"A21", "Stick and slip on a slope",
       "A cube of 1 m with μ = 0.5 on a slope of tan θ = 0.5 (1 ∓ d), d = 1e-2, 1e-3, 1e-6: it stays, for "
       "100 s (5 s in "
       "the tests), or slides with a = g (sin θ − μ cos θ). Creep is measured after the first second.",
       slope},
      {"A22", "Sliding to a stop",
       "A box at 5 m/s with μ = 0.4 slides v0²/(2 μ g) = 3.19 m and stops, at 60 Hz.", slidingStop},
      {"A23", "The same in all directions",
       "16 flat boxes slide at 10 m/s in 16 directions with μ = 0.6 and stop after v0²/(2 μ g).", isotropy},
      {"A24", "Balls roll on a plate that is pulled",
       "25 balls (1 kg, R = 0.5 m) on a plate of 20 × 20 × 1 m, 10 kg; μ = 0.8 between them and 0.4 to the "
       "floor; pulled "
       "with 150 N along (1/2, √3/2) and along y for 4 s (0.5 s in the tests) at steps of 1e-3 s (scene "
       "rolling_balls; "
       "SimBenchmark's measure). Exact: 0.738 and 0.211 m/s².",
       rollingBalls},
      {"A25", "From sliding to rolling",
       "A ball (R = 0.5 m, μ = 0.2) at 7 m/s without spin slips for 2 v0/(7 μ g) and then rolls at 5 m/s for "
       "ever, 100 s "
       "(10 s in the tests). With backspin of 30 rad/s at 2 m/s it comes back at (5 v0 + 2 R ω0)/7.",
       slidingToRolling},
      {"A26", "Rolling on a slope",
       "A ball on a slope rolls with 5/7 g sin θ while tan θ is below 7/2 μ, and else slips with g (sin θ − "
       "μ cos θ).",
       rollingOnSlope},
      {"A27", "A spinning cube",
       "A cube of 2 m spins at 10 rad/s on the floor, μ = 0.2449. The model: four corners carry a quarter "
       "each, so the "
       "torque is √2 μ m g.",
       spinningCube},
      {"A29", "Tip or slide",
       "A box half as wide as high on slopes, and pulled at its top, 1 % below and above where it slides or "
       "tips; eight "
       "trials of 4 s.",
       tipOrSlide},
      {"A30", "Ladder",
       "A capsule of r = 0.05 m and l = 2 m between the centres of its caps leans at θ between a floor with "
       "friction and a "
       "smooth wall. It slips below μ = cos θ/(2 sin θ + 2 r/l); tried 1 % above, for 100 s (7 s in the "
       "tests), and below.",
       ladder},
      {"A32", "Extreme friction",
       "μ = 1e6 holds a flat box on a slope of tan 5. Twelve elastic boxes without friction fly together "
       "from a ring: "
       "momentum and energy stay. Negative, NaN and infinite μ are refused.",
       extremeFriction},
  };
}

}  // namespace rbs::stability
