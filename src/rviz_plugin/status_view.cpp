// SPDX-License-Identifier: BSD-3-Clause
#include "status_view.h"

#include "length_text.h"

namespace rbs {
namespace {

QString speedInWords(const rigid_body_sim::Status& status) {
  const QString requested =
      status.requested_speed == 0.0 ? "max" : QString::number(status.requested_speed, 'g', 3) + " ×";
  if (status.steps_left > 0) return QString("%1 steps to go").arg(status.steps_left);
  if (status.paused) return "paused, " + requested;
  return QString::number(status.achieved_speed, 'g', 2) + " of " + requested;
}

QString lossInWords(const rigid_body_sim::Status& status) {
  return QString(
             "%1\n%2 s of simulated time were lost since the speed was set. The simulation does not catch "
             "up.")
      .arg(status.bottleneck.empty() ? "It keeps up." : QString::fromStdString(status.bottleneck))
      .arg(status.lost_time, 0, 'f', 1);
}

}  // namespace

StatusView::StatusView() : grid_(new QGridLayout(this)) {
  grid_->setContentsMargins(0, 0, 0, 0);
  grid_->setHorizontalSpacing(6);
  grid_->setVerticalSpacing(1);
  grid_->setColumnStretch(1, 1);
  grid_->setColumnStretch(3, 1);
  time_ = addNumber(0, 0, "Time", "Physics time since the scene began");
  speed_ = addNumber(0, 2, "Speed", "Achieved and requested real-time factor");
  bodies_ = addNumber(1, 0, "Bodies", "All bodies of the world");
  contacts_ = addNumber(1, 2, "Contacts", "Contact points: bodies touch or nearly touch there");
  energy_ =
      addNumber(2, 0, "Energy", "Kinetic and potential energy; the potential one is zero at the origin");
  impacts_ = addNumber(2, 2, "Impacts",
                       "Impacts of the last step, located in time (continuous collision detection)");
  deepest_ = addNumber(3, 0, "Deepest", "Deepest penetration at the end of the last step");
  step_time_ = addNumber(3, 2, "Step", "Wall time of the last step");
  slow_ = addNumber(4, 0, "Slowed by", "The bottleneck, where the simulation runs slower than requested");
  grid_->addWidget(slow_, 4, 1, 1, 3);
  slow_->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Preferred);  // a long text makes no window wider
}

QLabel* StatusView::addNumber(int row, int column, const QString& name, const QString& tip) {
  auto* title = new QLabel(name);
  auto* number = new QLabel("–");
  title->setToolTip(tip);
  number->setToolTip(tip);
  number->setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Fixed);  // so that no number widens the window
  grid_->addWidget(title, row, column);
  grid_->addWidget(number, row, column + 1);
  return number;
}

void StatusView::show(const rigid_body_sim::Status& status) {
  const double energy = status.kinetic_energy + status.potential_energy;
  time_->setText(QString::number(status.time, 'f', 3) + " s");
  speed_->setText(speedInWords(status));
  bodies_->setText(QString::number(status.bodies));
  contacts_->setText(QString::number(status.contacts));
  energy_->setText(QString::number(energy, 'g', 5) + " J");
  impacts_->setText(QString::number(status.impacts));
  deepest_->setText(QString::fromStdString(lengthText(status.deepest_penetration)));
  const QString slow = status.bottleneck.empty() ? "–" : QString::fromStdString(status.bottleneck);
  slow_->setText(slow_->fontMetrics().elidedText(slow, Qt::ElideMiddle, slow_->width()));
  slow_->setToolTip(lossInWords(status));
  step_time_->setText(QString::number(1e3 * status.step_seconds, 'f', 3) + " ms");
}

}  // namespace rbs
