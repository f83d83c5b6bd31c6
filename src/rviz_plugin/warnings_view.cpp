// SPDX-License-Identifier: BSD-3-Clause
#include "warnings_view.h"

#include <QHBoxLayout>
#include <QHeaderView>
#include <QPushButton>
#include <QVBoxLayout>

#include <utility>

namespace rbs {
namespace {

enum WarningColumn { kTime, kCount, kText, kWarningColumns };
constexpr int kKept = 200;  // warnings that are kept

}  // namespace

WarningsView::WarningsView() : list_(new QTreeWidget) {
  list_->setColumnCount(kWarningColumns);
  list_->setHeaderLabels({"Time, s", "×", "Warning"});
  list_->setRootIsDecorated(false);
  list_->setWordWrap(true);
  list_->header()->setStretchLastSection(true);
  list_->header()->setSectionResizeMode(kTime, QHeaderView::ResizeToContents);
  list_->header()->setSectionResizeMode(kCount, QHeaderView::ResizeToContents);
  auto* const clear = new QPushButton("Clear");
  connect(clear, &QPushButton::clicked, this, &WarningsView::clear);
  auto* const last_row = new QHBoxLayout;
  last_row->addStretch();
  last_row->addWidget(clear);
  auto* const rows = new QVBoxLayout(this);
  rows->setContentsMargins(0, 0, 0, 0);
  rows->setSpacing(2);
  rows->addWidget(list_);
  rows->addLayout(last_row);
}

void WarningsView::show(const rigid_body_sim::Status& status) {
  if (std::exchange(world_, status.world) != status.world) clear();
  if (status.warnings.empty()) return;
  for (const std::string& warning : status.warnings) add(QString::fromStdString(warning), status.time);
  while (count() > kKept) delete list_->takeTopLevelItem(count() - 1);
  Q_EMIT countChanged(count());
}

void WarningsView::add(const QString& text, double time) {
  QTreeWidgetItem* item = nullptr;
  for (int row = 0; row < count() && !item; ++row)
    if (list_->topLevelItem(row)->text(kText) == text) item = list_->takeTopLevelItem(row);
  if (!item) item = new QTreeWidgetItem({"", "0", text});
  item->setText(kTime, QString::number(time, 'f', 2));
  item->setText(kCount, QString::number(item->text(kCount).toInt() + 1));
  item->setToolTip(kText, text);
  for (const int column : {kTime, kCount, kText})
    item->setTextAlignment(column, Qt::AlignTop | Qt::AlignLeft);
  list_->insertTopLevelItem(0, item);
}

void WarningsView::clear() {
  list_->clear();
  Q_EMIT countChanged(0);
}

}  // namespace rbs
