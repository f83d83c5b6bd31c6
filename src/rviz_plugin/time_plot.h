// SPDX-License-Identifier: BSD-3-Clause
// TimePlot: one quantity over simulated time, for the simulation or for some bodies.
#pragma once

#include "baseline.h"
#include "history.h"
#include "quantities.h"

#include <qwt_plot.h>
#include <qwt_plot_curve.h>
#include <qwt_plot_grid.h>
#include <qwt_plot_marker.h>

#include <QRubberBand>
#include <QStringList>
#include <QToolButton>

#include <memory>
#include <optional>
#include <vector>

namespace rbs {

/// The run before is drawn pale, changes of the simulation as thin upright lines. The heading names the curves
/// with their values, so it is the legend too.
///
/// The wheel zooms in time about the mouse, with Ctrl in value; the left button draws a rectangle to zoom into,
/// the middle one (or the left one with Shift) moves what is seen, a double click goes back.
class TimePlot : public QwtPlot {
  Q_OBJECT
 public:
  /// What of the history is seen.
  struct View {
    double from = 0.0, to = 1.0;   ///< s
    std::optional<double> cursor;  ///< the time whose values are shown, s; none: the newest in view
    Baseline* baseline = nullptr;  ///< null: values as they are
  };
  /// A curve: its name in the history, and what the heading calls it.
  struct Curve {
    std::string name;
    QString label;
  };

  /// `bodies`: empty for a quantity of the simulation.
  TimePlot(const Quantity& quantity, const QStringList& bodies);

  const Quantity& quantity() const { return quantity_; }
  const QStringList& bodies() const { return bodies_; }
  void setBodies(const QStringList& bodies);
  /// The names of bodies that are not there; the heading shows them.
  void setMissing(const QStringList& bodies) { missing_ = bodies; }
  const std::vector<Curve>& curves() const { return curves_; }
  /// Draws. The scale of the values fits what is in view, unless the user has zoomed in.
  void show(const History& history, const View& view);
  using QwtPlot::show;
  /// Lets the scale of the values fit what is in view again.
  void fitValues() { values_.reset(); }
  /// Whether the axis of time has its numbers below.
  void showTimeAxis(bool on);

 Q_SIGNALS:
  void removed();
  void rangeChosen(double from, double to);
  void valuesChosen();
  void followed();
  void cursorMoved(double time);
  void cursorLeft();

 protected:
  bool eventFilter(QObject* watched, QEvent* event) override;
  void changeEvent(QEvent* event) override;
  void enterEvent(QEvent*) override { close_->show(); }
  void leaveEvent(QEvent*) override { close_->hide(); }
  void resizeEvent(QResizeEvent* event) override;

 private:
  struct Range {
    double low, high;
    double size = 0.0;  ///< of the largest value before the baseline was taken off
  };
  struct Grip {
    QPoint at;
    bool moves;  ///< what is seen; else a rectangle is drawn
    double from, to;
    Range values;
  };

  void makeCurves();
  void recolor();
  double shift(const History& history, const View& view, const std::string& curve) const;
  QVector<QPointF> pointsOf(const Trace& trace, const View& view, double shift, Range& seen) const;
  void drawLines(const History& history, const View& view, Range& seen);
  void drawStack(const History& history, const View& view, Range& seen);
  void showMarks(const History& history, const View& view);
  void showHeading(const History& history, const View& view);
  QString valueText(const History& history, const View& view, const std::string& curve) const;
  void setScale(const View& view, Range seen);
  bool isLogarithmic(const View& view) const;
  bool isStacked(const View& view) const;
  Range rangeOf(Axis axis) const;
  double timeAt(int x) const { return invTransform(xBottom, x); }
  void zoom(const QPoint& at, double factor, bool of_values);
  void move(const QPoint& to);
  void choose(const QRect& rectangle);
  QString markAt(int x) const;

  const Quantity& quantity_;
  QStringList bodies_, missing_;
  std::vector<Curve> curves_;
  std::vector<std::unique_ptr<QwtPlotCurve>> present_, before_;
  std::vector<std::unique_ptr<QwtPlotMarker>> marks_;
  std::vector<Mark> shown_marks_;
  QwtPlotGrid grid_;
  QwtPlotMarker cursor_, zero_;
  QToolButton* close_;  ///< seen while the mouse is here
  QRubberBand* rectangle_;
  std::optional<Range> values_;  ///< chosen by the user
  std::optional<Grip> grip_;
  bool is_logarithmic_ = false;
};

}  // namespace rbs
