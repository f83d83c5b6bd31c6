// SPDX-License-Identifier: BSD-3-Clause
// Accuracy in the panel: the quality level, the cost of each choice of solver settings, and the present
// error.
#pragma once

#include "accuracy_plot.h"
#include "simulator_client.h"

#include <QCheckBox>
#include <QComboBox>
#include <QLabel>
#include <QPushButton>
#include <QWidget>

namespace rbs {

class AccuracyView : public QWidget {
  Q_OBJECT
 public:
  explicit AccuracyView(SimulatorClient& simulator);

  void show(const rigid_body_sim::Status& status);

 private:
  void showStudy(const rigid_body_sim::AccuracyStudy& study);

  SimulatorClient& simulator_;
  QComboBox* preset_;
  QPushButton* measure_;
  QCheckBox *error_, *reference_run_;
  QLabel* text_;
  QLabel* note_;  ///< on the chart
  AccuracyPlot* plot_;
};

}  // namespace rbs
