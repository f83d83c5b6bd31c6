// SPDX-License-Identifier: BSD-3-Clause
#include "bag_recorder.h"

#include <QDateTime>
#include <QDir>
#include <QFileInfo>
#include <QRegularExpression>

#include <signal.h>
#include <sys/prctl.h>

namespace rbs {
namespace {

constexpr int kProgressPeriod = 500;  // ms

/// Interrupted where RViz ends, however it ends.
class Process : public QProcess {
 public:
  using QProcess::QProcess;

 protected:
  void setupChildProcess() override {
    sigset_t none;
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, nullptr);
    signal(SIGINT, SIG_DFL);
    prctl(PR_SET_PDEATHSIG, SIGINT);
  }
};

void interrupt(const QProcess& process) {
  if (process.processId() > 0) kill(static_cast<pid_t>(process.processId()), SIGINT);
}

QString megabytes(double bytes) {
  return QString::number(1e-6 * bytes, 'f', bytes < 1e7 ? 1 : 0) + " MB";
}

QString wholeSeconds(double seconds) {
  const auto whole = static_cast<int>(seconds);
  return QString("%1:%2").arg(whole / 60).arg(whole % 60, 2, 10, QChar('0'));
}

/// The text of a line of trouble in the output of the recorder; empty for any other line.
QString troubleIn(QString line) {
  static const QRegularExpression kColor("\\x1b\\[[0-9;]*m");
  static const QRegularExpression kTrouble(
      "^\\s*(\\[\\s*(?:WARN|ERROR|FATAL)\\] \\[[^]]*\\]:|record:|\\[ros(?:run|pack)\\])\\s*(.*)$");
  return kTrouble.match(line.remove(kColor).trimmed()).captured(2);
}

}  // namespace

BagRecorder::BagRecorder() {
  connect(&progress_, &QTimer::timeout, this, &BagRecorder::reportProgress);
}

// The process closes its bag by itself, and its object goes when it has.
BagRecorder::~BagRecorder() {
  if (!process_) return;
  process_->disconnect(this);
  connect(process_, qOverload<int, QProcess::ExitStatus>(&QProcess::finished), process_,
          &QObject::deleteLater);
  interrupt(*process_);
}

void BagRecorder::toggle(const QString& node, const QString& folder) {
  if (state_ == State::Idle) {
    start(node, folder);
  } else {
    stop();
  }
}

void BagRecorder::start(const QString& node, const QString& folder) {
  if (state_ != State::Idle) return;
  const QString name = QString(node.startsWith('/') ? node.mid(1) : node).replace('/', '_');
  const QString date = QDateTime::currentDateTime().toString("yyyy-MM-dd-HH-mm-ss");
  file_ = QDir(folder).filePath(QString("%1_%2.bag").arg(name, date));
  trouble_.clear();
  process_ = new Process;
  process_->setProcessChannelMode(QProcess::MergedChannels);
  connect(process_, &QProcess::readyRead, this, &BagRecorder::readOutput);
  connect(process_, qOverload<int, QProcess::ExitStatus>(&QProcess::finished), this, &BagRecorder::finish);
  connect(process_, &QProcess::errorOccurred, this, &BagRecorder::fail);
  elapsed_.start();
  setState(State::Recording);
  progress_.start(kProgressPeriod);
  process_->start("rosrun", {"rigid_body_sim", "record", "--simulator", node, "--file", file_});
  if (state_ == State::Recording) reportProgress();  // start() may fail at once
}

void BagRecorder::stop() {
  if (state_ != State::Recording) return;
  seconds_ = 1e-3 * static_cast<double>(elapsed_.elapsed());
  interrupt(*process_);
  setState(State::Closing);
  reportProgress();
}

void BagRecorder::setState(State state) {
  state_ = state;
  Q_EMIT stateChanged();
}

void BagRecorder::readOutput() {
  while (process_->canReadLine()) {
    const QString trouble = troubleIn(QString::fromLocal8Bit(process_->readLine()));
    if (!trouble.isEmpty()) trouble_ = trouble;
  }
}

void BagRecorder::reportProgress() {
  if (state_ == State::Closing) {
    Q_EMIT reported("Closing " + file_ + " …", false);
    return;
  }
  const double seconds = 1e-3 * static_cast<double>(elapsed_.elapsed());
  const auto bytes = static_cast<double>(QFileInfo(file_ + ".active").size());
  QString text = "Recording " + wholeSeconds(seconds);
  if (bytes > 0.0)
    text += QString(", %1, %2 a minute").arg(megabytes(bytes), megabytes(60.0 * bytes / seconds));
  text += ": " + QFileInfo(file_).fileName();
  if (!trouble_.isEmpty()) text += ". " + trouble_;
  Q_EMIT reported(text, !trouble_.isEmpty());
}

void BagRecorder::finish(int code, QProcess::ExitStatus status) {
  readOutput();
  const bool was_stopped = state_ == State::Closing;
  progress_.stop();
  process_->deleteLater();
  process_ = nullptr;
  setState(State::Idle);
  const QFileInfo bag(file_);
  if (bag.exists() && was_stopped && code == 0 && status == QProcess::NormalExit) {
    Q_EMIT reported(QString("Recorded %1 into %2 (%3).")
                        .arg(wholeSeconds(seconds_), file_, megabytes(static_cast<double>(bag.size()))),
                    false);
    return;
  }
  QString text = was_stopped ? "The recording has failed" : "The recording has ended by itself";
  if (!trouble_.isEmpty()) text += ": " + trouble_;
  if (bag.exists()) text += ". It is in " + file_;
  if (QFileInfo::exists(file_ + ".active"))
    text += QString(". What there is of it is in %1.active").arg(file_);
  Q_EMIT reported(text + ".", true);
}

void BagRecorder::fail(QProcess::ProcessError error) {
  if (error != QProcess::FailedToStart) return;  // finish() is called for all others
  const QString why = process_->errorString();
  progress_.stop();
  process_->deleteLater();
  process_ = nullptr;
  setState(State::Idle);
  Q_EMIT reported(QString("Nothing is recorded: rosrun cannot be started (%1).").arg(why), true);
}

}  // namespace rbs
