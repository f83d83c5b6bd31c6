// SPDX-License-Identifier: BSD-3-Clause
// The numbers that say how the simulation is doing.
#pragma once

#include <rigid_body_sim/Status.h>

#include <QGridLayout>
#include <QLabel>
#include <QWidget>

namespace rbs {

class StatusView : public QWidget {
  Q_OBJECT
 public:
  StatusView();

  void show(const rigid_body_sim::Status& status);

 private:
  QLabel* addNumber(int row, int column, const QString& name, const QString& tip);

  QGridLayout* grid_;
  QLabel *time_, *speed_, *bodies_, *contacts_, *energy_, *step_time_, *deepest_, *impacts_, *slow_;
};

}  // namespace rbs
