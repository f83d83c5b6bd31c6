// SPDX-License-Identifier: BSD-3-Clause
#include "time_plot.h"

#include "plot_look.h"
#include "recorder.h"

#include <qwt_plot_canvas.h>
#include <qwt_plot_layout.h>
#include <qwt_scale_draw.h>
#include <qwt_scale_engine.h>
#include <qwt_scale_widget.h>
#include <qwt_text.h>

#include <QEvent>
#include <QHelpEvent>
#include <QMouseEvent>
#include <QToolTip>
#include <QWheelEvent>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rbs {
namespace {

constexpr double kLeastShown = 1e-18;     // what a logarithmic scale draws for less
constexpr double kFlat = 1e-5;            // of a value: the least that a scale spans about it
constexpr double kMargin = 0.06;          // of the scale, above and below
constexpr double kWheel = 1.25;           // zoom of one notch
constexpr int kNearMark = 4, kDrawn = 5;  // pixels: of a mark, and of a rectangle that is meant
constexpr double kPale = 0.3;             // opacity of the run before
constexpr int kMarksSeen = 60;
constexpr int kLeastLines = 5;              // of text, as high as a chart is at least
constexpr int kDigits = 4, kFewDigits = 2;  // of the values in a heading, few where there are many

void fade(QwtPlotCurve& curve, QColor color) {
  color.setAlphaF(kPale);
  curve.setPen(color, 1.0);
}

std::unique_ptr<QwtPlotCurve> makeCurve(QwtPlot* plot) {
  auto curve = std::make_unique<QwtPlotCurve>();
  curve->setRenderHint(QwtPlotItem::RenderAntialiased);
  curve->setPaintAttribute(QwtPlotCurve::FilterPoints);
  curve->attach(plot);
  return curve;
}

}  // namespace

TimePlot::TimePlot(const Quantity& quantity, const QStringList& bodies)
    : quantity_(quantity), bodies_(bodies), close_(new QToolButton(this)), rectangle_(nullptr) {
  auto* const ground = new QwtPlotCanvas(this);
  ground->setFrameStyle(QFrame::NoFrame);
  setCanvas(ground);
  rectangle_ = new QRubberBand(QRubberBand::Rectangle, ground);
  ground->setMouseTracking(true);
  ground->installEventFilter(this);
  ground->setCursor(Qt::CrossCursor);
  plotLayout()->setAlignCanvasToScales(true);
  plotLayout()->setSpacing(2);
  setMinimumWidth(120);
  setAxisMaxMajor(yLeft, 5);
  setAxisMaxMinor(yLeft, 0);
  setAxisMaxMinor(xBottom, 0);
  for (const Axis axis : {xBottom, yLeft}) {
    axisWidget(axis)->setMargin(0);
    axisScaleDraw(axis)->enableComponent(QwtAbstractScaleDraw::Backbone, false);
  }
  grid_.attach(this);
  for (QwtPlotMarker* line : {&cursor_, &zero_}) {
    line->setLineStyle(QwtPlotMarker::VLine);
    line->setVisible(false);
    line->attach(this);
  }
  close_->setText("×");
  close_->setMaximumSize(fontMetrics().height(), fontMetrics().height());
  close_->setAutoRaise(true);
  close_->setToolTip("Remove this plot");
  close_->hide();
  connect(close_, &QToolButton::clicked, this, &TimePlot::removed);
  makeCurves();
  recolor();
}

void TimePlot::setBodies(const QStringList& bodies) {
  bodies_ = bodies;
  makeCurves();
  recolor();
}

void TimePlot::makeCurves() {
  curves_.clear();
  present_.clear();
  before_.clear();
  const QStringList bodies = quantity_.isOfBody() ? bodies_ : QStringList("");
  for (const QString& body : bodies) {
    for (std::size_t k = 0; k < quantity_.curves.size(); ++k) {
      const QString part = QString::fromStdString(quantity_.curves[k]);
      QStringList label;
      if (!body.isEmpty() && (bodies.size() > 1 || quantity_.curves.size() == 1)) label << body;
      if (quantity_.curves.size() > 1) label << part;
      if (label.isEmpty()) label << part;
      curves_.push_back({curveName(quantity_, k, body.toStdString()), label.join(" ")});
      before_.push_back(makeCurve(this));
      present_.push_back(makeCurve(this));
    }
  }
}

