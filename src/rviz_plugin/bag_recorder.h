// SPDX-License-Identifier: BSD-3-Clause
// BagRecorder: records a simulator into a bag, by a process of its own.
#pragma once

#include <QElapsedTimer>
#include <QObject>
#include <QProcess>
#include <QString>
#include <QTimer>

namespace rbs {

/// Runs this package's program `record`. It outlives neither RViz nor this object: both end it by SIGINT, and the bag is
/// whole. Nothing here waits for it.
class BagRecorder : public QObject {
  Q_OBJECT
 public:
  /// Closing: it writes the index of the bag, after stop().
  enum class State { Idle, Recording, Closing };

  BagRecorder();
  ~BagRecorder() override;

  /// Records the node of this name into a new bag in `folder`, ~/sim_<date>.bag for instance. Only while idle.
  void start(const QString& node, const QString& folder);
  /// Ends the recording; the bag is closed some time later.
  void stop();
  /// start() while idle, else stop().
  void toggle(const QString& node, const QString& folder);

  State state() const { return state_; }

 Q_SIGNALS:
  void stateChanged();
  /// What to show: the file, time and size of what is recorded; afterwards where it is, or why there is none.
  void reported(const QString& text, bool is_trouble);

 private:
  void setState(State state);
  void readOutput();
  void reportProgress();
  void finish(int code, QProcess::ExitStatus status);
  void fail(QProcess::ProcessError error);

  QProcess* process_ = nullptr;  ///< null while idle
  State state_ = State::Idle;
  QString file_;
  QString trouble_;  ///< the last warning or error of the recorder
  QElapsedTimer elapsed_;
  QTimer progress_;
  double seconds_ = 0.0;  ///< recorded, when it was stopped
};

}  // namespace rbs
