// SPDX-License-Identifier: BSD-3-Clause
#include "scene/scene_generators.h"

#include "base/algebra.h"

namespace rbs {
namespace {

std::string numbered(const std::string& name, std::size_t index) {
  return name.empty() ? name : name + "_" + std::to_string(index + 1);
}

/// A ball as wide as the body, or a box: a cube where the body is a ball.
Shape recast(const Shape& shape, const std::string& name) {
  const Vec3 size = fullExtents(shape);
  if (name == "sphere") return Sphere{0.5 * size.x()};
  return Box{size};
}

void vary(BodyDef& body, const Repeat& repeat, SplitMix64& random) {
  if (!repeat.shapes.empty()) {
    body.shape = recast(body.shape, repeat.shapes[random.below(repeat.shapes.size())]);
  }
  if (repeat.scale[0] != 1.0 || repeat.scale[1] != 1.0) {
    body.shape = scaled(body.shape, random.uniform(repeat.scale[0], repeat.scale[1]));
  }
  if (repeat.jitter > 0.0) {
    for (int axis = 0; axis < 3; ++axis) {
      body.pose.p_WB[axis] += random.uniform(-repeat.jitter, repeat.jitter);
    }
  }
  if (repeat.turn) body.pose.q_WB = randomAttitude(random);
  if (repeat.speed > 0.0) body.twist.v_WB += repeat.speed * (randomAttitude(random) * Vec3::UnitX());
}

}  // namespace

double bodyCount(const Repeat& repeat) {
  return static_cast<double>(repeat.count[0]) * repeat.count[1] * repeat.count[2];
}

double bodyCount(const Pyramid& pyramid) {
  return 0.5 * pyramid.rows * (pyramid.rows + 1.0);
}

double bodyCount(const Ring& ring) {
  return ring.count;
}

// n (n+1)/2 pairs, and across them one card fewer than pairs in each floor.
double bodyCount(const CardHouse& house) {
  const double n = house.floors;
  return n * (n + 1.0) + 0.5 * n * (n - 1.0);
}

std::vector<BodyDef> expand(const BodyDef& body, const Repeat& repeat, SplitMix64 random) {
  std::vector<BodyDef> bodies;
  for (std::uint32_t k = 0; k < repeat.count[2]; ++k) {
    for (std::uint32_t j = 0; j < repeat.count[1]; ++j) {
      for (std::uint32_t i = 0; i < repeat.count[0]; ++i) {
        BodyDef copy = body;
        copy.name = numbered(body.name, bodies.size());
        copy.pose.p_WB += Vec3(i, j, k).cwiseProduct(repeat.spacing);
        vary(copy, repeat, random);
        bodies.push_back(std::move(copy));
      }
    }
  }
  return bodies;
}

std::vector<BodyDef> expand(const BodyDef& body, const Pyramid& pyramid) {
  const Vec3 size = fullExtents(body.shape);
  const double pitch = size.x() + pyramid.gap;
  std::vector<BodyDef> bodies;
  for (std::uint32_t row = 0; row < pyramid.rows; ++row) {
    const std::uint32_t columns = pyramid.rows - row;
    for (std::uint32_t column = 0; column < columns; ++column) {
      BodyDef copy = body;
      copy.name = numbered(body.name, bodies.size());
      copy.pose.p_WB.x() += (column - 0.5 * (columns - 1.0)) * pitch;
      copy.pose.p_WB.z() += row * size.z();
      bodies.push_back(std::move(copy));
    }
  }
  return bodies;
}

std::vector<BodyDef> expand(const BodyDef& body, const Ring& ring) {
  std::vector<BodyDef> bodies;
  for (std::uint32_t k = 0; k < ring.count; ++k) {
    const Quat turn = rotationBy(2.0 * kPi * (ring.degrees / 360.0 + double(k) / ring.count) * Vec3::UnitZ());
    BodyDef copy = body;
    copy.name = numbered(body.name, k);
    copy.pose.p_WB += turn * Vec3(ring.radius, 0.0, 0.0);
    copy.pose.q_WB = turn * body.pose.q_WB;
    copy.twist.v_WB = turn * body.twist.v_WB;
    copy.twist.w_WB = turn * body.twist.w_WB;
    bodies.push_back(std::move(copy));
  }
  return bodies;
}

// A card of height H and thickness T that leans by t reaches X = (H sin t + T cos t)/2 to either side and
// Z = (H cos t + T sin t)/2 up and down. Two whose upper corners meet have their centres 2 X apart; a card
// that lies from top to top makes the pitch of the pairs H, and a floor 2 Z + T high.
std::vector<BodyDef> expand(const BodyDef& body, const CardHouse& house) {
  const Vec3 size = fullExtents(body.shape);
  const double H = size.z(), T = size.x(), t = house.degrees * kPi / 180.0;
  const double X = 0.5 * (H * std::sin(t) + T * std::cos(t)), Z = 0.5 * (H * std::cos(t) + T * std::sin(t));
  std::vector<BodyDef> bodies;
  const auto add = [&](double x, double z, double angle) {
    BodyDef card = body;
    card.name = numbered(body.name, bodies.size());
    card.pose.p_WB += Vec3(x, 0.0, z);
    card.pose.q_WB = rotationBy(angle * Vec3::UnitY()) * body.pose.q_WB;
    bodies.push_back(std::move(card));
  };
  for (std::uint32_t floor = 0; floor < house.floors; ++floor) {
    const std::uint32_t pairs = house.floors - floor;
    const double base = floor * (2.0 * Z + T);
    const auto middle = [&](double pair) { return (pair - 0.5 * (pairs - 1.0)) * H; };
    for (std::uint32_t k = 0; k < pairs; ++k) {
      add(middle(k) - X, base + Z, t);
      add(middle(k) + X, base + Z, -t);
    }
    for (std::uint32_t k = 0; k + 1 < pairs; ++k) add(middle(k + 0.5), base + 2.0 * Z + 0.5 * T, 0.5 * kPi);
  }
  return bodies;
}

}  // namespace rbs
