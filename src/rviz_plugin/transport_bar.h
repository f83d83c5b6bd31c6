// SPDX-License-Identifier: BSD-3-Clause
// The row of buttons that run, step, reset and pace the simulation, and undo edits.
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
  void askToReset();
  QToolButton* addButton(const QIcon& icon, const QString& tip);

  SimulatorClient& simulator_;
  QToolButton* play_;
  QToolButton* step_;
  QSpinBox* steps_;
  QDoubleSpinBox* speed_;
  QToolButton *undo_, *redo_;
  bool is_paused_ = true;
  bool is_unsaved_ = false;
};

}  // namespace rbs
