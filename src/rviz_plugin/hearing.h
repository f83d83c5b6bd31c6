// SPDX-License-Identifier: BSD-3-Clause
// Hearing: whether a node is heard.
#pragma once

#include <QObject>
#include <QTimer>

#include <cstdint>
#include <memory>

namespace rbs {

/// A node sends ten statuses a second. It counts as gone when none has come for eight looks, 2 s, at most one for each picture of RViz. Silence is counted in looks, not
/// in time: an RViz that takes seconds for a picture looks, and hears, as seldom. Nor do looks count while RViz takes no messages,
/// as long as a dialog of its own is open.
class Hearing : public QObject {
  Q_OBJECT
 public:
  Hearing();
  ~Hearing() override;
  bool isHeard() const { return is_heard_; }
  /// A status has come, or another message.
  void hear();
  /// Another node is followed, which is yet to be heard.
  void forget() { set(false); }

 Q_SIGNALS:
  void changed(bool is_heard);

 private:
  void set(bool is_heard);
  void look();
  std::uint64_t markId() const { return reinterpret_cast<std::uint64_t>(this); }

  QTimer looks_;
  int quiet_ = 0;  ///< looks since the last status
  bool is_heard_ = false;
  /// Written where messages are taken: by the thread of Qt.
  std::shared_ptr<bool> takes_messages_ = std::make_shared<bool>(true);  ///< since the last look
};

}  // namespace rbs
