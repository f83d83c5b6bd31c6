// SPDX-License-Identifier: BSD-3-Clause
// Hearing: whether a node is heard.
#pragma once

#include <QObject>
#include <QTimer>

namespace rbs {

/// A node sends ten statuses a second. It counts as gone when none has come for eight looks, 2 s. Silence is counted in looks, not
/// in time: an RViz that takes seconds for a picture looks, and hears, as seldom.
class Hearing : public QObject {
  Q_OBJECT
 public:
  Hearing();
  bool isHeard() const { return is_heard_; }
  /// A status has come, or another message.
  void hear();
  /// Another node is followed, which is yet to be heard.
  void forget() { set(false); }

 Q_SIGNALS:
  void changed(bool is_heard);

 private:
  void set(bool is_heard);

  QTimer looks_;
  int quiet_ = 0;  ///< looks since the last status
  bool is_heard_ = false;
};

}  // namespace rbs
