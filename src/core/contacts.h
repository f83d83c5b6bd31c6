// SPDX-License-Identifier: BSD-3-Clause
// Pairs of bodies that may touch, and the points at which they did, with the forces that warm-start them.
#pragma once

#include "bodies.h"

#include <cstdint>
#include <iterator>
#include <map>
#include <tuple>
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

  /// Takes an impulse on body j, N s, for its parts along n_W and across it.
  void setImpulse(const Vec3& impulse_W) {
    normal_impulse = impulse_W.dot(n_W);
    friction_impulse_W = impulse_W - normal_impulse * n_W;
  }
  /// Adds the impulse that the same point gave earlier in the step, when its normal may have been another:
  /// the whole of it stays normal_impulse n_W + friction_impulse_W.
  void addImpulseOf(const Touch& earlier) {
    normal_impulse += earlier.normal_impulse;
    friction_impulse_W += earlier.friction_impulse_W + earlier.normal_impulse * (earlier.n_W - n_W);
  }
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

/// Touches, each with the place of its pair in a Contacts.
using PairTouches = std::vector<std::pair<Index, Touch>>;

/// Impulses that points have given in a step, but for those that the contacts of the step hold at its end: of
/// located impacts, of parts of the step before the last, and of points that have opened. One touch for each
/// point of a pair, as it was last.
class EarlierImpulses {
 public:
  using Key = std::tuple<BodyId, BodyId, std::uint32_t>;  ///< the pair, i before j, and the feature

  void add(BodyId i, BodyId j, const Touch& touch) {
    if (touch.normal_impulse == 0.0 && touch.friction_impulse_W.isZero(0.0)) return;
    Touch& known = touches_[{i, j, touch.feature}];
    const Touch before = std::exchange(known, touch);
    known.addImpulseOf(before);
  }
  /// Adds those of a pair's touches, which are about to be replaced.
  void add(const ContactPair& pair, const std::vector<Touch>& touches) {
    for (Index t = pair.first; t < pair.first + pair.size; ++t) add(pair.id_i, pair.id_j, touches[t]);
  }
  /// Adds those of points that have opened.
  void add(const PairTouches& opened, const std::vector<ContactPair>& pairs) {
    for (const auto& [k, touch] : opened) add(pairs[k].id_i, pairs[k].id_j, touch);
  }
  /// Drops those of a body.
  void forget(BodyId id) {
    for (auto it = touches_.begin(); it != touches_.end();) {
      const bool of_body = std::get<0>(it->first) == id || std::get<1>(it->first) == id;
      it = of_body ? touches_.erase(it) : std::next(it);
    }
  }
  void clear() { touches_.clear(); }
  const std::map<Key, Touch>& touches() const { return touches_; }

 private:
  std::map<Key, Touch> touches_;
};

}  // namespace rbs
