// SPDX-License-Identifier: BSD-3-Clause
// The row of buttons that run, step, reset and pace the simulation, and undo edits.
#pragma once

#include "simulator_client.h"

#include <QDoubleSpinBox>
#include <QHBoxLayout>
#include <QSlider>
#include <QSpinBox>
#include <QToolButton>
#include <QWidget>

namespace rbs {

class TransportBar : public QWidget {
  Q_OBJECT
 public:
  explicit TransportBar(SimulatorClient& simulator);

  void show(const rigid_body_sim::Status& status);
  /// What the keys do: run or pause; take the number of steps that is shown, while paused; double or halve the
  /// requested speed.
  void playOrPause();
  void step();
  void goFaster() { scaleSpeed(2.0); }
  void goSlower() { scaleSpeed(0.5); }

 private:
  void scaleSpeed(double factor);
  void showSpeed(double factor);
  void askToReset();
  QToolButton* addButton(const QIcon& icon, const QString& tip);

  SimulatorClient& simulator_;
  QHBoxLayout* row_;  ///< of the buttons
  QToolButton* play_;
  QToolButton* step_;
  QSpinBox* steps_;
  QSlider* slider_;  ///< logarithm of the requested speed
  QDoubleSpinBox* speed_;
  QToolButton *undo_, *redo_;
  bool is_paused_ = true;
  bool is_unsaved_ = false;
};

}  // namespace rbs
