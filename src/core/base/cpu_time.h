// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ctime>

namespace rbs {

/// CPU time of this thread, s.
inline double threadCpuSeconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace rbs
