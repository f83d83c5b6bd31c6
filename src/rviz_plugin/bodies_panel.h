// SPDX-License-Identifier: BSD-3-Clause
// BodiesPanel: the bodies of a simulator as a list, and the properties of those that are selected.
#pragma once

#include "bodies_client.h"
#include "body_properties.h"
#include "body_table.h"
#include "elided_text.h"
#include "node_box.h"

#include <rviz/panel.h>
#include <rviz/visualization_manager.h>

#include <QComboBox>
#include <QLineEdit>
#include <QMap>
#include <QPointer>
#include <QTableView>
#include <QTimer>

#include <set>

namespace rbs {

/// What is selected here is selected in the view, and the other way round: the simulator keeps the selection.
/// The layout keeps the name of the node as "Node", named groups of bodies as "Groups", and those that the Bodies
/// displays do not draw as "Hidden".
class BodiesPanel : public rviz::Panel {
  Q_OBJECT
 public:
  BodiesPanel();
  ~BodiesPanel() override;

  void onInitialize() override;
  void load(const rviz::Config& config) override;
  void save(rviz::Config config) const override;

 protected:
  bool eventFilter(QObject* watched, QEvent* event) override;

 private:
  void layOut();
  void addActions();
  void enableActions();
  QAction* addAction(const QString& text, const QKeySequence& keys, void (BodiesPanel::*act)());
  void follow(const QString& node);
  void showSelection();
  void sendSelection();
  /// The row of a body; invalid where there is no such body, or the search hides it.
  QModelIndex indexOf(const QString& name) const;
  bool isHiddenBySearch(const QString& name) const;
  /// Those selected bodies that are listed. The actions and the properties are for them: none changes what the search hides.
  QStringList chosen() const;
  void showCount();
  void showMessage(const QString& text, bool is_trouble);
  void followRenames(const QHash<QString, QString>& new_names);
  void rename(const QString& name, const QString& new_name);
  void focus();
  void hideSelection();
  void showAll();
  void applyHidden();
  void hideInView(const std::set<std::string>& names);
  void remove();
  void duplicate();
  void groupSelection();
  void ungroup();
  void chooseGroup(int index);
  void showGroups(const QString& chosen);

  BodiesClient simulator_;
  BodyTable table_;
  BodyFilter filter_;
  QLineEdit* search_;
  QComboBox* groups_;
  QTableView* list_;
  QLabel* count_;
  BodyProperties* properties_;
  ElidedText* answer_;
  QTimer done_;  ///< takes away the answer to what was done
  NodeBox* node_;
  QList<QAction*> of_selection_;  ///< actions that need one
  QList<QAction*> edits_;         ///< actions that change the world
  QAction *show_all_, *ungroup_;
  QMap<QString, QStringList> in_group_;           ///< names of bodies, by the name of the group
  QSet<QString> hidden_;                          ///< names of bodies that the view does not draw
  QPointer<rviz::VisualizationManager> manager_;  ///< it may go before the panel
  bool filters_ = false;                          ///< the filter is taking rows away
  bool extends_ = false;                          ///< the last click or key extends the selection
  bool shows_selection_ = false;                  ///< the list is being brought in line with the simulator
};

}  // namespace rbs
