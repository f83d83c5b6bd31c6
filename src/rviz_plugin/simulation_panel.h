// SPDX-License-Identifier: BSD-3-Clause
// SimulationPanel: the simulation's controls and its state, as a panel of RViz.
#pragma once

#include "dial_view.h"
#include "pipeline_table.h"
#include "simulator_client.h"
#include "status_view.h"
#include "transport_bar.h"

#include <rviz/panel.h>

#include <QCheckBox>
#include <QComboBox>
#include <QLabel>
#include <QLineEdit>
#include <QPointer>
#include <QShortcut>

namespace rbs {

/// Greyed while no simulator is heard. The layout keeps the name of the node as "Node" and the scene that its
/// view was saved with as "Scene": for any other scene, the view moves to where that asks to be seen from.
class SimulationPanel : public rviz::Panel {
  Q_OBJECT
 public:
  SimulationPanel();
  ~SimulationPanel() override;

  void onInitialize() override;
  void load(const rviz::Config& config) override;
  void save(rviz::Config config) const override;

 private:
  void layOut();
  void connectWidgets();
  void follow(const QString& node);
  void show(const rigid_body_sim::Status& status);
  void showHeard(bool is_heard);
  void look(const rigid_body_sim::Status& status);
  void showScenes(const QStringList& names, const QStringList& properties);
  void tell(const QString& text, bool is_trouble);

  SimulatorClient simulator_;
  QString scene_;  ///< that the view belongs to
  QWidget* controls_;
  TransportBar* transport_;
  QComboBox* scenes_;
  QCheckBox* wind_;
  QLineEdit* node_;
  QLabel* message_;
  StatusView* status_;
  DialView* dial_;
  PipelineTable* pipeline_;
  QPointer<QShortcut> wind_key_;  ///< a child of RViz's window, which may go first
};

}  // namespace rbs
