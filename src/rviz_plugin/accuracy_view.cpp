// SPDX-License-Identifier: BSD-3-Clause
#include "accuracy_view.h"

#include "wheel_guard.h"

#include <QHBoxLayout>
#include <QVBoxLayout>

namespace rbs {
namespace {

constexpr double kNoticedLag = 0.1;  // s

// What a reader of the plot has to know.
QString noteOn(const rigid_body_sim::AccuracyStudy& study) {
  const bool has_errors = study.windows > 0;
  if (!study.done) return {};
  if (!has_errors)
    return "Measure charts the error of each choice of solver settings against its CPU time, for the scene "
           "as it is.";
  if (!study.stale.empty())
    return QString("Measured on '%1', but %2 since: measure again.")
        .arg(QString::fromStdString(study.scene), QString::fromStdString(study.stale));
  const QString what = "A click on a point takes its settings. \"Live\" is the simulation as it runs now.";
  return study.complete ? what : QString("Ended early: %1 windows are measured. ").arg(study.windows) + what;
}

}  // namespace

AccuracyView::AccuracyView(SimulatorClient& simulator)
    : simulator_(simulator),
      preset_(new QComboBox),
      measure_(new QPushButton("Measure")),
      error_(new QCheckBox("Error")),
      reference_run_(new QCheckBox("Reference")),
      text_(new QLabel),
      note_(new QLabel),
      plot_(new AccuracyPlot) {
  preset_->addItems({"preview", "interactive", "accurate", "reference"});
  guardFromWheel(*preset_);
  preset_->setToolTip("Quality level of the contact solver, from fast to exact");
  measure_->setToolTip(
      "Measures error and CPU time of each choice of solver settings for the scene as it is now");
  error_->setToolTip(
      "Estimates the error of the present solver settings while the simulation runs, by a second simulation "
      "with half the step size");
  reference_run_->setToolTip("Draws a reference run that starts from the present state, translucent");
  text_->setWordWrap(true);
  text_->setSizePolicy(QSizePolicy::Preferred, QSizePolicy::Maximum);
  text_->hide();
  note_->setWordWrap(true);
  plot_->hide();

  auto* row = new QHBoxLayout;
  row->setSpacing(4);
  row->addWidget(preset_, 1);
  row->addWidget(measure_);
  row->addWidget(error_);
  row->addWidget(reference_run_);
  auto* rows = new QVBoxLayout(this);
  rows->setContentsMargins(0, 0, 0, 0);
  rows->setSpacing(2);
  rows->addLayout(row);
  rows->addWidget(text_);
  rows->addWidget(plot_, 1);
  rows->addWidget(note_);
  rows->addStretch(0);  // where there is no plot

  connect(preset_, qOverload<int>(&QComboBox::activated), this,
          [this](int index) { simulator_.setFidelity(preset_->itemText(index)); });
  connect(measure_, &QPushButton::clicked, &simulator_, &SimulatorClient::measureAccuracy);
  connect(error_, &QCheckBox::clicked, &simulator_, &SimulatorClient::estimateError);
  connect(reference_run_, &QCheckBox::clicked, &simulator_, &SimulatorClient::showGhost);
  connect(plot_, &AccuracyPlot::chosen, &simulator_, &SimulatorClient::tuneFidelity);
  connect(&simulator_, &SimulatorClient::studyReceived, this, &AccuracyView::showStudy);
}

void AccuracyView::show(const rigid_body_sim::Status& status) {
  const QString setting = QString::fromStdString(status.fidelity);
  preset_->setCurrentText(setting.section(", ", 0, 0));
  error_->setChecked(status.estimates_error);
  reference_run_->setChecked(!status.ghost_lag.empty());
  QString text = setting.contains(", ") ? setting : QString();
  if (!status.dial_reason.empty()) text = QString::fromStdString(status.dial_reason);
  for (const rigid_body_sim::ErrorEstimate& estimate : status.estimate)
    text += (text.isEmpty() ? "" : "; ") + QString("error %1 mm/s").arg(1e3 * estimate.distance, 0, 'g', 3);
  for (const double lag : status.ghost_lag)
    if (lag > kNoticedLag)
      text += (text.isEmpty() ? "" : "; ") + QString("the reference run is %1 s behind").arg(lag, 0, 'f', 1);
  text_->setText(text);
  text_->setVisible(!text.isEmpty());
  const double error = status.estimate.empty() ? 0.0 : status.estimate[0].distance;
  plot_->showLive(1e3 * status.step_cpu_seconds, error);
}

void AccuracyView::showStudy(const rigid_body_sim::AccuracyStudy& study) {
  measure_->setText(study.done ? "Measure" : QString("%1 %").arg(int(100.0 * study.progress)));
  plot_->show(study);
  note_->setText(noteOn(study));
}

}  // namespace rbs
