// SPDX-License-Identifier: BSD-3-Clause
#include "baseline.h"

namespace rbs {

double Baseline::valueOf(const History& history, const std::string& curve) {
  const auto known = values_.find(curve);
  if (known != values_.end()) return known->second;
  const Trace& trace = history.present(curve);
  if (trace.empty()) return 0.0;
  const double value =
      trace.valueAt(isIn(history) ? time_ : trace.begin()).value_or(*trace.valueAt(trace.begin()));
  values_[curve] = value;
  return value;
}

}  // namespace rbs
