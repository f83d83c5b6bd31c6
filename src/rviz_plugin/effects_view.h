// SPDX-License-Identifier: BSD-3-Clause
// EffectsView: the effects of a scene, whether and why each runs, what it costs, and a switch for each.
#pragma once

#include "simulator_client.h"

#include <QComboBox>
#include <QMap>
#include <QSet>
#include <QTreeWidget>

namespace rbs {

/// An effect is detected unless it is forced on or off. Of one that is forced off, the reason is what that
/// neglects, as the simulator has measured it.
class EffectsView : public QTreeWidget {
  Q_OBJECT
 public:
  explicit EffectsView(SimulatorClient& simulator);

  void show(const rigid_body_sim::Status& status);
  /// For another simulator.
  void forgetNeglected() { neglected_.clear(); }

 private:
  void addRow(const QString& effect);
  void keepNeglected(const QString& effect, const QString& error);

  SimulatorClient& simulator_;
  QMap<QString, QTreeWidgetItem*> rows_;  ///< by effect
  QMap<QString, QComboBox*> switches_;    ///< by effect
  QSet<QString> off_;                     ///< effects that are forced off in the last status
  QMap<QString, QString> neglected_;      ///< modelling error in words, by effect
};

}  // namespace rbs
