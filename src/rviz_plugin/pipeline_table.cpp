// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline_table.h"

#include <QHeaderView>

namespace rbs {
namespace {

enum Column { kStage, kMilliseconds, kReason, kColumns };

/// A stage that has not run, or is timed as part of another, is only on.
QString costOf(const rigid_body_sim::StageStatus& stage) {
  if (!stage.active) return "off";
  return stage.seconds > 0.0 ? QString::number(1e3 * stage.seconds, 'f', 3) : QString("on");
}

void fill(QTreeWidgetItem& row, const rigid_body_sim::StageStatus& stage, const QPalette& palette) {
  QString reason = QString::fromStdString(stage.reason);
  if (stage.active && !stage.unit.empty())
    reason = QString("%1 %2: ").arg(stage.items).arg(QString::fromStdString(stage.unit)) + reason;
  row.setText(kStage, QString::fromStdString(stage.name));
  row.setText(kMilliseconds, costOf(stage));
  row.setText(kReason, reason);
  row.setToolTip(kReason, reason);
  row.setTextAlignment(kMilliseconds, Qt::AlignRight);
  const QBrush brush = palette.brush(stage.active ? QPalette::Active : QPalette::Disabled, QPalette::Text);
  for (int column = 0; column < kColumns; ++column) row.setForeground(column, brush);
}

}  // namespace

PipelineTable::PipelineTable() {
  setColumnCount(kColumns);
  setHeaderLabels({"Stage", "ms", "Why"});
  setRootIsDecorated(false);
  setUniformRowHeights(true);
  setSelectionMode(QAbstractItemView::NoSelection);
  setFocusPolicy(Qt::NoFocus);
  header()->setStretchLastSection(true);
  header()->setSectionResizeMode(kStage, QHeaderView::ResizeToContents);
  header()->setSectionResizeMode(kMilliseconds, QHeaderView::ResizeToContents);
}

void PipelineTable::show(const std::vector<rigid_body_sim::StageStatus>& pipeline) {
  setRowCount(static_cast<int>(pipeline.size()));
  for (std::size_t i = 0; i < pipeline.size(); ++i)
    fill(*topLevelItem(static_cast<int>(i)), pipeline[i], palette());
}

void PipelineTable::setRowCount(int count) {
  while (topLevelItemCount() > count) delete takeTopLevelItem(count);
  while (topLevelItemCount() < count) addTopLevelItem(new QTreeWidgetItem);
}

}  // namespace rbs
