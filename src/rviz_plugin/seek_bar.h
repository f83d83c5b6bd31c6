// SPDX-License-Identifier: BSD-3-Clause
// SeekBar: where a replay is in its recording, and a slider to go to any other time.
#pragma once

#include "simulator_client.h"

#include <QLabel>
#include <QSlider>
#include <QWidget>

namespace rbs {

/// To be seen only where a recording is replayed. The arrow keys go by a step of the simulation, the page keys by a
/// second.
class SeekBar : public QWidget {
  Q_OBJECT
 public:
  explicit SeekBar(SimulatorClient& simulator);

  /// Shows the time of a replay; hides where the status is that of a simulation.
  void show(const rigid_body_sim::Status& status);

 private:
  void showTimes();

  SimulatorClient& simulator_;
  QSlider* slider_;  ///< in kTick
  QLabel* time_;
};

}  // namespace rbs
