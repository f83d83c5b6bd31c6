// SPDX-License-Identifier: BSD-3-Clause
// The bodies of a simulator as a table, and the filter of its rows.
#pragma once

#include "bodies_client.h"

#include <QAbstractTableModel>
#include <QSet>
#include <QSortFilterProxyModel>

#include <string>
#include <vector>

namespace rbs {

/// One row for each body, in the order of their creation.
class BodyTable : public QAbstractTableModel {
  Q_OBJECT
 public:
  enum Column { Name, Shape, Kind, Mass, kColumns };

  explicit BodyTable(const BodiesClient& client);

  int rowCount(const QModelIndex& parent = {}) const override;
  int columnCount(const QModelIndex& parent = {}) const override;
  QVariant data(const QModelIndex& index, int role) const override;
  QVariant headerData(int section, Qt::Orientation orientation, int role) const override;
  Qt::ItemFlags flags(const QModelIndex& index) const override;
  /// A new name of a body, which is asked for and not yet set.
  bool setData(const QModelIndex& index, const QVariant& value, int role) override;

  /// Shows the rows of these names as hidden in the view.
  void setHidden(const QSet<QString>& names);

  const rigid_body_sim::BodyDescription& body(int row) const { return shown_[row]; }
  QString name(int row) const { return QString::fromStdString(body(row).name); }

 Q_SIGNALS:
  void renameAsked(const QString& name, const QString& new_name);
  /// The rows begin or cease to follow the simulator: what is selected meanwhile, nobody has chosen.
  void updating(bool begins);

 private:
  void update();
  void removeRowsThatWent(const std::vector<rigid_body_sim::BodyDescription>& bodies);
  void insertRowsThatCame(const std::vector<rigid_body_sim::BodyDescription>& bodies);

  const BodiesClient& client_;
  std::vector<rigid_body_sim::BodyDescription> shown_;  ///< the rows
  std::string scene_;                                   ///< that they are of
  QSet<QString> hidden_;
};

/// Rows whose body has all words of a text in its name, shape or kind, and, where a group is given, is in it.
class BodyFilter : public QSortFilterProxyModel {
  Q_OBJECT
 public:
  explicit BodyFilter(BodyTable& table);

  void setText(const QString& text);
  /// Only bodies of these names; empty: all.
  void setGroup(const QStringList& names);

 protected:
  bool filterAcceptsRow(int row, const QModelIndex& parent) const override;

 private:
  const BodyTable& table_;
  QStringList words_;
  QSet<QString> group_;
};

}  // namespace rbs
