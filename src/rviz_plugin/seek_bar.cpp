// SPDX-License-Identifier: BSD-3-Clause
#include "seek_bar.h"

#include <QHBoxLayout>
#include <QProxyStyle>
#include <QSignalBlocker>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rbs {
namespace {

constexpr double kTick = 1e-4;  // s: a slider counts in whole numbers

int ticks(double seconds) {
  constexpr double kMost = 2e9;  // an int holds more
  return static_cast<int>(std::lround(std::min(seconds / kTick, kMost)));
}

/// A click takes the slider there.
class GoThere : public QProxyStyle {
 public:
  int styleHint(StyleHint hint, const QStyleOption* option, const QWidget* widget,
                QStyleHintReturn* data) const override {
    return hint == SH_Slider_AbsoluteSetButtons ? int(Qt::LeftButton)
                                                : QProxyStyle::styleHint(hint, option, widget, data);
  }
};

QString clockTime(double seconds) {
  const auto minutes = static_cast<int>(seconds / 60.0);
  return QString("%1:%2").arg(minutes).arg(seconds - 60.0 * minutes, 5, 'f', 2, QChar('0'));
}

}  // namespace

SeekBar::SeekBar(SimulatorClient& simulator)
    : simulator_(simulator), slider_(new QSlider(Qt::Horizontal)), time_(new QLabel) {
  auto* const style = new GoThere;
  style->setParent(slider_);
  slider_->setStyle(style);
  slider_->setFocusPolicy(Qt::StrongFocus);
  slider_->setToolTip("Time of the recording; the arrow keys go by a step, page up and down by a second");
  auto* const row = new QHBoxLayout(this);
  row->setContentsMargins(0, 0, 0, 0);
  row->setSpacing(4);
  row->addWidget(new QLabel("Replay"));
  row->addWidget(slider_, 1);
  row->addWidget(time_);
  setVisible(false);
  connect(slider_, &QSlider::valueChanged, this, [this](int value) {
    showTimes();
    simulator_.seek(std::min(kTick * value, kTick * slider_->maximum()));
  });
}

// While a seek is under way, the status may still be one from before it.
void SeekBar::show(const rigid_body_sim::Status& status) {
  const bool is_replay = status.recording.size() == 2;
  setVisible(is_replay);
  if (!is_replay || slider_->isSliderDown() || simulator_.isSeeking()) return;
  const QSignalBlocker quiet(slider_);
  constexpr double kMost = std::numeric_limits<int>::max();
  slider_->setRange(0, static_cast<int>(std::min(status.recording[1] / kTick, kMost)));
  slider_->setSingleStep(std::max(1, ticks(status.step)));
  slider_->setPageStep(ticks(1.0));
  slider_->setValue(ticks(status.recording[0]));
  showTimes();
}

void SeekBar::showTimes() {
  time_->setText(
      QString("%1 of %2").arg(clockTime(kTick * slider_->value()), clockTime(kTick * slider_->maximum())));
}

}  // namespace rbs
