// SPDX-License-Identifier: BSD-3-Clause
// QuantityPicker: the list of what can be plotted, with a search.
#pragma once

#include "quantities.h"

#include <QComboBox>
#include <QFrame>
#include <QLabel>
#include <QLineEdit>
#include <QStringList>
#include <QTreeWidget>

#include <functional>

namespace rbs {

/// Quantities of the simulation have a check mark while they are plotted. Those of a body are added for the body
/// that is named below them. A window of its own that a click beside it closes.
class QuantityPicker : public QFrame {
  Q_OBJECT
 public:
  explicit QuantityPicker(QWidget* parent);

  /// Shows itself at a place of the screen, with an empty search, the bodies that there are, and a mark at what `is_plotted`.
  void open(const QPoint& at, const QStringList& bodies,
            const std::function<bool(const Quantity&)>& is_plotted);
  /// The bodies that there are; the name that is typed stays.
  void setBodies(const QStringList& bodies);

 Q_SIGNALS:
  /// `body`: empty for a quantity of the simulation.
  void toggled(const Quantity& quantity, const QString& body);

 private:
  void filter(const QString& words);
  void choose(QTreeWidgetItem* item);
  void chooseOnlyMatch();

  QLineEdit* search_;
  QTreeWidget* list_;
  QComboBox* body_;
  QLabel* trouble_;
};

}  // namespace rbs
