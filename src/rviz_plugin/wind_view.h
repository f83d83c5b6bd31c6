// SPDX-License-Identifier: BSD-3-Clause
// WindView: the wind as a direction, a speed and gusts.
#pragma once

#include "number_box.h"
#include "simulator_client.h"

#include <QDial>
#include <QLabel>
#include <QWidget>

namespace rbs {

/// A new number sets the wind at once and switches it on.
class WindView : public QWidget {
  Q_OBJECT
 public:
  explicit WindView(SimulatorClient& simulator);

  void show(const rigid_body_sim::Wind& wind);

 private:
  void send();

  SimulatorClient& simulator_;
  QDial* compass_;
  NumberBox *direction_, *speed_, *vertical_, *gust_;
  QLabel* now_;
};

}  // namespace rbs
