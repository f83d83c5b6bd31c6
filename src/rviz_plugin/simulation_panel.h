// SPDX-License-Identifier: BSD-3-Clause
// SimulationPanel: the simulation's controls and its state, as a panel of RViz.
#pragma once

#include "accuracy_view.h"
#include "effects_view.h"
#include "elided_text.h"
#include "node_box.h"
#include "scene_bar.h"
#include "simulator_client.h"
#include "status_view.h"
#include "step_view.h"
#include "transport_bar.h"
#include "warnings_view.h"
#include "wind_view.h"

#include <rviz/panel.h>

#include <QCheckBox>
#include <QPointer>
#include <QShortcut>
#include <QTabWidget>
#include <QTimer>

#include <functional>

namespace rbs {

/// Greyed while no simulator is heard. The layout keeps the name of the node as "Node" and the scene that its
/// view was saved with as "Scene": for any other scene, the view moves to the view that the scene defines.
///
/// A window may have several panels, each for a simulator of its own. One body is selected among them all,
/// and the keys go to the panel that was used last. RViz's menu Help lists them. The title has a star while no
/// file holds the edits.
class SimulationPanel : public rviz::Panel {
  Q_OBJECT
 public:
  SimulationPanel();
  ~SimulationPanel() override;

  void onInitialize() override;
  void load(const rviz::Config& config) override;
  void save(rviz::Config config) const override;
  bool eventFilter(QObject* object, QEvent* event) override;

  /// The resolved names of the nodes that the panels of a window follow.
  static std::vector<std::string> nodes(QWidget* window);
  /// Selects bodies of a simulator, by the resolved name of its node, alone. With Shift they are added to the
  /// selection, with Ctrl taken away.
  static void select(QWidget* window, const std::string& node, const QStringList& bodies,
                     Qt::KeyboardModifiers keys);
  /// Adds a body of a simulator to the selection, or takes it away.
  static void toggleSelected(QWidget* window, const std::string& node, const QString& body);
  /// Adds a body to the simulator of the panel that has the keys.
  static void spawn(QWidget* window, const rigid_body_sim::SpawnBody::Request& body);
  /// Deletes the bodies that are selected by one of the panels of a window; says so where there are none.
  static void deleteSelection(QWidget* window);
  /// Selects nothing any more in any of the panels of a window, and says why.
  static void dropSelections(QWidget* window, const QString& why);

 private:
  void layOut();
  void connectWidgets();
  void follow(const QString& node);
  void show(const rigid_body_sim::Status& status);
  void showHeard(bool is_heard);
  void enableControls();
  void enableEdits(bool is_live);
  void look(const rigid_body_sim::Status& status);
  void look();
  void showMessage(const QString& text, bool is_trouble);
  void countWarnings(int count);
  void followSelection(const QStringList& bodies);
  void takeKeys();
  void setKeys(bool has_keys);
  void addKeys();
  /// A key of the window, or of the widget that has the focus.
  void addKey(const QKeySequence& keys, const std::function<void()>& act, QWidget* focus = nullptr);
  bool hasKeys() const { return !keys_.isEmpty() && keys_.front() && keys_.front()->isEnabled(); }
  void showTitle();
  QList<SimulationPanel*> panels() const;

  SimulatorClient simulator_;
  QPointer<QWidget> window_;           ///< of RViz
  QString scene_;                      ///< that the view belongs to
  std::string frame_;                  ///< of the world
  geometry_msgs::Point eye_, target_;  ///< of its view, in that frame
  bool is_heard_ = false;
  bool is_unsaved_ = false;  ///< no file holds the edits
  bool is_replay_ = false;   ///< a recording is replayed
  bool keeps_view_ = false;  ///< the user has chosen another node: the camera stays where it is
  QWidget* controls_;
  TransportBar* transport_;
  SceneBar* scenes_;
  QCheckBox* wind_;
  NodeBox* node_;
  ElidedText* answer_;
  QTimer read_;  ///< until the answer has been read
  StatusView* status_;
  QTabWidget* pages_;
  AccuracyView* accuracy_;
  StepView* step_;
  EffectsView* effects_;
  WindView* air_;
  WarningsView* warnings_;
  QList<QPointer<QShortcut>> keys_;  ///< children of RViz's window, which may go first
};

}  // namespace rbs
