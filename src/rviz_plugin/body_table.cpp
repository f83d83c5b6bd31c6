// SPDX-License-Identifier: BSD-3-Clause
#include "body_table.h"

#include <QColor>
#include <QFont>

#include <algorithm>
#include <unordered_map>
#include <utility>

namespace rbs {

BodyTable::BodyTable(const BodiesClient& client) : client_(client) {
  connect(&client, &BodiesClient::bodiesChanged, this, &BodyTable::update);
}

// Rows stay where the bodies are the same, so that neither a body that changes nor one that comes or goes moves the
// selection, or ends the typing of a name.
void BodyTable::update() {
  const std::vector<rigid_body_sim::BodyDescription>& bodies = client_.bodies();
  Q_EMIT updating(true);
  removeRowsThatWent(bodies);
  scene_ = client_.scene();
  insertRowsThatCame(bodies);
  std::vector<std::pair<int, int>> changed;  // first and last of rows that lie together
  for (int row = 0; row < static_cast<int>(bodies.size()); ++row) {
    if (bodies[row] == shown_[row]) continue;
    if (!changed.empty() && changed.back().second == row - 1) {
      changed.back().second = row;
    } else {
      changed.emplace_back(row, row);
    }
  }
  shown_ = bodies;
  for (const auto& [first, last] : changed) Q_EMIT dataChanged(index(first, 0), index(last, kColumns - 1));
  Q_EMIT updating(false);
}

// Also those that stand in another order now, and all of another scene, whose bodies have the same numbers: they come
// again.
void BodyTable::removeRowsThatWent(const std::vector<rigid_body_sim::BodyDescription>& bodies) {
  std::unordered_map<std::uint64_t, std::size_t> place;
  for (std::size_t k = 0; k < bodies.size(); ++k) place.emplace(bodies[k].id, k);
  std::vector<bool> stays(shown_.size());
  std::size_t next = 0;
  for (std::size_t row = 0; row < shown_.size(); ++row) {
    const auto it = place.find(shown_[row].id);
    stays[row] = client_.scene() == scene_ && it != place.end() && it->second >= next;
    if (stays[row]) next = it->second + 1;
  }
  for (int last = static_cast<int>(shown_.size()) - 1; last >= 0; --last) {
    if (stays[last]) continue;
    int first = last;
    while (first > 0 && !stays[first - 1]) --first;
    beginRemoveRows({}, first, last);
    shown_.erase(shown_.begin() + first, shown_.begin() + last + 1);
    endRemoveRows();
    last = first;
  }
}

// What is left stands in the order of the bodies, with others between.
void BodyTable::insertRowsThatCame(const std::vector<rigid_body_sim::BodyDescription>& bodies) {
  const auto isRow = [&](std::size_t row, std::size_t body) {
    return row < shown_.size() && shown_[row].id == bodies[body].id;
  };
  for (std::size_t first = 0; first < bodies.size(); ++first) {
    if (isRow(first, first)) continue;
    std::size_t end = first + 1;
    while (end < bodies.size() && !isRow(first, end)) ++end;
    beginInsertRows({}, static_cast<int>(first), static_cast<int>(end) - 1);
    shown_.insert(shown_.begin() + static_cast<std::ptrdiff_t>(first),
                  bodies.begin() + static_cast<std::ptrdiff_t>(first),
                  bodies.begin() + static_cast<std::ptrdiff_t>(end));
    endInsertRows();
    first = end;
  }
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
  return index.column() == Name && client_.takesEdits() ? flags | Qt::ItemIsEditable : flags;
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
