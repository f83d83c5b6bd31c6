// SPDX-License-Identifier: BSD-3-Clause
// PlotStack: plots below each other with one axis of time, one cursor and one baseline.
#pragma once

#include "baseline.h"
#include "recorder.h"
#include "time_plot.h"

#include <QLabel>
#include <QScrollArea>
#include <QTimer>
#include <QVBoxLayout>

#include <memory>
#include <optional>
#include <vector>

namespace rbs {

class PlotStack : public QScrollArea {
  Q_OBJECT
 public:
  explicit PlotStack(Recorder& recorder);

  const std::vector<TimePlot*>& plots() const { return plots_; }
  /// The plot of a quantity; null where there is none.
  TimePlot* find(const Quantity& quantity) const;
  /// Adds a plot, or a body to the plot that has the quantity already. `body`: empty for one of the simulation.
  void add(const Quantity& quantity, const QString& body);
  void remove(TimePlot* plot);
  void removeAll();

  /// How much time is seen while the newest is followed, s; 0: all of the run.
  void setWindow(double seconds);
  double window() const { return window_; }
  /// Back to the newest, with scales that fit.
  void follow();
  bool isFollowing() const { return is_following_; }
  /// Draws nothing new while it is held; recording goes on.
  void hold(bool on);
  /// The newest moment, or what the cursor shows, becomes the baseline; none: values as they are.
  void setBaseline(bool on);
  /// The last mark becomes the baseline. Returns whether there is one.
  bool setBaselineAtMark();
  bool hasBaseline() const { return baseline_.has_value(); }
  /// Begins anew with another simulator: no baseline, and the newest is followed.
  void restart();

  /// What is drawn from: it stands still while it is held.
  const History& history() const { return held_ ? *held_ : recorder_.history(); }

 Q_SIGNALS:
  void plotsChanged();
  void viewChanged();                            ///< whether it follows, or its baseline
  void cursorMoved(std::optional<double> time);  ///< s; none: the mouse is elsewhere

 protected:
  void showEvent(QShowEvent* event) override;

 private:
  void followRenames(const QHash<QString, QString>& new_names);
  void draw();
  void draw(TimePlot& plot);
  void drawSoon();
  void choose(double from, double to);
  void alignScales();
  void lookAtNewest();
  void reportWanted();

  Recorder& recorder_;
  std::vector<TimePlot*> plots_;
  QVBoxLayout* column_;
  QLabel* empty_;
  double window_ = 10.0, from_ = 0.0, to_ = 10.0;  ///< s
  bool is_following_ = true;
  std::optional<double> cursor_;
  std::optional<Baseline> baseline_;
  std::unique_ptr<History> held_;  ///< null: not held
  QTimer drawing_;                 ///< so that many changes are drawn once
  std::size_t next_ = 0;           ///< plot to draw; 0: none of them is drawn yet
  bool is_stale_ = false;          ///< whether something has changed while they were drawn
  double widest_ = 0.0;            ///< of the numbers at the left, pixels
};

}  // namespace rbs
