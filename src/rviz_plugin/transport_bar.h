// SPDX-License-Identifier: BSD-3-Clause
// The row of buttons that run, step, reset and pace the simulation.
#pragma once

#include "simulator_client.h"

#include <QDoubleSpinBox>
#include <QSpinBox>
#include <QToolButton>
#include <QWidget>

namespace rbs {

class TransportBar : public QWidget {
  Q_OBJECT
 public:
  explicit TransportBar(SimulatorClient& simulator);

  void show(const rigid_body_sim::Status& status);

 private:
  void playOrPause();
  QToolButton* addButton(const QIcon& icon, const QString& tip);

  SimulatorClient& simulator_;
  QToolButton* play_;
  QToolButton* step_;
  QSpinBox* steps_;
  QDoubleSpinBox* speed_;
  bool is_paused_ = true;
};

}  // namespace rbs
