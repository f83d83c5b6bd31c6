// SPDX-License-Identifier: BSD-3-Clause
#include "body_table.h"

#include <QColor>
#include <QFont>

#include <algorithm>
#include <utility>

namespace rbs {

BodyTable::BodyTable(const BodiesClient& client) : client_(client) {
  connect(&client, &BodiesClient::bodiesChanged, this, &BodyTable::update);
}

// Rows stay where the bodies are the same, so that a property that changes moves no selection, and a name that is
// being typed elsewhere stays.
void BodyTable::update() {
  const std::vector<rigid_body_sim::BodyDescription>& bodies = client_.bodies();
  const bool same_rows =
      std::equal(bodies.begin(), bodies.end(), shown_.begin(), shown_.end(),
                 [](const auto& body, const auto& before) { return body.id == before.id; });
  if (!same_rows) beginResetModel();
  std::vector<std::pair<int, int>> changed;  // first and last of rows that lie together
  for (int row = 0; same_rows && row < static_cast<int>(bodies.size()); ++row) {
    if (bodies[row] == shown_[row]) continue;
    if (!changed.empty() && changed.back().second == row - 1) {
      changed.back().second = row;
    } else {
      changed.emplace_back(row, row);
    }
  }
  shown_ = bodies;
  if (!same_rows) endResetModel();
  for (const auto& [first, last] : changed) Q_EMIT dataChanged(index(first, 0), index(last, kColumns - 1));
}

void BodyTable::setHidden(const QSet<QString>& names) {
  if (names == hidden_) return;
  hidden_ = names;
  if (rowCount() > 0) Q_EMIT dataChanged(index(0, 0), index(rowCount() - 1, kColumns - 1));
}

int BodyTable::rowCount(const QModelIndex& parent) const {
  return parent.isValid() ? 0 : static_cast<int>(shown_.size());
}

int BodyTable::columnCount(const QModelIndex& parent) const {
  return parent.isValid() ? 0 : kColumns;
}

QVariant BodyTable::data(const QModelIndex& index, int role) const {
  const rigid_body_sim::BodyDescription& body = this->body(index.row());
  if (role == Qt::TextAlignmentRole && index.column() == Mass) return int(Qt::AlignRight | Qt::AlignVCenter);
  if (role == Qt::DecorationRole && index.column() == Name)
    return QColor::fromRgbF(body.color.r, body.color.g, body.color.b);
  if (role == Qt::UserRole && index.column() == Mass) return body.mass;  // to sort by
  if (role == Qt::FontRole && hidden_.contains(name(index.row()))) {
    QFont font;
    font.setItalic(true);
    font.setStrikeOut(true);
    return font;
  }
  if (role == Qt::ToolTipRole && hidden_.contains(name(index.row())))
    return "Hidden in the view (Shift+H shows all)";
  if (role == Qt::ToolTipRole && body.frozen)
    return "Frozen: its state became non-finite, or it left the bounds of positions.";
  if (role != Qt::DisplayRole && role != Qt::EditRole && role != Qt::UserRole) return {};
  switch (index.column()) {
    case Name:
      return QString::fromStdString(body.name);
    case Shape:
      return QString::fromStdString(body.shape);
    case Kind:
      return body.frozen ? "frozen" : QString::fromStdString(body.kind);
    case Mass:
      return body.mass > 0.0 ? QString::number(body.mass, 'g', 4) : "–";
  }
  return {};
}

QVariant BodyTable::headerData(int section, Qt::Orientation orientation, int role) const {
  if (orientation != Qt::Horizontal || role != Qt::DisplayRole) return {};
  return QStringList{"Name", "Shape", "Kind", "Mass, kg"}.value(section);
}

Qt::ItemFlags BodyTable::flags(const QModelIndex& index) const {
  const Qt::ItemFlags flags = QAbstractTableModel::flags(index);
  return index.column() == Name && !client_.isReplay() ? flags | Qt::ItemIsEditable : flags;
}

bool BodyTable::setData(const QModelIndex& index, const QVariant& value, int role) {
  const QString now = value.toString().trimmed();
  if (role != Qt::EditRole || now.isEmpty() || now == name(index.row())) return false;
  Q_EMIT renameAsked(name(index.row()), now);
  return false;
}

BodyFilter::BodyFilter(BodyTable& table) : table_(table) {
  setSourceModel(&table);
  setSortRole(Qt::UserRole);
  setSortCaseSensitivity(Qt::CaseInsensitive);
}

void BodyFilter::setText(const QString& text) {
  words_ = text.simplified().split(' ');  // one empty word, of no text, is in all
  invalidateFilter();
}

void BodyFilter::setGroup(const QStringList& names) {
  group_.clear();
  for (const QString& name : names) group_.insert(name);
  invalidateFilter();
}

bool BodyFilter::filterAcceptsRow(int row, const QModelIndex&) const {
  const rigid_body_sim::BodyDescription& body = table_.body(row);
  const QString name = QString::fromStdString(body.name);
  if (!group_.isEmpty() && !group_.contains(name)) return false;
  const QString text = name + ' ' + QString::fromStdString(body.shape) + ' ' +
                       QString::fromStdString(body.kind) + (body.frozen ? " frozen" : "");
  return std::all_of(words_.begin(), words_.end(),
                     [&](const QString& word) { return text.contains(word, Qt::CaseInsensitive); });
}

}  // namespace rbs
