// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <utility>

namespace rbs {

/// An interval at whose ends a continuous function has opposite signs, so that it has a root in between. It is narrowed by false
/// position: the next guess is where a straight line between the ends has its root. An end that stays twice in a row counts half
/// as much each time, or the other would creep (Illinois rule: M. Dowell and P. Jarratt, "A modified regula falsi
/// method for computing the root of an equation", BIT 11, 1971). So the error falls with the power 1.44 of itself a value.
class Bracket {
 public:
  Bracket(double low, double f_low, double high, double f_high)
      : low_(low), f_low_(f_low), high_(high), f_high_(f_high) {}
  double low() const { return low_; }
  double high() const { return high_; }
  double width() const { return high_ - low_; }
  double guess() const { return (low_ * f_high_ - high_ * f_low_) / (f_high_ - f_low_); }
  /// Narrows it by the value `f` of the function at `x`, between the ends.
  void narrow(double x, double f) {
    if ((f > 0.0) == (f_low_ > 0.0)) {
      low_ = x, f_low_ = f;
      if (std::exchange(stayed_, 1) == 1) f_high_ *= 0.5;
    } else {
      high_ = x, f_high_ = f;
      if (std::exchange(stayed_, -1) == -1) f_low_ *= 0.5;
    }
  }

 private:
  double low_, f_low_, high_, f_high_;  // values as the rule weighs them
  int stayed_ = 0;  // the end that the last value has left: 1 the high one, -1 the low one
};

}  // namespace rbs
