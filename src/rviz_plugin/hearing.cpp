// SPDX-License-Identifier: BSD-3-Clause
#include "hearing.h"

namespace rbs {

Hearing::Hearing() {
  constexpr int kPeriod = 250, kMostQuiet = 8;  // ms; looks
  connect(&looks_, &QTimer::timeout, this, [this] {
    if (is_heard_ && ++quiet_ > kMostQuiet) set(false);
  });
  looks_.start(kPeriod);
}

void Hearing::hear() {
  quiet_ = 0;
  set(true);
}

void Hearing::set(bool is_heard) {
  if (is_heard == is_heard_) return;
  is_heard_ = is_heard;
  Q_EMIT changed(is_heard);
}

}  // namespace rbs
