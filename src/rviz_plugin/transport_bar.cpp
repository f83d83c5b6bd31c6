// SPDX-License-Identifier: BSD-3-Clause
#include "transport_bar.h"

#include "icons.h"
#include "wheel_guard.h"

#include <QHBoxLayout>
#include <QLabel>
#include <QMessageBox>
#include <QSignalBlocker>

namespace rbs {
namespace {

QSpinBox* makeSteps() {
  auto* box = new QSpinBox;
  box->setRange(1, 1000);
  guardFromWheel(*box);
  box->setToolTip("Number of steps that the button beside it takes");
  return box;
}

QDoubleSpinBox* makeSpeed() {
  auto* box = new QDoubleSpinBox;
  box->setRange(0.0, 100.0);
  box->setSingleStep(0.1);
  box->setValue(1.0);
  box->setSuffix(" ×");
  box->setSpecialValueText("max");
  box->setKeyboardTracking(false);
  guardFromWheel(*box);
  box->setToolTip("Requested real-time factor; 0 is as fast as possible");
  return box;
}

void offer(QToolButton& button, const char* name, const char* keys, const std::string& edit) {
  button.setEnabled(!edit.empty());
  button.setToolTip(edit.empty() ? QString("%1: nothing (%2)").arg(name, keys)
                                 : QString("%1: %2 (%3)").arg(name, QString::fromStdString(edit), keys));
}

}  // namespace

TransportBar::TransportBar(SimulatorClient& simulator)
    : simulator_(simulator), steps_(makeSteps()), speed_(makeSpeed()) {
  auto* row = new QHBoxLayout(this);
  row->setContentsMargins(0, 0, 0, 0);
  row->setSpacing(4);
  play_ = addButton(playIcon(), "Run");
  QToolButton* const reset = addButton(resetIcon(), "Reset: back to the scene as it was loaded");
  step_ = addButton(stepIcon(), "Take steps, while paused");
  row->addWidget(steps_);
  undo_ = addButton(undoIcon(), {});
  redo_ = addButton(redoIcon(), {});
  row->addStretch();
  row->addWidget(new QLabel("Speed"));
  row->addWidget(speed_);

  connect(play_, &QToolButton::clicked, this, &TransportBar::playOrPause);
  connect(step_, &QToolButton::clicked, this, [this] { simulator_.step(steps_->value()); });
  connect(reset, &QToolButton::clicked, this, &TransportBar::askToReset);
  connect(undo_, &QToolButton::clicked, &simulator_, &SimulatorClient::undo);
  connect(redo_, &QToolButton::clicked, &simulator_, &SimulatorClient::redo);
  connect(speed_, qOverload<double>(&QDoubleSpinBox::valueChanged), &simulator_, &SimulatorClient::setSpeed);
}

QToolButton* TransportBar::addButton(const QIcon& icon, const QString& tip) {
  auto* button = new QToolButton;
  button->setIcon(icon);
  button->setIconSize(QSize(kIconSize, kIconSize));
  button->setToolTip(tip);
  layout()->addWidget(button);
  return button;
}

// The simulation goes on while the question stands.
void TransportBar::askToReset() {
  if (!is_unsaved_) return simulator_.reset();
  auto* const question = new QMessageBox(QMessageBox::Question, "Reset",
                                         "No file holds your edits. Go back to the scene as it was loaded?",
                                         QMessageBox::Reset | QMessageBox::Cancel, this);
  question->setAttribute(Qt::WA_DeleteOnClose);
  question->setInformativeText("Undo brings the edits back.");
  question->setDefaultButton(QMessageBox::Cancel);
  connect(question, &QMessageBox::buttonClicked, this, [this, question](QAbstractButton* button) {
    if (question->standardButton(button) == QMessageBox::Reset) simulator_.reset();
  });
  question->open();
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
  if (!speed_->hasFocus()) {
    const QSignalBlocker quiet(speed_);
    speed_->setValue(status.requested_speed);
  }
  if (is_still == is_paused_) return;
  is_paused_ = is_still;
  play_->setIcon(is_paused_ ? playIcon() : pauseIcon());
  play_->setToolTip(is_paused_ ? "Run" : "Pause");
}

}  // namespace rbs
