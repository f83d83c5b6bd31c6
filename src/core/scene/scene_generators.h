// SPDX-License-Identifier: BSD-3-Clause
// Many bodies from one entry of a scene file: grids, rings, walls laid like bricks, and houses of cards.
#pragma once

#include "base/random.h"
#include "rigid_body_sim/scene.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace rbs {

/// Copies of a body on a grid that begins at the body's own position.
struct Repeat {
  std::array<std::uint32_t, 3> count{1, 1, 1};  ///< along x, y and z of W, each >= 1
  Vec3 spacing = Vec3::Zero();                  ///< m, from one copy to the next
  double jitter = 0.0;                          ///< each copy is moved by up to this along each axis, m
  bool turn = false;                            ///< whether each copy gets a random orientation
  std::array<double, 2> scale{1.0, 1.0};  ///< each copy's size is multiplied by a number from this range
  std::vector<std::string> shapes;        ///< each copy is one of these at random; empty: that of the body
  double speed = 0.0;  ///< speed in a random direction, added to the velocity of each copy, m/s, >= 0
};

/// Boxes laid in rows, each one box shorter than the row below: a wall in the plane of x and z. The
/// body's position is the middle of the bottom row.
struct Pyramid {
  std::uint32_t rows = 1;  ///< >= 1, boxes in the bottom row as well
  double gap = 0.0;        ///< between neighbours of a row, m
};

/// Copies on a circle about the vertical through the body's position, each rotated by its angle on the
/// circle.
struct Ring {
  std::uint32_t count = 1;  ///< >= 1
  double radius = 1.0;      ///< m, > 0
  double degrees = 0.0;     ///< where the first is, from +x counter-clockwise
};

/// A house of cards in the plane of x and z: floors of pairs that lean on each other, a card across from top
/// to top, and on these the next floor, one pair shorter. The body is a card: thin along x, standing along z.
/// Its position is the middle of the house on the ground.
struct CardHouse {
  std::uint32_t floors = 1;  ///< >= 1, pairs in the lowest floor as well
  double degrees = 25.0;     ///< from the vertical, above 0 and below 45
};

double bodyCount(const Repeat& repeat);
double bodyCount(const Pyramid& pyramid);
double bodyCount(const Ring& ring);
double bodyCount(const CardHouse& house);

/// In order x fastest, then y, then z; named after the body: "ball_1", "ball_2" ... A body without a
/// name gives bodies without names.
std::vector<BodyDef> expand(const BodyDef& body, const Repeat& repeat, SplitMix64 random);
/// From left to right, the bottom row first. The body's shape is a box.
std::vector<BodyDef> expand(const BodyDef& body, const Pyramid& pyramid);
/// Counter-clockwise.
std::vector<BodyDef> expand(const BodyDef& body, const Ring& ring);
/// The lowest floor first, each from left to right and its cards across after its pairs. The body's shape is
/// a box.
std::vector<BodyDef> expand(const BodyDef& body, const CardHouse& house);

}  // namespace rbs
