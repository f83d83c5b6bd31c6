// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline_tree.h"

#include <QHeaderView>
#include <QPainter>
#include <QStyledItemDelegate>

#include <map>

namespace rbs {
namespace {

enum StageColumn { kStage, kMilliseconds, kReason, kStageColumns };
constexpr int kShare = Qt::UserRole;  // of the step, 0 to 1

/// Draws the share of a stage as a bar behind its number.
class ShareBar : public QStyledItemDelegate {
 public:
  using QStyledItemDelegate::QStyledItemDelegate;

  void paint(QPainter* painter, const QStyleOptionViewItem& option, const QModelIndex& index) const override {
    const double share = index.data(kShare).toDouble();
    QRect bar = option.rect.adjusted(1, 2, -1, -2);
    bar.setWidth(static_cast<int>(share * bar.width()));
    QColor color = option.palette.color(QPalette::Highlight);
    color.setAlphaF(0.45);
    painter->fillRect(bar, color);
    QStyledItemDelegate::paint(painter, option, index);
  }
};

/// A stage that has not run, or is timed as part of another, is only on.
QString costOf(const rigid_body_sim::StageStatus& stage) {
  if (!stage.active) return "off";
  return stage.seconds > 0.0 ? QString::number(1e3 * stage.seconds, 'f', 3) : QString("on");
}

QString reasonOf(const rigid_body_sim::StageStatus& stage) {
  const QString reason = QString::fromStdString(stage.reason);
  if (!stage.active || stage.unit.empty()) return reason;
  return QString("%1 %2: ").arg(stage.items).arg(QString::fromStdString(stage.unit)) + reason;
}

void fill(QTreeWidgetItem& row, const rigid_body_sim::StageStatus& stage, double total,
          const QPalette& palette) {
  const QString reason = reasonOf(stage);
  row.setText(kStage, QString::fromStdString(stage.name));
  row.setText(kMilliseconds, costOf(stage));
  row.setData(kMilliseconds, kShare, total > 0.0 ? stage.seconds / total : 0.0);
  row.setText(kReason, reason);
  row.setTextAlignment(kMilliseconds, Qt::AlignRight);
  const QBrush brush = palette.brush(stage.active ? QPalette::Active : QPalette::Disabled, QPalette::Text);
  for (int column = 0; column < kStageColumns; ++column) {
    row.setForeground(column, brush);
    row.setToolTip(column, reason);
  }
}

double shareOf(const QTreeWidgetItem& row) {
  return row.data(kMilliseconds, kShare).toDouble();
}

}  // namespace

PipelineTree::PipelineTree() {
  setColumnCount(kStageColumns);
  setHeaderLabels({"Stage", "ms", "Why"});
  setUniformRowHeights(true);
  setSelectionMode(QAbstractItemView::SingleSelection);
  setTextElideMode(Qt::ElideRight);
  setFocusPolicy(Qt::NoFocus);
  setIndentation(indentation() / 2);
  setItemDelegateForColumn(kMilliseconds, new ShareBar(this));
  header()->setStretchLastSection(true);
  header()->setSectionResizeMode(kStage, QHeaderView::ResizeToContents);
  header()->resizeSection(kMilliseconds, fontMetrics().horizontalAdvance("1000.000") + 12);
}

void PipelineTree::show(const std::vector<rigid_body_sim::StageStatus>& pipeline) {
  if (rows_.size() != pipeline.size()) build(pipeline);
  double total = 0.0;
  for (const rigid_body_sim::StageStatus& stage : pipeline)
    if (stage.part_of.empty()) total += stage.seconds;
  for (std::size_t i = 0; i < pipeline.size(); ++i) fill(*rows_[i], pipeline[i], total, palette());
}

QString PipelineTree::explanation() const {
  const QList<QTreeWidgetItem*> selected = selectedItems();
  const QTreeWidgetItem* const row = selected.isEmpty() ? costliest() : selected.front();
  if (!row) return {};
  const QString cost = shareOf(*row) > 0.0 ? QString("%1 % of the step").arg(100.0 * shareOf(*row), 0, 'f', 0)
                                           : row->text(kMilliseconds);
  return QString("%1, %2: %3").arg(row->text(kStage), cost, row->text(kReason));
}

const QTreeWidgetItem* PipelineTree::costliest() const {
  const QTreeWidgetItem* most = nullptr;
  for (const QTreeWidgetItem* row : rows_)
    if (row->childCount() == 0 && (!most || shareOf(*row) > shareOf(*most))) most = row;
  return most;
}

void PipelineTree::build(const std::vector<rigid_body_sim::StageStatus>& pipeline) {
  rows_.clear();
  clear();
  std::map<std::string, QTreeWidgetItem*> stages;
  for (const rigid_body_sim::StageStatus& stage : pipeline) {
    const auto whole = stages.find(stage.part_of);
    rows_.push_back(new QTreeWidgetItem);
    if (whole == stages.end()) {
      addTopLevelItem(rows_.back());
    } else {
      whole->second->addChild(rows_.back());
    }
    stages.emplace(stage.name, rows_.back());
  }
  expandAll();
}

}  // namespace rbs
