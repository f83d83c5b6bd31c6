// SPDX-License-Identifier: BSD-3-Clause
#include "physics_time.h"

#include <cmath>

namespace rbs {
namespace {

constexpr double kSame = 1e-6;  // s: stamps are rounded, and move by a nanosecond at an edit

}  // namespace

bool PhysicsTime::learn(double stamp, double time) {
  before_ = last_;
  last_ = Status{stamp, time};
  if (!before_) return false;
  const bool is_alike = std::abs(last_->offset() - before_->offset()) < kSame;
  const bool jumped_ahead = is_steady_ && last_->offset() < before_->offset() - kSame;
  has_begun_ = time < before_->time || stamp < before_->stamp || jumped_ahead;
  if (!has_begun_) is_steady_ = is_alike;
  return has_begun_;
}

std::optional<PhysicsTime::When> PhysicsTime::of(double stamp) const {
  if (!last_ || stamp > last_->stamp) return std::nullopt;
  if (stamp == last_->stamp) return When{last_->time, true};
  if (!before_ || !is_steady_ || stamp <= before_->stamp) return std::nullopt;
  if (!has_begun_) return When{stamp - last_->offset(), true};
  const bool began_at_zero = last_->offset() > before_->stamp - kSame;
  if (!began_at_zero) return std::nullopt;  // taken back, or loaded in the middle: nothing says when
  if (stamp >= last_->offset() - kSame) return When{std::fmax(0.0, stamp - last_->offset()), true};
  return When{stamp - before_->offset(), false};
}

}  // namespace rbs
