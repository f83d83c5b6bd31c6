// SPDX-License-Identifier: BSD-3-Clause
#include "transport_bar.h"

#include "colors.h"
#include "drop_edits.h"
#include "icons.h"
#include "node_box.h"
#include "wheel_guard.h"

#include <QDir>
#include <QFileDialog>
#include <QLabel>
#include <QLineEdit>
#include <QMenu>
#include <QMessageBox>
#include <QSignalBlocker>
#include <QVBoxLayout>

#include <algorithm>
#include <cmath>

namespace rbs {
namespace {

NumberBox* makeSteps() {
  auto* box = new NumberBox;
  box->setDecimals(0);
  box->setRange(1.0, 1000.0);
  guardFromWheel(*box);
  box->setToolTip("Number of steps that the button beside it takes");
  return box;
}

NumberBox* makeSpeed() {
  auto* box = new NumberBox;
  box->setDecimals(6);
  box->setRange(0.0, 1e6);
  box->setSingleStep(0.1);
  box->setValue(1.0);
  box->setSuffix(" ×");
  box->setSpecialValueText("max");
  guardFromWheel(*box);
  box->setToolTip("Requested real-time factor; 0 is as fast as possible");
  return box;
}

// The slider is logarithmic: its middle is real time.
constexpr int kSliderSteps = 80;
constexpr double kSlowest = 0.01, kFastest = 100.0;

double factorAt(int place) {
  const double factor = kSlowest * std::pow(kFastest / kSlowest, double(place) / kSliderSteps);
  const double digit = std::pow(10.0, std::floor(std::log10(factor)) - 1.0);
  return digit * std::round(factor / digit);  // two digits
}

int placeOf(double factor) {
  if (factor == 0.0) return kSliderSteps;
  const double bounded = std::min(std::max(factor, kSlowest), kFastest);
  return static_cast<int>(
      std::lround(kSliderSteps * std::log(bounded / kSlowest) / std::log(kFastest / kSlowest)));
}

void offer(QToolButton& button, const char* name, const char* keys, const std::string& edit) {
  button.setEnabled(!edit.empty());
  button.setToolTip(edit.empty() ? QString("%1: nothing (%2)").arg(name, keys)
                                 : QString("%1: %2 (%3)").arg(name, QString::fromStdString(edit), keys));
}

}  // namespace

TransportBar::TransportBar(SimulatorClient& simulator)
    : simulator_(simulator),
      row_(new QHBoxLayout),
      steps_(makeSteps()),
      slider_(new QSlider(Qt::Horizontal)),
      speed_(makeSpeed()),
      folder_(QDir::homePath()),
      note_(new ElidedText(2)),
      seek_bar_(new SeekBar(simulator)) {
  row_->setSpacing(4);
  play_ = addButton(playIcon(), "Run (space)");
  reset_ = addButton(resetIcon(), {});
  step_ = addButton(stepIcon(), "Take steps, while paused (.)");
  row_->addWidget(steps_);
  undo_ = addButton(undoIcon(), {});
  redo_ = addButton(redoIcon(), {});
  row_->addStretch();
  record_ = addButton({}, {});
  record_->setObjectName("record");
  record_->setContextMenuPolicy(Qt::CustomContextMenu);
  showRecording();
  slider_->setRange(0, kSliderSteps);
  slider_->setToolTip("Requested real-time factor, 0.01 to 100 (+ doubles it, - halves it)");
  guardFromWheel(*slider_);
  auto* const speed = new QHBoxLayout;
  speed->setSpacing(4);
  speed->addWidget(new QLabel("Speed"));
  speed->addWidget(slider_, 1);
  speed->addWidget(speed_);
  auto* const rows = new QVBoxLayout(this);
  rows->setContentsMargins(0, 0, 0, 0);
  rows->setSpacing(4);
  rows->addLayout(row_);
  rows->addLayout(speed);
  rows->addWidget(seek_bar_);
  note_->setObjectName("recording_note");
  note_->setVisible(false);

  connect(slider_, &QSlider::valueChanged, this, [this](int place) { speed_->setValue(factorAt(place)); });
  connect(play_, &QToolButton::clicked, this, &TransportBar::playOrPause);
  connect(step_, &QToolButton::clicked, this, &TransportBar::step);
  connect(reset_, &QToolButton::clicked, this, &TransportBar::askToReset);
  connect(undo_, &QToolButton::clicked, &simulator_, &SimulatorClient::undo);
  connect(redo_, &QToolButton::clicked, &simulator_, &SimulatorClient::redo);
  connect(record_, &QToolButton::clicked, this, &TransportBar::record);
  connect(record_, &QWidget::customContextMenuRequested, this, [this](const QPoint& place) {
    QMenu menu;
    menu.addAction("Folder of recordings…", this, &TransportBar::askFolder);
    menu.exec(record_->mapToGlobal(place));
  });
  connect(&recorder_, &BagRecorder::stateChanged, this, &TransportBar::showRecording);
  connect(&recorder_, &BagRecorder::reported, this, &TransportBar::note);
  connect(speed_, qOverload<double>(&QDoubleSpinBox::valueChanged), &simulator_, &SimulatorClient::setSpeed);
  connect(speed_->findChild<QLineEdit*>(), &QLineEdit::returnPressed, speed_, &QAbstractSpinBox::selectAll);
}

QToolButton* TransportBar::addButton(const QIcon& icon, const QString& tip) {
  auto* button = new QToolButton;
  button->setIcon(icon);
  button->setIconSize(QSize(kIconSize, kIconSize));
  button->setToolTip(tip);
  row_->addWidget(button);
  return button;
}

void TransportBar::askToReset() {
  if (!is_unsaved_) return simulator_.reset();
  askToDropEdits(*this, "Reset", "Go back to the scene as it was loaded?", QMessageBox::Reset, [this] {
    if (reset_->isEnabled()) simulator_.reset();
  });
}

void TransportBar::askFolder() {
  auto* const dialog = new QFileDialog(this, "Folder of recordings", folder_);
  dialog->setAttribute(Qt::WA_DeleteOnClose);
  dialog->setFileMode(QFileDialog::Directory);
  dialog->setOption(QFileDialog::ShowDirsOnly);
  connect(dialog, &QFileDialog::fileSelected, this, [this](const QString& folder) {
    setFolder(folder);
    showRecording();
    Q_EMIT folderChanged();
  });
  dialog->open();
}

void TransportBar::record() {
  if (record_->isEnabled())
    recorder_.toggle(QString::fromStdString(resolvedNode(simulator_.node())), folder_);
}

void TransportBar::showRecording() {
  const bool is_recording = recorder_.state() == BagRecorder::State::Recording;
  record_->setIcon(is_recording ? stopRecordIcon() : recordIcon());
  record_->setEnabled(is_recording || (recorder_.state() == BagRecorder::State::Idle && !is_replay_));
  record_->setToolTip(
      is_replay_     ? QString("A recording is replayed")
      : is_recording ? QString("End the recording (R)")
                     : QString("Record into a bag in %1 (R); a right click chooses the folder").arg(folder_));
  Q_EMIT recordingChanged();
}

void TransportBar::setHeard(bool is_heard) {
  for (QWidget* const widget : std::initializer_list<QWidget*>{play_, reset_, step_, steps_, undo_, redo_,
                                                               slider_, speed_, seek_bar_})
    widget->setEnabled(is_heard);
}

void TransportBar::note(const QString& text, bool is_trouble) {
  note_->setText(text);
  showTrouble(*note_, is_trouble);
  note_->setVisible(!text.isEmpty());
}

void TransportBar::step() {
  if (steps_->takeTyped()) simulator_.step(static_cast<int>(steps_->value()));
}

void TransportBar::scaleSpeed(double factor) {
  const double now = speed_->value();
  if (now > 0.0)
    speed_->setValue(factor > 1.0 ? std::max(now, std::min(factor * now, kFastest))
                                  : std::min(now, std::max(factor * now, kSlowest)));
}

void TransportBar::showSpeed(double factor) {
  const QSignalBlocker quiet_box(speed_), quiet_slider(slider_);
  if (slider_->isSliderDown()) return;
  if (!speed_->findChild<QLineEdit*>()->isModified()) speed_->setValue(factor);
  slider_->setValue(placeOf(factor));
}

void TransportBar::playOrPause() {
  if (is_paused_) {
    simulator_.resume();
  } else {
    simulator_.pause();
  }
}

void TransportBar::show(const rigid_body_sim::Status& status) {
  const bool is_still = status.paused && status.steps_left == 0;  // else the button stops the steps, too
  step_->setEnabled(is_still);
  offer(*undo_, "Undo", "Ctrl+Z", status.undo);
  offer(*redo_, "Redo", "Ctrl+Shift+Z", status.redo);
  is_unsaved_ = status.unsaved;
  seek_bar_->show(status);
  if (const bool is_replay = !status.recording.empty(); is_replay != is_replay_) {
    is_replay_ = is_replay;
    showRecording();
  }
  reset_->setToolTip(is_replay_ ? "Back to the start of the recording"
                                : "Reset: back to the scene as it was loaded");
  showSpeed(status.requested_speed);
  if (is_still == is_paused_) return;
  is_paused_ = is_still;
  play_->setIcon(is_paused_ ? playIcon() : pauseIcon());
  play_->setToolTip(is_paused_ ? "Run (space)" : "Pause (space)");
}

}  // namespace rbs
