// SPDX-License-Identifier: BSD-3-Clause
#include "accuracy_plot.h"

#include <qwt_plot_grid.h>
#include <qwt_plot_picker.h>
#include <qwt_picker_machine.h>
#include <qwt_scale_engine.h>
#include <qwt_symbol.h>
#include <qwt_text.h>

#include <algorithm>
#include <cmath>

namespace rbs {
namespace {

constexpr double kLeast = 1e-15;  // m/s: what is drawn for less
constexpr std::size_t kTimes = 15;  // whose median is shown
constexpr double kNear = 12.0;    // pixels from a point that a click may be

QPointF pointOf(const rigid_body_sim::SettingCost& cost) {
  return {cost.step_ms, std::max(cost.error, kLeast)};
}

/// The settings that none beats in both, from cheap to exact.
QVector<QPointF> frontOf(std::vector<rigid_body_sim::SettingCost> settings) {
  std::sort(settings.begin(), settings.end(), [](const auto& a, const auto& b) { return a.step_ms < b.step_ms; });
  QVector<QPointF> front;
  for (const rigid_body_sim::SettingCost& cost : settings)
    if (front.isEmpty() || pointOf(cost).y() < front.last().y()) front.append(pointOf(cost));
  return front;
}

QwtText small(const QString& text) {
  QwtText title(text);
  QFont font = title.font();
  font.setPointSize(8);
  title.setFont(font);
  return title;
}

}  // namespace

AccuracyPlot::AccuracyPlot() {
  for (const Axis axis : {xBottom, yLeft}) setAxisScaleEngine(axis, new QwtLogScaleEngine);
  setAxisMaxMinor(yLeft, 0);
  setAxisMaxMajor(yLeft, 5);
  setAxisTitle(xBottom, small("ms a step"));
  setAxisTitle(yLeft, small("error, m/s"));
  setCanvasBackground(Qt::white);
  setFixedHeight(180);
  setToolTip("What each setting costs and gives, as measured on this scene; a click on a point takes that setting.\n"
             "Orange: the live simulation");
  auto* grid = new QwtPlotGrid;
  grid->setPen(QColor(225, 225, 225));
  grid->attach(this);
  front_.setPen(QColor(0, 0, 0, 40), 4.0);
  front_.attach(this);
  points_.setStyle(QwtPlotCurve::NoCurve);
  points_.setSymbol(new QwtSymbol(QwtSymbol::Ellipse, QColor("#1b5e9e"), QPen(Qt::NoPen), QSize(8, 8)));
  points_.setRenderHint(QwtPlotItem::RenderAntialiased);
  points_.attach(this);
  live_.setLinePen(QColor("#d98a00"), 1.5);
  live_.attach(this);
  auto* picker = new QwtPlotPicker(xBottom, yLeft, QwtPicker::NoRubberBand, QwtPicker::AlwaysOff, canvas());
  picker->setStateMachine(new QwtPickerClickPointMachine);
  connect(picker, qOverload<const QPointF&>(&QwtPlotPicker::selected), this, &AccuracyPlot::choose);
}

void AccuracyPlot::show(const rigid_body_sim::AccuracyStudy& study) {
  settings_ = study.windows > 0 ? study.settings : std::vector<rigid_body_sim::SettingCost>();
  QVector<QPointF> points;
  for (const rigid_body_sim::SettingCost& cost : settings_) points.append(pointOf(cost));
  points_.setSamples(points);
  front_.setSamples(frontOf(settings_));
  setVisible(!settings_.empty());
  replot();
}

void AccuracyPlot::showLive(double step_ms, double error) {
  if (settings_.empty() || step_ms <= 0.0) return;
  times_.push_back(step_ms);
  if (times_.size() > kTimes) times_.pop_front();
  std::vector<double> sorted(times_.begin(), times_.end());
  std::sort(sorted.begin(), sorted.end());
  const double median = sorted[sorted.size() / 2];
  const bool known = error > 0.0;
  live_.setLineStyle(known ? QwtPlotMarker::NoLine : QwtPlotMarker::VLine);
  live_.setSymbol(known ? new QwtSymbol(QwtSymbol::Diamond, QColor("#d98a00"), QPen(Qt::NoPen), QSize(11, 11)) : nullptr);
  live_.setValue(median, known ? std::max(error, kLeast) : pointOf(settings_.front()).y());
  replot();
}

void AccuracyPlot::choose(const QPointF& where) {
  const auto pixels = [this](const QPointF& p) { return QPointF(transform(xBottom, p.x()), transform(yLeft, p.y())); };
  const rigid_body_sim::SettingCost* nearest = nullptr;
  double least = kNear;
  for (const rigid_body_sim::SettingCost& cost : settings_) {
    const QPointF apart = pixels(pointOf(cost)) - pixels(where);
    const double distance = std::hypot(apart.x(), apart.y());
    if (distance < least) least = distance, nearest = &cost;
  }
  if (nearest) Q_EMIT chosen(*nearest);
}

}  // namespace rbs
