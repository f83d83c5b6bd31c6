// SPDX-License-Identifier: BSD-3-Clause
#include "random_scene.h"

#include "rigid_body_sim/shape.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

namespace rbs::hunt {

namespace {

class Draw {
 public:
  explicit Draw(std::uint64_t seed) : random_(seed) {}

  double between(double low, double high) { return low + (high - low) * std::ldexp(random_() >> 11, -53); }
  // Evenly by orders of magnitude.
  double magnitude(double low, double high) { return low * std::pow(high / low, between(0.0, 1.0)); }
  std::size_t index(std::size_t size) { return random_() % size; }
  bool chance(double share) { return between(0.0, 1.0) < share; }
  double oneOf(const std::vector<double>& values) { return values[index(values.size())]; }
  Vec3 inBall(double radius) {
    for (;;) {
      const double x = between(-1.0, 1.0), y = between(-1.0, 1.0), z = between(-1.0, 1.0);
      const Vec3 v(x, y, z);
      if (v.squaredNorm() <= 1.0) return radius * v;
    }
  }
  Quat orientation() {
    for (;;) {
      const Vec3 xyz = inBall(1.0);
      const Quat q(between(-1.0, 1.0), xyz.x(), xyz.y(), xyz.z());
      if (q.norm() > 0.1 && q.norm() < 1.0) return q.normalized();
    }
  }

 private:
  std::mt19937_64 random_;
};

// A shape of about this size: compact, flat or long.
Shape anyShape(Draw& draw, double size) {
  const auto side = [&] {
    return size * (draw.chance(0.2) ? draw.magnitude(0.02, 0.3) : draw.between(0.4, 1.6));
  };
  switch (draw.index(7)) {
    case 0:
      return Sphere{0.5 * size};
    case 1:
      return Box{Vec3::Constant(size)};
    case 2: {
      const double x = side(), y = side();
      return Box{{x, y, side()}};
    }
    case 3: {
      const double radius = 0.5 * side();
      return Capsule{radius, 0.5 * side()};
    }
    case 4: {
      const double radius = 0.5 * side();
      return Cylinder{radius, 0.5 * side()};
    }
    case 5: {
      const double radius = 0.5 * side();
      return Cone{radius, side()};
    }
    default: {
      std::vector<Vec3> corners(5 + draw.index(12));
      for (Vec3& corner : corners) corner = draw.inBall(0.5 * size);
      return makeHull(corners, "corners").hull;
    }
  }
}

// How bodies are made in one scene.
struct Habit {
  double size = 0.4;          // m
  double sizes = 1.0;         // the largest over the smallest
  double densities = 1.0;     // the densest over the least dense
  double speed = 1.0;         // m/s, at most
  double spin = 3.0;          // rad/s, at most
  Material material;          // of all bodies, or
  bool own_material = false;  // each has its own
};

Material anyMaterial(Draw& draw) {
  Material material;
  material.friction = draw.oneOf({0.0, 0.1, 0.4, 0.6, 0.6, 1.0, 3.0});
  material.restitution = draw.oneOf({0.0, 0.0, 0.0, 0.3, 0.7, 0.95, 1.0});
  if (draw.chance(0.15)) material.rolling_resistance = draw.between(0.0, 0.1);
  if (draw.chance(0.15)) material.torsional_resistance = draw.between(0.0, 0.1);
  return material;
}

class Builder {
 public:
  Builder(Draw& draw, const Habit& habit, SceneDef& scene) : draw_(draw), habit_(habit), scene_(scene) {}

  BodyDef& add(const std::string& name, const Shape& shape, const Vec3& p_W) {
    BodyDef def;
    def.name = name + "_" + std::to_string(scene_.bodies.size());
    def.shape = shape;
    def.pose.p_WB = p_W;
    def.material = habit_.own_material ? anyMaterial(draw_) : habit_.material;
    scene_.bodies.push_back(def);
    return scene_.bodies.back();
  }
  BodyDef& carrier(const std::string& name, const Shape& shape, const Vec3& p_W) {
    BodyDef& def = add(name, shape, p_W);
    def.kind = BodyKind::Static;
    return def;
  }
  BodyDef& dynamic(const Shape& shape, const Vec3& p_W) {
    BodyDef& def = add("body", shape, p_W);
    def.density = 1000.0 * draw_.magnitude(1.0 / std::sqrt(habit_.densities), std::sqrt(habit_.densities));
    return def;
  }
  BodyDef& moving(const Shape& shape, const Vec3& p_W) {
    BodyDef& def = dynamic(shape, p_W);
    def.pose.q_WB = draw_.orientation();
    def.twist = {draw_.inBall(habit_.speed), draw_.inBall(habit_.spin)};
    return def;
  }
  double size() {
    return habit_.size * draw_.magnitude(1.0 / std::sqrt(habit_.sizes), std::sqrt(habit_.sizes));
  }

