// SPDX-License-Identifier: BSD-3-Clause
#include "plot_stack.h"

#include <qwt_scale_draw.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace rbs {
namespace {

constexpr int kDrawPeriod = 80;     // ms
constexpr double kShortest = 1e-3;  // s that can be seen

}  // namespace

PlotStack::PlotStack(Recorder& recorder)
    : recorder_(recorder), column_(nullptr), empty_(new QLabel("Nothing is plotted. Add a plot above.")) {
  auto* const content = new QWidget;
  column_ = new QVBoxLayout(content);
  column_->setContentsMargins(0, 0, 0, 0);
  column_->setSpacing(2);
  empty_->setAlignment(Qt::AlignCenter);
  empty_->setEnabled(false);
  column_->addWidget(empty_, 1);
  setWidget(content);
  setWidgetResizable(true);
  setFrameStyle(QFrame::NoFrame);
  setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  drawing_.setSingleShot(true);
  connect(&drawing_, &QTimer::timeout, this, [this] { draw(); });
  connect(&recorder_, &Recorder::recorded, this, [this] {
    if (!held_) drawSoon();
  });
  connect(&recorder_, &Recorder::bodiesChanged, this, &PlotStack::drawSoon);
  connect(&recorder_, &Recorder::renamed, this, &PlotStack::followRenames);
}

TimePlot* PlotStack::find(const Quantity& quantity) const {
  const auto it = std::find_if(plots_.begin(), plots_.end(),
                               [&](const TimePlot* plot) { return &plot->quantity() == &quantity; });
  return it == plots_.end() ? nullptr : *it;
}

void PlotStack::add(const Quantity& quantity, const QString& body) {
  if (TimePlot* const plot = find(quantity)) {
    if (!body.isEmpty() && !plot->bodies().contains(body))
      plot->setBodies(plot->bodies() + QStringList(body));
  } else {
    auto* const added = new TimePlot(quantity, body.isEmpty() ? QStringList() : QStringList(body));
    connect(added, &TimePlot::removed, this, [this, added] { remove(added); });
    connect(added, &TimePlot::rangeChosen, this, &PlotStack::choose);
    connect(added, &TimePlot::valuesChosen, this, &PlotStack::drawSoon);
    connect(added, &TimePlot::followed, this, &PlotStack::follow);
    connect(added, &TimePlot::cursorMoved, this, [this](double time) {
      cursor_ = time;
      Q_EMIT cursorMoved(cursor_);
      drawSoon();
    });
    connect(added, &TimePlot::cursorLeft, this, [this] {
      cursor_.reset();
      Q_EMIT cursorMoved(cursor_);
      drawSoon();
    });
    plots_.push_back(added);
    column_->addWidget(added, 1);
  }
  reportWanted();
}

void PlotStack::remove(TimePlot* plot) {
  plots_.erase(std::find(plots_.begin(), plots_.end(), plot));
  column_->removeWidget(plot);
  plot->hide();
  plot->deleteLater();
  reportWanted();
}

void PlotStack::removeAll() {
  while (!plots_.empty()) remove(plots_.back());
}

void PlotStack::followRenames(const QHash<QString, QString>& new_names) {
  bool is_changed = false;
  CurveNames curves;
  for (TimePlot* const plot : plots_) {
    QStringList bodies;
    for (const QString& body : plot->bodies()) {
      const QString name = new_names.value(body, body);
      for (std::size_t k = 0; name != body && k < plot->quantity().curves.size(); ++k)
        curves[curveName(plot->quantity(), k, body.toStdString())] =
            curveName(plot->quantity(), k, name.toStdString());
      if (!bodies.contains(name)) bodies.append(name);
    }
    if (bodies == plot->bodies()) continue;
    plot->setBodies(bodies);
    is_changed = true;
  }
  if (held_) held_->rename(curves);
  if (baseline_) baseline_->rename(curves);
  if (is_changed) reportWanted();
}

