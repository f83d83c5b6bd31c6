#include "scene_generators.h"

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
}

}  // namespace

double bodyCount(const Repeat& repeat) {
  return static_cast<double>(repeat.count[0]) * repeat.count[1] * repeat.count[2];
}

double bodyCount(const Pyramid& pyramid) {
  return 0.5 * pyramid.rows * (pyramid.rows + 1.0);
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

}  // namespace rbs