 private:
  Draw& draw_;
  const Habit& habit_;
  SceneDef& scene_;
};

void addFloor(Draw& draw, Builder& builder) {
  switch (draw.index(4)) {
    case 0:
    case 1:
      builder.carrier("floor", Plane{}, Vec3::Zero());
      break;
    case 2:
      builder.carrier("slab", Box{{40.0, 40.0, 2.0}}, {0.0, 0.0, -1.0});
      break;
    default:
      for (int i = -2; i < 2; ++i)
        for (int j = -2; j < 2; ++j)
          builder.carrier("tile", Box{{2.0, 2.0, 1.0}}, {2.0 * i + 1.0, 2.0 * j + 1.0, -0.5});
  }
}

// Bodies above each other, none of which touches another yet.
void dropHeap(Draw& draw, Builder& builder, int bodies) {
  double top = 0.05;
  for (int k = 0; k < bodies; ++k) {
    const Shape shape = anyShape(draw, builder.size());
    const double radius = boundingRadius(shape);
    builder.moving(shape, Vec3(draw.between(-0.5, 0.5), draw.between(-0.5, 0.5), top + radius));
    top += 2.05 * radius;
  }
}

// Blocks and discs on each other, each a little aside.
void stack(Draw& draw, Builder& builder, int bodies) {
  double top = 0.0;
  Vec3 at = Vec3::Zero();
  for (int k = 0; k < bodies; ++k) {
    const double size = builder.size();
    Shape shape = draw.chance(0.7)
                      ? Shape(Box{{size, size * draw.between(0.5, 1.5), size * draw.between(0.1, 1.5)}})
                      : Shape(Cylinder{0.5 * size, 0.5 * size * draw.between(0.1, 1.0)});
    const double height = fullExtents(shape).z();
    if (k > 0) at += size * Vec3(draw.between(-0.3, 0.3), draw.between(-0.3, 0.3), 0.0);
    at.z() = top + 0.5 * height;
    builder.dynamic(shape, at).pose.q_WB = Quat(Eigen::AngleAxisd(draw.between(-3.0, 3.0), Vec3::UnitZ()));
    top += height;
  }
}

// A plate that moves or turns about the vertical, with bodies above it.
void carry(Draw& draw, Builder& builder, int bodies) {
  BodyDef& plate = builder.carrier("plate", Box{{8.0, 8.0, 0.5}}, {0.0, 0.0, -0.25});
  plate.kind = BodyKind::Kinematic;
  plate.twist = {draw.inBall(1.0), draw.between(-3.0, 3.0) * Vec3::UnitZ()};
  dropHeap(draw, builder, bodies);
}

// A plate that comes down on what stands on a floor.
void squeeze(Draw& draw, Builder& builder, int bodies) {
  builder.carrier("floor", Plane{}, Vec3::Zero());
  stack(draw, builder, bodies);
  BodyDef& plate = builder.carrier("plate", Box{{20.0, 20.0, 0.2}}, {0.0, 0.0, 0.3 + 2.0 * bodies});
  plate.kind = BodyKind::Kinematic;
  plate.twist.v_WB = {0.0, 0.0, -draw.magnitude(0.3, 10.0)};
}

// Six walls around bodies.
void room(Draw& draw, Builder& builder, int bodies) {
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0})
      builder.carrier("wall", Box{Vec3::Constant(6.0) - 4.0 * Vec3::Unit(axis)},
                      3.0 * side * Vec3::Unit(axis));
  for (int k = 0; k < std::min(bodies, 8); ++k)
    builder.moving(anyShape(draw, std::min(builder.size(), 0.9)),
                   Vec3(k & 1 ? 0.9 : -0.9, k & 2 ? 0.9 : -0.9, k & 4 ? 0.9 : -0.9));
}