void TimePlot::recolor() {
  const QPalette colors = palette();
  setCanvasBackground(colors.brush(QPalette::Base));
  grid_.setPen(gridColor(colors), 1.0);
  cursor_.setLinePen(colors.color(QPalette::Text), 1.0, Qt::DotLine);
  zero_.setLinePen(colors.color(QPalette::Text), 1.0, Qt::DashLine);
  const QFont font = smallFont(this->font());
  for (const Axis axis : {xBottom, yLeft}) setAxisFont(axis, font);
  for (std::size_t k = 0; k < curves_.size(); ++k) {
    const QColor color = curveColor(k, colors);
    present_[k]->setPen(color, 1.5);
    fade(*before_[k], color);
  }
}

void TimePlot::showTimeAxis(bool on) {
  enableAxis(xBottom, on);
  QwtText title("simulated time, s");
  title.setFont(smallFont(font()));
  setAxisTitle(xBottom, title);
}

bool TimePlot::isLogarithmic(const View& view) const {
  return quantity_.scale == Quantity::Scale::Logarithmic && !view.baseline;
}

bool TimePlot::isStacked(const View& view) const {
  return quantity_.scale == Quantity::Scale::Stacked && !view.baseline;
}

void TimePlot::show(const History& history, const View& view) {
  Range seen{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  if (isStacked(view)) {
    drawStack(history, view, seen);
  } else {
    drawLines(history, view, seen);
  }
  setScale(view, seen);
  showMarks(history, view);
  cursor_.setVisible(view.cursor.has_value());
  if (view.cursor) cursor_.setXValue(*view.cursor);
  showHeading(history, view);
  replot();
}

double TimePlot::shift(const History& history, const View& view, const std::string& curve) const {
  return view.baseline ? view.baseline->valueOf(history, curve) : 0.0;
}

QVector<QPointF> TimePlot::pointsOf(const Trace& trace, const View& view, double shift, Range& seen) const {
  QVector<QPointF> points;
  const auto most = static_cast<std::size_t>(std::max(100, canvas()->width()));
  for (const Sample& sample : trace.samples(view.from, view.to, most)) {
    const double value = isLogarithmic(view) ? std::max(kLeastShown, sample.value) : sample.value - shift;
    points.append({sample.time, value});
    seen.size = std::max(seen.size, std::abs(sample.value));
    seen.low = std::min(seen.low, value);
    seen.high = std::max(seen.high, value);
  }
  return points;
}

// The scale is that of the run that goes on: the one before may be of another scene.
void TimePlot::drawLines(const History& history, const View& view, Range& seen) {
  Range before = seen;
  for (std::size_t k = 0; k < curves_.size(); ++k) {
    const double zero = shift(history, view, curves_[k].name);
    present_[k]->setBrush(Qt::NoBrush);
    present_[k]->setSamples(pointsOf(history.present(curves_[k].name), view, zero, seen));
    before_[k]->setSamples(pointsOf(history.before(curves_[k].name), view, zero, before));
  }
  if (seen.low > seen.high) seen = before;
}

// Each curve is drawn as the sum of itself and all below it, filled, the highest first.
void TimePlot::drawStack(const History& history, const View& view, Range& seen) {
  QVector<QPointF> sum;
  for (const QPointF& point : pointsOf(history.present(curves_[0].name), view, 0.0, seen))
    sum.push_back({point.x(), 0.0});
  seen.low = 0.0;
  for (std::size_t k = 0; k < curves_.size(); ++k) {
    const Trace& trace = history.present(curves_[k].name);
    for (QPointF& point : sum) {
      point.ry() += trace.valueAt(point.x()).value_or(0.0);
      seen.high = std::max(seen.high, point.y());
    }
    QColor color = curveColor(k, palette());
    present_[k]->setSamples(sum);
    present_[k]->setZ(-static_cast<double>(k));
    present_[k]->setPen(color, 1.0);
    present_[k]->setBrush(color);
    before_[k]->setSamples(QVector<QPointF>());
  }
}

void TimePlot::setScale(const View& view, Range seen) {
  setAxisScale(xBottom, view.from, view.to);
  if (isLogarithmic(view) != is_logarithmic_) {
    is_logarithmic_ = !is_logarithmic_;
    if (is_logarithmic_) {
      setAxisScaleEngine(yLeft, new QwtLogScaleEngine);
    } else {
      setAxisScaleEngine(yLeft, new QwtLinearScaleEngine);
    }
  }
  if (values_) return setAxisScale(yLeft, values_->low, values_->high);
  if (seen.low > seen.high) seen = is_logarithmic_ ? Range{1e-12, 1.0} : Range{0.0, 1.0};
  if (is_logarithmic_) return setAxisScale(yLeft, 0.5 * seen.low, 2.0 * seen.high);
  const double size = std::max({seen.size, std::abs(seen.low), std::abs(seen.high)});
  const double lacking =
      std::max(size > 0.0 ? kFlat * size : 1.0, seen.high - seen.low) - (seen.high - seen.low);
  seen.low -= 0.5 * lacking;
  seen.high += 0.5 * lacking;
  const double margin = kMargin * (seen.high - seen.low);
  const bool stands_on_zero = isStacked(view) && seen.low >= 0.0;
  setAxisScale(yLeft, stands_on_zero ? 0.0 : seen.low - margin, seen.high + margin);
}

void TimePlot::showMarks(const History& history, const View& view) {
  shown_marks_.clear();
  for (const Mark& mark : history.marks())
    if (mark.time >= view.from && mark.time <= view.to) shown_marks_.push_back(mark);
  if (shown_marks_.size() > kMarksSeen)
    shown_marks_.erase(shown_marks_.begin(), shown_marks_.end() - kMarksSeen);
  while (marks_.size() < shown_marks_.size()) {
    marks_.push_back(std::make_unique<QwtPlotMarker>());
    marks_.back()->setLineStyle(QwtPlotMarker::VLine);
    marks_.back()->attach(this);
  }
  marks_.resize(shown_marks_.size());
  QColor color = palette().color(QPalette::Text);
  color.setAlphaF(0.45);
  for (std::size_t i = 0; i < marks_.size(); ++i) {
    marks_[i]->setLinePen(color, 1.0);
    marks_[i]->setXValue(shown_marks_[i].time);
  }
  zero_.setVisible(view.baseline && view.baseline->isIn(history));
  if (view.baseline) zero_.setXValue(view.baseline->time());
}

QString TimePlot::markAt(int x) const {
  QStringList texts;
  for (const Mark& mark : shown_marks_)
    if (std::abs(transform(xBottom, mark.time) - x) <= kNearMark)
      texts << QString("%1 s: %2").arg(mark.time, 0, 'f', 3).arg(QString::fromStdString(mark.text));
  return texts.join("\n");
}

QString TimePlot::valueText(const History& history, const View& view, const std::string& curve) const {
  const std::optional<double> value = history.present(curve).valueAt(view.cursor.value_or(view.to));
  if (!value) return "–";
  if (!view.baseline) return numberText(*value, isStacked(view) ? kFewDigits : kDigits);
  const double zero = view.baseline->valueOf(history, curve);
  const double change = *value - zero;
  return QString("%1 → %2 (%3%4)")
      .arg(numberText(zero, kDigits), numberText(*value, kDigits), change > 0.0 ? "+" : "",
           numberText(change, kDigits));
}

void TimePlot::showHeading(const History& history, const View& view) {
  const QString unit = quantity_.unit.empty() ? "" : ", " + QString::fromStdString(quantity_.unit);
  const QString of_one = bodies_.size() == 1 && curves_.size() > 1 ? " of " + bodies_.front() : QString();
  QString text = QString("<b>%1%2</b>%3%4")
                     .arg(QString::fromStdString(quantity_.name).toHtmlEscaped(), of_one.toHtmlEscaped(),
                          unit, view.baseline ? ", change" : "");
  for (std::size_t k = 0; k < curves_.size(); ++k) {
    if (isStacked(view) && history.present(curves_[k].name).valueAt(view.to).value_or(0.0) == 0.0 &&
        k + 1 < curves_.size())
      continue;  // a stage that the scene does without
    QString value = valueText(history, view, curves_[k].name);
    text += QString(" &nbsp;<span style='color:%1'>■</span>&nbsp;%2&nbsp;%3")
                .arg(curveColor(k, palette()).name(), curves_[k].label.toHtmlEscaped().replace(' ', "&nbsp;"),
                     value.replace(' ', "&nbsp;"));
  }
  if (!missing_.isEmpty())
    text += QString(" &nbsp;<i>no body '%1' in this scene</i>").arg(missing_.join("', '").toHtmlEscaped());
  QwtText heading(text, QwtText::RichText);
  QFont plain = smallFont(font());
  plain.setBold(false);
  heading.setFont(plain);
  heading.setColor(palette().color(QPalette::WindowText));
  heading.setRenderFlags(Qt::AlignLeft | Qt::AlignVCenter | Qt::TextWordWrap);
  setTitle(heading);
  const double lines = heading.heightForWidth(std::max(1, canvas()->width()));
  setMinimumHeight(static_cast<int>(lines) + kLeastLines * fontMetrics().height());
}

TimePlot::Range TimePlot::rangeOf(Axis axis) const {
  const QwtInterval interval = axisInterval(axis);
  return {interval.minValue(), interval.maxValue()};
}

void TimePlot::zoom(const QPoint& at, double factor, bool of_values) {
  const Axis axis = of_values ? yLeft : xBottom;
  const int pixel = of_values ? at.y() : at.x();
  const auto place = [&](double value) { return pixel + factor * (transform(axis, value) - pixel); };
  const Range range = rangeOf(axis);
  const Range chosen{invTransform(axis, static_cast<int>(std::lround(place(range.low)))),
                     invTransform(axis, static_cast<int>(std::lround(place(range.high))))};
  if (!of_values) {
    Q_EMIT rangeChosen(chosen.low, chosen.high);
  } else if (std::isfinite(chosen.low) && std::isfinite(chosen.high) && chosen.low < chosen.high) {
    values_ = chosen;
    Q_EMIT valuesChosen();
  }
}

void TimePlot::move(const QPoint& to) {
  const double time = timeAt(grip_->at.x()) - timeAt(to.x());
  if (to.y() != grip_->at.y() && !is_logarithmic_) {
    const double value = invTransform(yLeft, grip_->at.y()) - invTransform(yLeft, to.y());
    values_ = Range{grip_->values.low + value, grip_->values.high + value};
  }
  Q_EMIT rangeChosen(grip_->from + time, grip_->to + time);
}

void TimePlot::choose(const QRect& rectangle) {
  if (rectangle.width() < kDrawn || rectangle.height() < kDrawn) return;
  values_ = Range{invTransform(yLeft, rectangle.bottom()), invTransform(yLeft, rectangle.top())};
  Q_EMIT rangeChosen(timeAt(rectangle.left()), timeAt(rectangle.right()));
}

bool TimePlot::eventFilter(QObject* watched, QEvent* event) {
  if (watched != canvas()) return QwtPlot::eventFilter(watched, event);
  switch (event->type()) {
    case QEvent::MouseButtonPress: {
      const auto* mouse = static_cast<QMouseEvent*>(event);
      const bool is_left = mouse->button() == Qt::LeftButton;
      if (!is_left && mouse->button() != Qt::MiddleButton) break;
      const bool moves = !is_left || mouse->modifiers().testFlag(Qt::ShiftModifier);
      grip_ = Grip{mouse->pos(), moves, rangeOf(xBottom).low, rangeOf(xBottom).high, rangeOf(yLeft)};
      return true;
    }
    case QEvent::MouseMove: {
      const auto* mouse = static_cast<QMouseEvent*>(event);
      if (grip_ && grip_->moves) {
        move(mouse->pos());
      } else if (grip_) {
        rectangle_->setGeometry(QRect(grip_->at, mouse->pos()).normalized());
        rectangle_->show();
      }
      Q_EMIT cursorMoved(timeAt(mouse->x()));
      return true;
    }
    case QEvent::MouseButtonRelease: {
      rectangle_->hide();
      const std::optional<Grip> grip = std::exchange(grip_, std::nullopt);
      if (grip && !grip->moves)
        choose(QRect(grip->at, static_cast<QMouseEvent*>(event)->pos()).normalized() & canvas()->rect());
      return true;
    }
    case QEvent::MouseButtonDblClick:
      Q_EMIT followed();
      return true;
    case QEvent::Wheel: {
      const auto* wheel = static_cast<QWheelEvent*>(event);
      const double notches = wheel->angleDelta().y() / double(QWheelEvent::DefaultDeltasPerStep);
      zoom(wheel->position().toPoint(), std::pow(kWheel, -notches),
           wheel->modifiers().testFlag(Qt::ControlModifier));
      return true;
    }
    case QEvent::ToolTip: {
      const auto* help = static_cast<QHelpEvent*>(event);
      QToolTip::showText(help->globalPos(), markAt(help->x()), this);
      return true;
    }
    case QEvent::Leave:
      Q_EMIT cursorLeft();
      break;
    default:
      break;
  }
  return QwtPlot::eventFilter(watched, event);
}

void TimePlot::changeEvent(QEvent* event) {
  QwtPlot::changeEvent(event);
  if (event->type() == QEvent::PaletteChange || event->type() == QEvent::FontChange) recolor();
}

void TimePlot::resizeEvent(QResizeEvent* event) {
  QwtPlot::resizeEvent(event);
  close_->move(width() - close_->width(), 0);
}

}  // namespace rbs
