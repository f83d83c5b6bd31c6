// SPDX-License-Identifier: BSD-3-Clause
// Pairs of bodies that may touch, and the points at which they did, with the forces that warm-start them.
#pragma once

#include "bodies.h"

#include <cstdint>
#include <utility>
#include <vector>

namespace rbs {

/// One contact point at the end of its last solve.
struct Touch {
  std::uint32_t feature = 0;               ///< finds the same point again in the next step
  double normal = 0.0;                     ///< N, >= 0: the guess for the next solve
  Vec3 friction_W = Vec3::Zero();          ///< on body j, N: likewise
  Vec3 p_W = Vec3::Zero();                 ///< m
  Vec3 n_W = Vec3::UnitZ();                ///< unit, from i to j
  double separation = 0.0;                 ///< m
  double normal_impulse = 0.0;             ///< over the part of the step that was solved last, N s
  Vec3 friction_impulse_W = Vec3::Zero();  ///< likewise, on body j
};

/// Two bodies whose bounds overlap, i before j in canonical order.
struct ContactPair {
  BodyId id_i, id_j;
  Index i = kNone, j = kNone;  ///< dense indices, valid for the step
  Index first = 0, size = 0;   ///< its touches in the store's list
  bool exact = false;          ///< solved by the exact step

  std::pair<BodyId, BodyId> key() const { return {id_i, id_j}; }
};

/// The pairs of a step, by key, and their touches.
struct Contacts {
  std::vector<ContactPair> pairs;
  std::vector<Touch> touches;

  void clear() { pairs.clear(), touches.clear(); }
};

}  // namespace rbs
