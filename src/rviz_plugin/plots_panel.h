// SPDX-License-Identifier: BSD-3-Clause
// PlotsPanel: quantities of a simulation over time, and accuracy against cost, as a panel of RViz.
#pragma once

#include "accuracy_view.h"
#include "elided_text.h"
#include "node_box.h"
#include "plot_stack.h"
#include "quantity_picker.h"
#include "recorder.h"
#include "simulator_client.h"

#include <rviz/panel.h>

#include <QComboBox>
#include <QTabWidget>
#include <QToolButton>

namespace rbs {

/// The layout keeps the name of the node as "Node", the window of time as "Window", the plots, and the
/// page that is seen as "Page".
class PlotsPanel : public rviz::Panel {
  Q_OBJECT
 public:
  PlotsPanel();
  ~PlotsPanel() override;

  void onInitialize() override;
  void load(const rviz::Config& config) override;
  void save(rviz::Config config) const override;

 private:
  void layOut();
  QWidget* timePage();
  void makeBaselineMenu();
  void connectWidgets();
  void follow(const QString& node);
  void openPicker();
  void toggle(const Quantity& quantity, const QString& body);
  void exportTo();
  void write(const QString& path);
  void showView();
  void showCursor(std::optional<double> time);
  void showNote(const QString& text);

  SimulatorClient simulator_;  ///< for the accuracy
  Recorder recorder_;
  QTabWidget* pages_;
  AccuracyView* accuracy_;
  PlotStack* plots_;
  QuantityPicker* picker_;
  QToolButton *add_, *pause_, *follow_, *baseline_, *export_;
  QComboBox* window_;
  QLabel* cursor_;
  NodeBox* node_;
  ElidedText* message_;
  QString folder_;  ///< that the last file was written to
};

}  // namespace rbs
