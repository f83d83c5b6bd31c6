// SPDX-License-Identifier: BSD-3-Clause
// Chart of error against CPU time: one point for each choice of solver settings, and the live one.
#pragma once

#include <rigid_body_sim/AccuracyStudy.h>
#include <rigid_body_sim/SettingCost.h>

#include <qwt_legend.h>
#include <qwt_plot.h>
#include <qwt_plot_curve.h>
#include <qwt_plot_grid.h>

#include <array>
#include <deque>
#include <memory>
#include <vector>

namespace rbs {

/// Error, m for each second simulated, against the CPU time of a step, ms; both logarithmic. Hidden while
/// nothing has been measured, and grey where what was measured does not hold for the scene any more. The
/// legend names the presets; a point near the mouse is named in full, and a click chooses it.
class AccuracyPlot : public QwtPlot {
  Q_OBJECT
 public:
  AccuracyPlot();

  void show(const rigid_body_sim::AccuracyStudy& study);
  /// The live simulation: a dot at the median CPU time of its last steps, or without an error (0) a line
  /// there.
  void showLive(double step_ms, double error);
  using QwtPlot::hide;
  /// Name, time and error of the setting near a place of the canvas; empty where there is none.
  QString nameAt(const QPoint& pixels) const;

 Q_SIGNALS:
  void chosen(const rigid_body_sim::SettingCost& setting);

 protected:
  void changeEvent(QEvent* event) override;

 private:
  void setColors();
  const rigid_body_sim::SettingCost* nearest(const QPointF& pixels) const;
  void choose(const QPointF& where);

  static constexpr std::size_t kPresets = 4;

  std::vector<rigid_body_sim::SettingCost> settings_;
  bool stale_ = false;
  std::deque<double> times_;  ///< of the last steps, ms
  std::array<std::unique_ptr<QwtPlotCurve>, kPresets> points_;
  QwtPlotGrid grid_;
  QwtPlotCurve front_, live_;
};

}  // namespace rbs
