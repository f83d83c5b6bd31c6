// SPDX-License-Identifier: BSD-3-Clause
// Stacks and structures.
#include "measure.h"

#include <Eigen/LU>

#include <algorithm>
#include <map>

namespace rbs::stability {
namespace {

using namespace test;

/// How far the dynamic bodies are from where they were, m.
double farthestMove(const Snapshot& now, const Snapshot& then) {
  double farthest = 0.0;
  for (std::size_t k = 0; k < now.states.size(); ++k) {
    if ((*now.bodies)[k].kind != BodyKind::Dynamic) continue;
    farthest = std::max(farthest, (now.states[k].pose.p_WB - then.states[k].pose.p_WB).norm());
  }
  return farthest;
}

/// The largest kinetic energy of one body, J per kg.
double liveliest(const World& world) {
  const double v = fastestPoint(world);
  return 0.5 * v * v;
}

/// The vertical impulse in all contacts between body k and body k + 1 of the snapshot, N s.
double carried(const Snapshot& snapshot, std::size_t lower) {
  double sum = 0.0;
  for (const ContactPoint& point : snapshot.contacts) {
    const int a = snapshot.find(point.a), b = snapshot.find(point.b);
    if (std::min(a, b) != static_cast<int>(lower) || std::max(a, b) != static_cast<int>(lower) + 1) continue;
    const Vec3 impulse = point.normal_impulse * point.n_W + point.friction_impulse;
    sum += (a < b ? 1.0 : -1.0) * impulse.z();
  }
  return sum;
}

/// The largest error of the impulses in a column of bodies 1, 2 ... on the floor, 0, of the exact weight
/// above.
double impulseError(const Snapshot& snapshot) {
  double above = 0.0, worst = 0.0;
  for (std::size_t k = snapshot.states.size() - 1; k >= 1; --k) {
    above += (*snapshot.bodies)[k].mass;
    const double exact_impulse = above * snapshot.gravity.norm() * snapshot.step;
    worst = std::max(worst, std::abs(carried(snapshot, k - 1) / exact_impulse - 1.0));
  }
  return worst;
}

/// Cubes of these masses on the floor, the first the lowest.
SceneDef column(const std::vector<double>& masses, double size = 1.0, double friction = 0.5) {
  SceneDef scene = onFloor(kFrame, friction);
  for (std::size_t k = 0; k < masses.size(); ++k) {
    scene.bodies.push_back(
        box("box_" + std::to_string(k), Vec3::Constant(size), Vec3(0.0, 0.0, (0.5 + k) * size)));
    scene.bodies.back().mass = masses[k];
    scene.bodies.back().material.friction = friction;
  }
  return scene;
}

void stack(Sheet& sheet) {
  std::vector<int> heights{10, 30};
  heights.push_back(sheet.length(40, 40));
  if (sheet.length(false, true)) heights.push_back(100);
  for (const int n : heights) {
    const std::string of = ", " + std::to_string(n) + " cubes";
    Watch watch(column(std::vector<double>(n, 1000.0)), sheet.setting());
    const Snapshot start = watch.world().snapshot();
    double rest_at_two = 0.0;
    const double seconds = sheet.length(n <= 10 ? 10.0 : 5.0, 60.0);
    watch.run(2.0);
    rest_at_two = liveliest(watch.world());
    watch.run(seconds - 2.0);
    const Snapshot end = watch.world().snapshot();
    sheet.error("impulses, relative to the weights" + of, "", impulseError(end), exact(1e-9));
    sheet.error("movement of any cube" + of, "m", farthestMove(end, start), fastAndReference(5e-3, 1e-9));
    sheet.error("deepest penetration" + of, "m", watch.deepest(), fastAndReference(5e-3, 1e-9));
    sheet.error("kinetic energy per mass after 2 s" + of, "J/kg", rest_at_two, fastAndReference(1e-6, 1e-18));
    watch.writePromises(sheet);
  }
}

// How a column of n equal balls that roll on each other leaves the vertical, linearised. s_k is the place of
// ball k sideways, w_k its spin; N_k = (n - k) m g is carried by the contact below it, which leans by (s_k -
// s_{k-1})/2R and so turns N_k sideways (the floor does not lean); f_k is the friction there on ball k.
//   m s_k'' = f_k - f_{k+1} + N_k (s_k - s_{k-1})/2R - N_{k+1} (s_{k+1} - s_k)/2R
//   2/5 m R w_k' = -(f_k + f_{k+1})
//   s_k'' - R w_k' = s_{k-1}'' + R w_{k-1}'          no slip; the floor is at rest
// Returns A of s'' = A s.
Eigen::MatrixXd columnDynamics(int n, double R) {
  // Unknowns: s'' (n), w' (n), f (n).
  Eigen::MatrixXd M = Eigen::MatrixXd::Zero(3 * n, 3 * n), K = Eigen::MatrixXd::Zero(3 * n, n);
  const double m = 1.0, g = kGravity;
  for (int k = 0; k < n; ++k) {
    M(k, k) = m;
    M(k, 2 * n + k) = -1.0;
    if (k + 1 < n) M(k, 2 * n + k + 1) = 1.0;
    if (k > 0) {
      const double lean = (n - k) * m * g / (2.0 * R);
      K(k, k) += lean, K(k, k - 1) -= lean;
    }
    if (k + 1 < n) {
      const double lean = (n - k - 1) * m * g / (2.0 * R);
      K(k, k + 1) -= lean, K(k, k) += lean;
    }
    M(n + k, n + k) = 0.4 * m * R;
    M(n + k, 2 * n + k) = 1.0;
    if (k + 1 < n) M(n + k, 2 * n + k + 1) = 1.0;
    M(2 * n + k, k) = 1.0, M(2 * n + k, n + k) = -R;
    if (k > 0) M(2 * n + k, k - 1) = -1.0, M(2 * n + k, n + k - 1) = -R;
  }
  return M.fullPivLu().solve(K).topRows(n);
}

/// The time that the farthest ball of the linearised column takes from 1e-5 to 1e-4 m when the top one starts
/// 1e-6 m aside, s.
double decadeOfColumn(int n, double R) {
  const Eigen::MatrixXd A = columnDynamics(n, R);
  Eigen::VectorXd s = Eigen::VectorXd::Zero(n), v = s;
  s[n - 1] = 1e-6;
  const double h = 1e-5;
  double reached = 0.0;
  for (double t = 0.0; t < 10.0; t += h) {
    v += h * (A * s), s += h * v;
    const double farthest = s.cwiseAbs().maxCoeff();
    if (reached == 0.0 && farthest > 1e-5) reached = t;
    if (farthest > 1e-4) return t - reached;
  }
  return 0.0;
}

void sphereColumn(Sheet& sheet) {
  SceneDef scene = fromCatalogue("sphere_column");
  Watch aligned(scene, sheet.setting());
  aligned.run(sheet.length(3.0, 0.5, 10.0));
  double sideways = 0.0;
  for (const BodyState& state : aligned.world().snapshot().states)
    sideways = std::max({sideways, std::abs(state.pose.p_WB.x()), std::abs(state.pose.p_WB.y())});
  sheet.error("aligned: sideways, bit for bit", "m", sideways, exact(0.0));
  sheet.error("aligned: height of the top lost", "m", 29.5 - aligned["ball_30"].pose.p_WB.z(),
              fastAndExact(0.3, 1e-6));
  aligned.writePromises(sheet);

  // Two seconds of short steps: minutes at the exact settings.
  if (sheet.isExact() && !sheet.length(false, true)) return;
  scene.bodies.back().pose.p_WB.x() = 1e-6;
  scene.step = 1.0 / 960.0;  // short beside the time of growth, 1/30 s
  Watch offset(scene, sheet.setting());
  double reached = 0.0, taken = 0.0;
  while (offset.world().time() < 3.0 && taken == 0.0) {
    offset.step();
    double farthest = 0.0;
    for (const BodyState& state : offset.world().snapshot().states)
      farthest = std::max(farthest, std::abs(state.pose.p_WB.x()));
    if (reached == 0.0 && farthest > 1e-5) reached = offset.world().time();
    if (farthest > 1e-4) taken = offset.world().time() - reached;
  }
  const double expected = decadeOfColumn(30, 0.5);
  sheet.check("offset: the column falls", taken > 0.0, fastAndExact(0.0, 0.0));
  sheet.error("offset: time from 1e-5 to 1e-4 m, relative to the linearised " + named("%.4g s", expected), "",
              taken / expected - 1.0, exact(0.05));
}

void pyramids(Sheet& sheet) {
  Watch wall(fromCatalogue("pyramid"), sheet.setting());
  const Snapshot start = wall.world().snapshot();
  wall.run(sheet.length(2.0, 0.1, 60.0));
  sheet.error("deepest penetration, 20 rows, of a box", "", wall.deepest(), fastAndExact(1e-2, 1e-6));
  sheet.error("movement of any box", "m", farthestMove(wall.world().snapshot(), start),
              fastAndExact(0.02, 1e-6));
  wall.writePromises(sheet);
}

// The same pyramid of base 10 in three sizes; times scale with the root.
void tinyPyramid(Sheet& sheet) {
  std::map<double, std::vector<double>> results;
  for (const double size : {1e-3, 0.05, 100.0}) {
    SceneDef scene = onFloor(kFrame * std::sqrt(size), 0.5);
    const int rows = sheet.length(8, 30);
    for (int row = 0; row < rows; ++row) {
      for (int column = 0; column < rows - row; ++column) {
        const double x = (column - 0.5 * (rows - row - 1)) * 1.1 * size;
        scene.bodies.push_back(box("", Vec3::Constant(size), Vec3(x, 0.0, (0.501 + row * 1.001) * size)));
        scene.bodies.back().material.friction = 0.5;
      }
    }
    Watch watch(scene, sheet.setting());
    watch.run(60 * scene.step);
    for (const BodyState& state : watch.world().snapshot().states) {
      for (int axis = 0; axis < 3; ++axis) results[size].push_back(state.pose.p_WB[axis] / size);
    }
    sheet.error(named("deepest penetration, boxes of %g m, of their size", size), "", watch.deepest() / size,
                fastAndExact(1e-2, 1e-6));
  }
  for (const double size : {1e-3, 100.0}) {
    double worst = 0.0;
    for (std::size_t k = 0; k < results[size].size(); ++k)
      worst = std::max(worst, std::abs(results[size][k] - results[0.05][k]));
    sheet.error(named("places after 60 steps, boxes of %g m against 0.05 m, of the size", size), "", worst,
                fastAndExact(1e-6, 1e-6));
  }
}

bool houseStands(Fidelity setting, double mu, double seconds) {
  SceneDef scene = fromCatalogue("card_house");
  for (BodyDef& def : scene.bodies) def.material.friction = mu;
  scene.fidelity = setting;
  World world(scene);
  const double top = world.snapshot().states.back().pose.p_WB.z();
  advance(world, seconds);
  return world.snapshot().states.back().pose.p_WB.z() > 0.9 * top;
}

void cardHouse(Sheet& sheet) {
  Watch watch(fromCatalogue("card_house"), sheet.setting());
  watch.run(sheet.length(1.0, 0.2, 1.0));
  const Snapshot early = watch.world().snapshot();
  watch.run(sheet.length(3.0, 0.2, 29.0));
  const Snapshot late = watch.world().snapshot();
  const double creep = farthestMove(late, early);
  sheet.error("creep after the first second", "m", creep, exact(1e-4));
  sheet.check("stands", creep < 0.1, fastAndExact(0.0, 0.0));
  watch.writePromises(sheet);
  if (!sheet.length(false, true)) return;
  double falls = 0.05, stands = 0.7;
  for (int k = 0; k < 7; ++k) {
    const double middle = 0.5 * (falls + stands);
    (houseStands(sheet.setting(), middle, 5.0) ? stands : falls) = middle;
  }
  sheet.error("least friction at which it stands 5 s", "", stands, shown());
}

void kapla(Sheet& sheet) {
  SceneDef scene = fromCatalogue("kapla");
  scene.step = 0.01;
  Watch watch(scene, sheet.setting());
  const Snapshot start = watch.world().snapshot();
  const long steps = sheet.length(200L, 10L, 60000L);
  long stood = 0;
  while (stood < steps && farthestMove(watch.world().snapshot(), start) < 0.5) watch.step(), ++stood;
  sheet.value("steps until it has moved by half a plank", "", stood, steps, fastAndExact(0.0, 0.0));
  sheet.error("movement of any plank", "m", farthestMove(watch.world().snapshot(), start),
              fastAndExact(5e-3, 1e-6));
  watch.writePromises(sheet);
}

// The speed of the wave between two dominoes: over the times at which they have leaned by 0.2 rad.
double waveSpeed(Fidelity setting, double step, bool* all_fell) {
  SceneDef scene = fromCatalogue("dominoes");
  scene.step = step;
  scene.fidelity = setting;
  World world(scene);
  std::vector<double> fell(15, -1.0);
  while (world.time() < 6.0 && fell[14] < 0.0) {
    world.step();
    for (int k = 0; k < 15; ++k) {
      const BodyState state = stateOf(world, "domino_" + std::to_string(k + 1));
      const double lean = std::acos(std::min(1.0, (state.pose.q_WB * Vec3::UnitZ()).z()));
      // The rate of the lean takes the time back to where it was 0.2 rad, so that the step does not show.
      if (fell[k] < 0.0 && lean >= 0.2)
        fell[k] = world.time() - (lean - 0.2) / std::max(0.1, state.twist.w_WB.y());
    }
  }
  *all_fell = fell[14] >= 0.0;
  return *all_fell ? 0.4 * 10 / (fell[13] - fell[3]) : 0.0;
}

void dominoes(Sheet& sheet) {
  if (sheet.isExact() && !sheet.length(false, true)) {  // takes minutes
    sheet.check("left to the full length", true, shown());
    return;
  }
  bool fell = false, fell_half = false;
  const double speed = waveSpeed(sheet.setting(), kFrame, &fell),
               half = waveSpeed(sheet.setting(), 0.5 * kFrame, &fell_half);
  sheet.check("all fifteen fall", fell && fell_half, fastAndExact(0.0, 0.0));
  sheet.error("speed of the wave at 60 Hz against 120 Hz, relative", "",
              half > 0.0 ? speed / half - 1.0 : 1.0, fastAndExact(1e-2, 1e-3));
  if (!sheet.length(false, true)) return;
  Watch ring(fromCatalogue("domino_ring"), sheet.setting());
  ring.run(60.0);
  int standing = 0;
  for (const BodyState& state : ring.world().snapshot().states) standing += state.pose.p_WB.z() > 0.45;
  sheet.error("dominoes of the ring that still stand", "", standing, fastAndExact(0.0, 0.0));
  ring.writePromises(sheet);
}

void jenga(Sheet& sheet) {
  for (const bool gaps : {false, true}) {
    SceneDef scene = fromCatalogue("jenga");
    if (gaps) {
      // The middle blocks are named ..._2, _5, _8 ...
      auto& bodies = scene.bodies;
      bodies.erase(std::remove_if(bodies.begin(), bodies.end(),
                                  [](const BodyDef& def) {
                                    const auto at = def.name.find('_');
                                    return at != std::string::npos &&
                                           std::stoi(def.name.substr(at + 1)) % 3 == 2;
                                  }),
                   bodies.end());
    }
    Watch watch(scene, sheet.setting());
    const Snapshot start = watch.world().snapshot();
    watch.run(sheet.length(3.0, 0.2, 60.0));
    const std::string which = gaps ? ", without the middle blocks" : "";
    sheet.error("movement of any block" + which, "m", farthestMove(watch.world().snapshot(), start),
                fastAndExact(5e-3, 1e-9));
    watch.writePromises(sheet);
  }
  SceneDef crossed = onFloor(kFrame, 0.5);
  for (int k = 0; k < 10; ++k) {
    crossed.bodies.push_back(box("box_" + std::to_string(k), Vec3(k % 2 ? 2.0 : 4.0, k % 2 ? 4.0 : 2.0, 1.0),
                                 Vec3(0.0, 0.0, 0.5 + k)));
    crossed.bodies.back().material.friction = 0.5;
  }
  Watch watch(crossed, sheet.setting());
  const Snapshot start = watch.world().snapshot();
  watch.run(sheet.length(5.0, 60.0));
  sheet.error("movement of ten boxes laid crosswise", "m", farthestMove(watch.world().snapshot(), start),
              fastAndExact(5e-3, 1e-9));
}

void heavyOnLight(Sheet& sheet) {
  for (const double ratio : {1e2, 1e3, 1e4, 1e6}) {
    for (const int n : {2, 5, 10}) {
      std::vector<double> masses(n, 1.0);
      masses.back() = ratio;
      Watch watch(column(masses), sheet.setting());
      watch.run(sheet.length(3.0, 20.0));
      const std::string of = named(", 1 : %g", ratio) + ", " + std::to_string(n) + " boxes";
      const bool asked = ratio == 1e3 && n == 2;
      sheet.error("impulses, relative" + of, "", impulseError(watch.world().snapshot()), exact(1e-8));
      sheet.error("deepest penetration, of the size" + of, "", watch.deepest(),
                  asked ? fastAndReference(1e-2, 1e-9) : referenceOnly(1e-9));
      watch.writeFinite(sheet);
    }
  }
  SceneDef scene = fromCatalogue("heavy_on_light");
  Watch watch(scene, sheet.setting());
  const Snapshot start = watch.world().snapshot();
  watch.run(sheet.length(5.0, 20.0));
  const Snapshot end = watch.world().snapshot();
  double sag = 0.0, away = 0.0;
  for (std::size_t k = 1; k < end.states.size(); ++k) {
    sag = std::max(sag, start.states[k].pose.p_WB.z() - end.states[k].pose.p_WB.z());
    away = std::max(away, (end.states[k].pose.p_WB - start.states[k].pose.p_WB).head<2>().norm());
  }
  sheet.error("1, 10 ... 1e4 kg, heaviest on top: sag", "m", sag, fastAndExact(5e-2, 1e-8));
  sheet.error("1, 10 ... 1e4 kg, heaviest on top: moved sideways", "m", away, fastAndExact(1e-2, 1e-9));
  watch.writePromises(sheet);
}

void redundantContacts(Sheet& sheet) {
  // A prism of n corners on the floor: n contact points.
  for (const int n : {4, 8, 64}) {
    std::vector<Vec3> points;
    for (int k = 0; k < n; ++k) {
      const double angle = 2.0 * kPi * k / n;
      for (const double z : {-0.2, 0.2})
        points.push_back(Vec3(0.5 * std::cos(angle), 0.5 * std::sin(angle), z));
    }
    SceneDef scene = onFloor(kFrame, 0.5);
    scene.bodies.push_back(body("prism", makeHull(points, "prism").hull, Vec3(0.0, 0.0, 0.2)));
    Watch watch(scene, sheet.setting());
    watch.run(2.0);
    const Snapshot snapshot = watch.world().snapshot();
    const std::string of = ", " + std::to_string(n) + " corners";
    sheet.error("sum of the impulses, relative to the weight" + of, "", impulseError(snapshot),
                fastAndExact(1e-4, 1e-10));
    sheet.error("speed at rest" + of, "m/s", fastestPoint(watch.world()), fastAndReference(1e-4, 1e-12));
  }

  SceneDef groove;
  groove.step = kFrame;
  for (const double side : {-1.0, 1.0}) {
    BodyDef wall = body(side < 0 ? "left" : "right", Plane{}, Vec3::Zero());
    wall.kind = BodyKind::Static;
    wall.pose.q_WB = Quat(Eigen::AngleAxisd(-side * 0.25 * kPi, Vec3::UnitY()));
    groove.bodies.push_back(wall);
  }
  BodyDef def = box("box", Vec3::Ones(), Vec3(0.0, 0.0, std::sqrt(0.5)));
  def.pose.q_WB = Quat(Eigen::AngleAxisd(0.25 * kPi, Vec3::UnitY()));
  groove.bodies.push_back(def);
  Watch watch(groove, sheet.setting());
  watch.run(2.0);
  const Snapshot snapshot = watch.world().snapshot();
  Vec3 sum = Vec3::Zero();
  for (const ContactPoint& point : snapshot.contacts)
    sum += point.normal_impulse * point.n_W + point.friction_impulse;
  const double weight = (*snapshot.bodies)[2].mass * kGravity * kFrame;
  sheet.error("box in a groove: sum of the impulses, relative", "",
              (sum - weight * Vec3::UnitZ()).norm() / weight, fastAndExact(1e-4, 1e-10));
  sheet.error("box in a groove: speed at rest", "m/s", fastestPoint(watch.world()),
              fastAndReference(1e-4, 1e-12));
}

void removedSupport(Sheet& sheet) {
  Watch watch(column(std::vector<double>(5, 1000.0)), sheet.setting());
  watch.run(3.0);
  watch.world().removeBody(watch.world().find("box_0"));
  watch.step();
  double slowest = -1e300;
  for (int k = 1; k < 5; ++k) slowest = std::max(slowest, watch["box_" + std::to_string(k)].twist.v_WB.z());
  sheet.value("speed one step after the lowest box is taken away, slowest, of g h", "",
              -slowest / (kGravity * kFrame), 1.0, fastAndReference(0.05, 1e-9));
}

}  // namespace

std::vector<Case> structureCases() {
  return {
      {"A34", "Stacks of cubes",
       "10, 30, 40 and 100 (not in the tests) cubes of 1 m on each other, μ = 0.5, stand for 60 s (5 to 10 s "
       "in the tests) "
       "at 60 Hz. Exact: each contact carries the weight above it.",
       stack},
      {"A35", "Column of balls",
       "30 balls in line (scene sphere_column) stay by symmetry alone for 10 s (3 s in the tests). With the "
       "top one 1e-6 m "
       "aside they fall; the time from 1e-5 to 1e-4 m is that of the linearised column that rolls, which is "
       "computed. Steps of "
       "1/960 s for that.",
       sphereColumn},
      {"A37", "Pyramid", "210 boxes in 20 rows (scene pyramid) for 60 s (2 s in the tests).", pyramids},
      {"A38", "Pyramids of all sizes",
       "A pyramid of base 30 (8 in the tests) of boxes of 1 mm, 5 cm and 100 m that fall by a thousandth of "
       "their size; "
       "steps scale with the root of the size. Places in units of the size are to be the same.",
       tinyPyramid},
      {"A39", "House of cards",
       "Five floors of cards of 2 mm × 0.2 × 0.4 m at 25° (scene card_house), μ = 0.7, for 30 s (4 s in the "
       "tests).",
       cardHouse},
      {"A41", "Kapla tower",
       "96 planks in six floors (scene kapla) for 60,000 steps of 0.01 s (200 in the tests).", kapla},
      {"A42", "Dominoes",
       "Fifteen dominoes (scene dominoes) fall; the speed of the wave between the fourth and the fourteenth "
       "at 60 Hz is "
       "compared with that at 120 Hz. Ring of 180 (scene domino_ring): all fall in 60 s (not in the tests).",
       dominoes},
      {"A43", "Jenga",
       "30 layers of three blocks (scene jenga), whole and without the middle blocks, and ten boxes laid "
       "crosswise, for 60 s "
       "(3 to 5 s in the tests).",
       jenga},
      {"A44", "Heavy on light",
       "Columns of 2, 5 and 10 cubes of 1 kg whose top has 1e2 to 1e6 kg, for 20 s (3 s in the tests); and "
       "1, 10, 100, 1000, "
       "10,000 kg, the heaviest on top (scene heavy_on_light).",
       heavyOnLight},
      {"A46", "More contacts than needed",
       "Prisms of 4, 8 and 64 corners on the floor and a box in a groove of 90°: the impulses sum to the "
       "weight, and nothing "
       "jitters.",
       redundantContacts},
      {"A48", "The support is taken away",
       "The lowest of five cubes at rest is removed: one step later the others fall at g h.", removedSupport},
  };
}

}  // namespace rbs::stability
