// SPDX-License-Identifier: BSD-3-Clause
#include "wind_view.h"

#include "wheel_guard.h"

#include <QGridLayout>
#include <QSignalBlocker>

#include <QtMath>
#include <cmath>

namespace rbs {
namespace {

constexpr double kStrongest = 1e4;  // m/s

NumberBox* makeBox(double least, double most, const QString& unit, const QString& tip) {
  auto* const box = new NumberBox;
  box->setRange(least, most);
  box->setDecimals(6);
  box->setSuffix(unit);
  box->setToolTip(tip);
  guardFromWheel(*box);
  return box;
}

// QDial turns clockwise from the bottom, the direction counterclockwise from x, which is to the right.
int dialOf(double degrees) {
  return (static_cast<int>(std::lround(270.0 - degrees)) % 360 + 360) % 360;
}

double degreesOf(int dial) {
  return (630 - dial) % 360;
}

void showUnlessEdited(NumberBox& box, double value) {
  if (box.isTyping()) return;
  const QSignalBlocker quiet(box);
  box.setValue(value);
}

}  // namespace

WindView::WindView(SimulatorClient& simulator)
    : simulator_(simulator),
      compass_(new QDial),
      direction_(makeBox(0.0, 360.0, " °", "Where the wind blows to, from x towards y")),
      speed_(makeBox(0.0, kStrongest, " m/s", "Horizontal speed of the air")),
      vertical_(makeBox(-kStrongest, kStrongest, " m/s", "Upward speed of the air")),
      gust_(makeBox(0.0, kStrongest, " m/s", "Standard deviation of each horizontal component")),
      now_(new QLabel) {
  direction_->setWrapping(true);
  direction_->setSingleStep(15.0);
  compass_->setRange(0, 360);
  compass_->setWrapping(true);
  compass_->setNotchesVisible(true);
  compass_->setTracking(false);  // one edit for a turn of it, not one for each degree
  compass_->setValue(dialOf(0.0));
  compass_->setToolTip("Where the wind blows to: x is to the right, y is up");
  guardFromWheel(*compass_);
  now_->setWordWrap(true);

  auto* const grid = new QGridLayout(this);
  grid->setContentsMargins(0, 2, 0, 2);
  grid->setVerticalSpacing(2);
  grid->addWidget(compass_, 0, 0, 4, 1);
  const auto addRow = [grid](int row, const char* title, QWidget* box) {
    grid->addWidget(new QLabel(title), row, 1);
    grid->addWidget(box, row, 2);
  };
  addRow(0, "Direction", direction_);
  addRow(1, "Speed", speed_);
  addRow(2, "Upward", vertical_);
  addRow(3, "Gusts", gust_);
  grid->addWidget(now_, 4, 0, 1, 3);
  grid->setRowStretch(5, 1);
  grid->setColumnStretch(0, 1);

  for (NumberBox* const box : {direction_, speed_, vertical_, gust_})
    connect(box, qOverload<double>(&QDoubleSpinBox::valueChanged), this, &WindView::send);
  connect(compass_, &QDial::valueChanged, this, [this](int dial) { direction_->setValue(degreesOf(dial)); });
  connect(&simulator_, &SimulatorClient::windReceived, this, &WindView::show);
}

void WindView::send() {
  const double angle = qDegreesToRadians(direction_->value());
  geometry_msgs::Vector3 velocity;
  // What rounding leaves across a quarter turn is no wind.
  const auto part = [this](double share) { return std::abs(share) < 1e-12 ? 0.0 : speed_->value() * share; };
  velocity.x = part(std::cos(angle));
  velocity.y = part(std::sin(angle));
  velocity.z = vertical_->value();
  simulator_.setWind(velocity, gust_->value());
}

void WindView::show(const rigid_body_sim::Wind& wind) {
  if (!wind.air) {
    now_->setText("The scene has no air. A wind adds it.");
  } else if (!wind.enabled) {
    now_->setText("The air is still.");
  } else {
    const double speed = std::hypot(wind.velocity.x, wind.velocity.y, wind.velocity.z);
    now_->setText(QString("Now %1 m/s.").arg(speed, 0, 'f', 1));
  }
  if (compass_->isSliderDown()) return;
  const double speed = std::hypot(wind.mean.x, wind.mean.y);
  const double degrees = std::fmod(qRadiansToDegrees(std::atan2(wind.mean.y, wind.mean.x)) + 360.0, 360.0);
  showUnlessEdited(*speed_, speed);
  showUnlessEdited(*vertical_, wind.mean.z);
  showUnlessEdited(*gust_, wind.gust);
  if (speed == 0.0) return;  // without a direction of its own
  showUnlessEdited(*direction_, degrees);
  const QSignalBlocker quiet(compass_);
  compass_->setValue(dialOf(degrees));
}

}  // namespace rbs
