// SPDX-License-Identifier: BSD-3-Clause
#include "accuracy_plot.h"

#include "length_text.h"
#include "plot_look.h"

#include <qwt_picker_machine.h>
#include <qwt_plot_picker.h>
#include <qwt_scale_engine.h>
#include <qwt_symbol.h>
#include <qwt_text.h>

#include <QEvent>

#include <algorithm>
#include <cmath>

namespace rbs {
namespace {

constexpr double kLeastError = 1e-15;  // m/s: what is drawn for less
constexpr std::size_t kTimes = 15;     // whose median is shown
constexpr double kNear = 12.0;         // pixels from a point that the mouse may be
constexpr int kPointSize = 8, kLiveSize = 11;

/// A preset, and the number of its colour (curveColor()).
struct Preset {
  const char* name;
  std::size_t colour;
};
constexpr Preset kPresetLooks[] = {{"preview", 1}, {"interactive", 0}, {"accurate", 2}, {"reference", 3}};
constexpr std::size_t kLiveColour = 4, kStaleColour = 7;

QPointF pointOf(const rigid_body_sim::SettingCost& cost) {
  return {cost.step_ms, std::max(cost.error, kLeastError)};
}

/// The settings that none beats in both, from cheap to exact.
QVector<QPointF> frontOf(std::vector<rigid_body_sim::SettingCost> settings) {
  std::sort(settings.begin(), settings.end(),
            [](const auto& a, const auto& b) { return a.step_ms < b.step_ms; });
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

QwtSymbol* symbol(QwtSymbol::Style style, const QColor& colour, int size) {
  return new QwtSymbol(style, colour, QPen(Qt::NoPen), QSize(size, size));
}

/// Names the setting under the mouse.
class Hover : public QwtPlotPicker {
 public:
  Hover(AccuracyPlot& plot)
      : QwtPlotPicker(QwtPlot::xBottom, QwtPlot::yLeft, NoRubberBand, AlwaysOn, plot.canvas()), plot_(plot) {
    setStateMachine(new QwtPickerClickPointMachine);
  }
  QwtText trackerText(const QPoint& pixels) const override {
    QwtText text = small(plot_.nameAt(pixels));
    if (text.isEmpty()) return text;
    text.setBackgroundBrush(plot_.palette().brush(QPalette::ToolTipBase));
    text.setColor(plot_.palette().color(QPalette::ToolTipText));
    return text;
  }

 private:
  const AccuracyPlot& plot_;
};

}  // namespace

AccuracyPlot::AccuracyPlot() {
  for (const Axis axis : {xBottom, yLeft}) setAxisScaleEngine(axis, new QwtLogScaleEngine);
  setAxisMaxMinor(yLeft, 0);
  setAxisMaxMajor(yLeft, 5);
  setAxisMaxMajor(xBottom, 4);  // labels of a decade or less are crowded at its upper end
  setAxisTitle(xBottom, small("CPU ms per step"));
  setAxisTitle(yLeft, small("error, m/s"));
  constexpr int kLeastHeight = 200;
  setMinimumHeight(kLeastHeight);
  grid_.attach(this);
  front_.setItemAttribute(QwtPlotItem::Legend, false);
  front_.attach(this);
  for (std::size_t k = 0; k < kPresets; ++k) {
    points_[k] = std::make_unique<QwtPlotCurve>(small(kPresetLooks[k].name));
    points_[k]->setStyle(QwtPlotCurve::NoCurve);
    points_[k]->setRenderHint(QwtPlotItem::RenderAntialiased);
    points_[k]->setLegendAttribute(QwtPlotCurve::LegendShowSymbol);
    points_[k]->attach(this);
  }
  live_.setTitle(small("live"));
  live_.setLegendAttribute(QwtPlotCurve::LegendShowSymbol);
  live_.attach(this);
  auto* legend = new QwtLegend;
  legend->setMaxColumns(kPresets + 1);
  insertLegend(legend, QwtPlot::TopLegend);
  setColors();
  connect(new Hover(*this), qOverload<const QPointF&>(&QwtPlotPicker::selected), this, &AccuracyPlot::choose);
}

void AccuracyPlot::show(const rigid_body_sim::AccuracyStudy& study) {
  settings_ = study.windows > 0 ? study.settings : std::vector<rigid_body_sim::SettingCost>();
  stale_ = !study.stale.empty();
  for (std::size_t k = 0; k < kPresets; ++k) {
    QVector<QPointF> points;
    for (const rigid_body_sim::SettingCost& cost : settings_)
      if (cost.preset == kPresetLooks[k].name) points.append(pointOf(cost));
    points_[k]->setSamples(points);
  }
  setColors();
  front_.setSamples(frontOf(settings_));
  live_.setVisible(!stale_);
  setVisible(!settings_.empty());
  replot();
}

void AccuracyPlot::setColors() {
  const auto color = [this](std::size_t number) { return curveColor(number, palette()); };
  setCanvasBackground(palette().base());
  grid_.setPen(gridColor(palette()));
  front_.setPen(gridColor(palette()), 4.0);
  for (std::size_t k = 0; k < kPresets; ++k)
    points_[k]->setSymbol(
        symbol(QwtSymbol::Ellipse, color(stale_ ? kStaleColour : kPresetLooks[k].colour), kPointSize));
  live_.setPen(color(kLiveColour), 1.5);
  live_.setSymbol(symbol(QwtSymbol::Diamond, color(kLiveColour), kLiveSize));
}

void AccuracyPlot::changeEvent(QEvent* event) {
  QwtPlot::changeEvent(event);
  if (event->type() != QEvent::PaletteChange) return;
  setColors();
  replot();
}

void AccuracyPlot::showLive(double step_ms, double error) {
  if (settings_.empty() || step_ms <= 0.0) return;
  times_.push_back(step_ms);
  if (times_.size() > kTimes) times_.pop_front();
  std::vector<double> sorted(times_.begin(), times_.end());
  std::sort(sorted.begin(), sorted.end());
  const double median = sorted[sorted.size() / 2];
  QVector<QPointF> points;
  if (error > 0.0) {
    points.append({median, std::max(error, kLeastError)});
  } else {
    const auto [best, worst] = std::minmax_element(
        settings_.begin(), settings_.end(), [](const auto& a, const auto& b) { return a.error < b.error; });
    points.append({median, pointOf(*best).y()});
    points.append({median, pointOf(*worst).y()});
  }
  live_.setStyle(error > 0.0 ? QwtPlotCurve::NoCurve : QwtPlotCurve::Lines);
  live_.setSamples(points);
  replot();
}

const rigid_body_sim::SettingCost* AccuracyPlot::nearest(const QPointF& pixels) const {
  const rigid_body_sim::SettingCost* found = nullptr;
  double least = kNear;
  for (const rigid_body_sim::SettingCost& cost : settings_) {
    const QPointF point = pointOf(cost);
    const double distance =
        std::hypot(transform(xBottom, point.x()) - pixels.x(), transform(yLeft, point.y()) - pixels.y());
    if (distance < least) least = distance, found = &cost;
  }
  return found;
}

QString AccuracyPlot::nameAt(const QPoint& pixels) const {
  const rigid_body_sim::SettingCost* cost = nearest(pixels);
  if (!cost) return QString();
  return QString("%1:\n%2 ms, %3%4/s%5")
      .arg(QString::fromStdString(cost->name))
      .arg(cost->step_ms, 0, 'g', 3)
      .arg(cost->at_most ? "at most " : "", QString::fromStdString(lengthText(cost->error)),
           stale_ ? "" : "\nclick to take it");
}

void AccuracyPlot::choose(const QPointF& where) {
  const rigid_body_sim::SettingCost* cost =
      nearest({transform(xBottom, where.x()), transform(yLeft, where.y())});
  if (cost && !stale_) Q_EMIT chosen(*cost);
}

}  // namespace rbs