// Bodies that fly towards each other, without a floor.
void cloud(Draw& draw, Builder& builder, int bodies) {
  for (int k = 0; k < bodies; ++k) {
    const Vec3 place = 1.5 * Vec3(k % 3 - 1, k / 3 % 3 - 1, k / 9);
    builder.moving(anyShape(draw, std::min(builder.size(), 0.8)), place).twist.v_WB -= place;
  }
}

// Bodies that were put into each other.
void overlap(Draw& draw, Builder& builder, int bodies) {
  builder.carrier("floor", Plane{}, Vec3::Zero());
  for (int k = 0; k < bodies; ++k) {
    const Vec3 aside = draw.inBall(0.3);
    builder.moving(anyShape(draw, builder.size()), aside + 0.3 * Vec3::UnitZ());
  }
}

// Something kinematic that turns and comes from aside, and does not touch a moving body yet.
void addPaddle(Draw& draw, Builder& builder, const SceneDef& scene) {
  const double angle = draw.between(-3.0, 3.0);
  const Vec3 from_W(std::cos(angle), std::sin(angle), draw.between(-0.1, 0.5));
  const Shape shape = anyShape(draw, draw.magnitude(0.3, 3.0));
  double way = 0.0;
  for (const BodyDef& def : scene.bodies)
    if (def.kind == BodyKind::Dynamic)
      way = std::max(way, (def.pose.p_WB.norm() + boundingRadius(def.shape)) / from_W.norm());
  BodyDef& paddle = builder.carrier("paddle", shape, (way + boundingRadius(shape)) * from_W);
  paddle.kind = BodyKind::Kinematic;
  paddle.pose.q_WB = draw.orientation();
  paddle.twist = {-draw.magnitude(0.3, 10.0) * from_W, draw.inBall(10.0)};
}

}  // namespace

SceneDef randomScene(std::uint64_t seed) {
  Draw draw(seed);
  SceneDef scene;
  scene.name = "hunt_" + std::to_string(seed);
  scene.fidelity = kFidelities[draw.index(kFidelities.size())];
  scene.step = draw.oneOf({1e-3, 1.0 / 240.0, 1.0 / 60.0, 1.0 / 60.0, 1.0 / 30.0, 0.1});
  Habit habit;
  habit.material = anyMaterial(draw);
  habit.own_material = draw.chance(0.3);
  if (draw.chance(0.3)) habit.sizes = draw.magnitude(1.0, 30.0);
  if (draw.chance(0.3)) habit.densities = draw.magnitude(1.0, 1e4);
  if (draw.chance(0.3)) habit.speed = draw.magnitude(1.0, 100.0);
  if (draw.chance(0.3)) habit.spin = draw.magnitude(1.0, 300.0);
  const bool extreme = draw.chance(0.1);
  if (extreme) {
    habit.sizes = 100.0, habit.densities = 1e6, habit.speed = 1e3, habit.spin = 1e4;
    scene.step = draw.magnitude(1e-3, 0.25);
  }
  Builder builder(draw, habit, scene);
  const int bodies = draw.chance(0.3) ? 1 : 1 + static_cast<int>(draw.index(12));
  switch (draw.index(8)) {
    case 0:
      scene.gravity.setZero();
      cloud(draw, builder, bodies);
      break;
    case 1:
      carry(draw, builder, bodies);
      break;
    case 2:
      squeeze(draw, builder, std::min(bodies, 5));
      break;
    case 3:
      overlap(draw, builder, bodies);
      break;
    case 4:
      room(draw, builder, bodies);
      break;
    case 5:
      addFloor(draw, builder);
      stack(draw, builder, bodies);
      break;
    default:
      addFloor(draw, builder);
      dropHeap(draw, builder, bodies);
  }
  if (draw.chance(0.1)) scene.gravity = draw.inBall(30.0);
  if (draw.chance(0.1)) scene.air = Air{draw.magnitude(1e-3, 20.0)};
  if (draw.chance(0.2)) addPaddle(draw, builder, scene);
  return scene;
}

}  // namespace rbs::hunt