void PlotStack::reportWanted() {
  std::vector<Recorder::Wanted> wanted;
  for (const TimePlot* plot : plots_)
    for (const QString& body : plot->bodies()) wanted.push_back({&plot->quantity(), body.toStdString()});
  recorder_.want(wanted);
  empty_->setVisible(plots_.empty());
  for (TimePlot* plot : plots_) plot->showTimeAxis(plot == plots_.back());
  drawSoon();
  Q_EMIT plotsChanged();
}

void PlotStack::setWindow(double seconds) {
  window_ = seconds;
  follow();
}

void PlotStack::follow() {
  for (TimePlot* plot : plots_) plot->fitValues();
  is_following_ = true;
  Q_EMIT viewChanged();
  drawSoon();
}

void PlotStack::choose(double from, double to) {
  if (!(to - from >= kShortest) || !(to - from < 1e9)) return;
  from_ = from;
  to_ = to;
  is_following_ = false;
  Q_EMIT viewChanged();
  drawSoon();
}

void PlotStack::hold(bool on) {
  if (on == (held_ != nullptr)) return;
  held_ = on ? std::make_unique<History>(recorder_.history()) : nullptr;
  drawSoon();
}

void PlotStack::setBaseline(bool on) {
  baseline_.reset();
  if (on) baseline_.emplace(history(), cursor_.value_or(history().end()));
  for (TimePlot* plot : plots_) plot->fitValues();
  Q_EMIT viewChanged();
  drawSoon();
}

bool PlotStack::setBaselineAtMark() {
  if (history().marks().empty()) return false;
  const double time = history().marks().back().time;
  setBaseline(true);
  // What was there just before the change: the sample at its time has felt it.
  baseline_.emplace(history(), std::nextafter(time, 0.0));
  return true;
}

void PlotStack::restart() {
  held_.reset();
  baseline_.reset();
  follow();
}

void PlotStack::lookAtNewest() {
  to_ = std::max(history().end(), window_ > 0.0 ? window_ : kShortest);
  from_ = window_ > 0.0 ? to_ - window_ : 0.0;
}

// What cannot be seen is not drawn: a hidden dock only records.
void PlotStack::drawSoon() {
  if (next_ > 0) {
    is_stale_ = true;
  } else if (isVisible() && !drawing_.isActive()) {
    drawing_.start(kDrawPeriod);
  }
}

void PlotStack::showEvent(QShowEvent* event) {
  QScrollArea::showEvent(event);
  drawSoon();
}

// One plot at a time, so that many do not hold up the mouse and the view.
void PlotStack::draw() {
  if (next_ == 0 && is_following_) lookAtNewest();
  if (next_ < plots_.size()) draw(*plots_[next_++]);
  if (next_ < plots_.size()) return drawing_.start(0);
  next_ = 0;
  alignScales();
  if (std::exchange(is_stale_, false)) drawSoon();
}

void PlotStack::draw(TimePlot& plot) {
  QStringList missing;
  for (const QString& body : plot.bodies())
    if (!recorder_.mayHave(body.toStdString())) missing << body;
  plot.setMissing(missing);
  plot.show(history(), {from_, to_, cursor_, baseline_ ? &*baseline_ : nullptr});
}

// The canvases stand below each other: the widest numbers at their left, and the half of the last number of the
// axis of time at their right, are left free beside all of them.
void PlotStack::alignScales() {
  if (plots_.empty()) return;
  double widest = 0.0;
  for (TimePlot* plot : plots_) {
    QwtScaleDraw* const scale = plot->axisScaleDraw(QwtPlot::yLeft);
    scale->setMinimumExtent(0.0);
    widest = std::max(widest, scale->extent(plot->axisFont(QwtPlot::yLeft)));
  }
  const QwtPlot* const last = plots_.back();
  for (auto plot = plots_.rbegin(); plot != plots_.rend(); ++plot) {
    (*plot)->axisScaleDraw(QwtPlot::yLeft)->setMinimumExtent(widest);
    const int right = *plot == last ? 0 : last->width() - last->canvas()->geometry().right() - 1;
    if (widest == widest_ && right == (*plot)->contentsMargins().right()) continue;
    (*plot)->setContentsMargins(0, 0, right, 0);
    (*plot)->updateLayout();
  }
  widest_ = widest;
}

}  // namespace rbs
