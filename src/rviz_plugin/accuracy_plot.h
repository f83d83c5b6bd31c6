// SPDX-License-Identifier: BSD-3-Clause
// The settings of the dial by what they cost and what they give, and the live one among them.
#pragma once

#include <rigid_body_sim/AccuracyStudy.h>
#include <rigid_body_sim/SettingCost.h>

#include <qwt_plot.h>
#include <qwt_plot_curve.h>
#include <qwt_plot_marker.h>

#include <deque>
#include <vector>

namespace rbs {

/// Error, m for each second simulated, against the time of a step, ms; both logarithmic. Hidden while nothing has
/// been measured. A click near a point chooses it.
class AccuracyPlot : public QwtPlot {
  Q_OBJECT
 public:
  AccuracyPlot();

  void show(const rigid_body_sim::AccuracyStudy& study);
  /// The live simulation: a dot at the median time of its last steps, or without an error (0) a line there.
  void showLive(double step_ms, double error);
  using QwtPlot::hide;

 Q_SIGNALS:
  void chosen(const rigid_body_sim::SettingCost& setting);

 private:
  void choose(const QPointF& where);

  std::vector<rigid_body_sim::SettingCost> settings_;
  std::deque<double> times_;  ///< of the last steps, ms
  QwtPlotCurve points_, front_;
  QwtPlotMarker live_;
};

}  // namespace rbs
