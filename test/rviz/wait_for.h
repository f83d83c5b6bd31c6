// SPDX-License-Identifier: BSD-3-Clause
// Waiting for what a panel and a simulator do, while messages and events are handled.
#pragma once

#include <ros/ros.h>

#include <QElapsedTimer>
#include <QTest>

#include <functional>

namespace rbs::test {

inline constexpr int kPatience = 30'000;  // ms

/// Whether the condition has come true within kPatience.
inline bool waitFor(const std::function<bool()>& condition) {
  QElapsedTimer time;
  time.start();
  while (!condition()) {
    if (time.elapsed() > kPatience) return false;
    ros::spinOnce();
    QTest::qWait(5);
  }
  return true;
}

}  // namespace rbs::test
