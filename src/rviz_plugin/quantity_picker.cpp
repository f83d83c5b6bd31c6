// SPDX-License-Identifier: BSD-3-Clause
#include "quantity_picker.h"

#include <QCompleter>
#include <QHBoxLayout>
#include <QHeaderView>
#include <QTreeWidgetItemIterator>
#include <QVBoxLayout>

namespace rbs {
namespace {

constexpr int kRows = 19;

const Quantity* quantityOf(const QTreeWidgetItem* item) {
  const QVariant index = item->data(0, Qt::UserRole);
  return index.isValid() ? &quantities()[index.toUInt()] : nullptr;
}

QTreeWidgetItem* addGroup(QTreeWidget* list, const QString& title) {
  auto* group = new QTreeWidgetItem(list, {title});
  group->setFlags(Qt::ItemIsEnabled);
  group->setExpanded(true);
  return group;
}

}  // namespace

QuantityPicker::QuantityPicker(QWidget* parent)
    : QFrame(parent, Qt::Popup),
      search_(new QLineEdit),
      list_(new QTreeWidget),
      body_(new QComboBox),
      trouble_(new QLabel) {
  setFrameStyle(QFrame::StyledPanel);
  search_->setPlaceholderText("Search");
  search_->setClearButtonEnabled(true);
  list_->setHeaderHidden(true);
  list_->setColumnCount(2);
  list_->setRootIsDecorated(false);
  list_->setIndentation(12);
  list_->header()->setSectionResizeMode(0, QHeaderView::ResizeToContents);
  list_->setMinimumSize(26 * fontMetrics().averageCharWidth() * 2, kRows * (fontMetrics().height() + 3));
  list_->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  body_->setEditable(true);
  body_->setInsertPolicy(QComboBox::NoInsert);
  body_->setToolTip("The body whose quantities are added");
  body_->completer()->setCompletionMode(QCompleter::PopupCompletion);
  body_->completer()->setFilterMode(Qt::MatchContains);
  trouble_->setWordWrap(true);
  trouble_->hide();

  QTreeWidgetItem* const of_simulation = addGroup(list_, "Simulation");
  QTreeWidgetItem* const of_body = addGroup(list_, "Body, named below");
  for (std::size_t i = 0; i < quantities().size(); ++i) {
    const Quantity& quantity = quantities()[i];
    auto* item =
        new QTreeWidgetItem(quantity.isOfBody() ? of_body : of_simulation,
                            {QString::fromStdString(quantity.name), QString::fromStdString(quantity.unit)});
    item->setData(0, Qt::UserRole, static_cast<uint>(i));
    for (const int column : {0, 1}) item->setToolTip(column, QString::fromStdString(quantity.tip));
    item->setForeground(1, palette().brush(QPalette::Disabled, QPalette::Text));
  }

  auto* row = new QHBoxLayout;
  row->addWidget(new QLabel("Body"));
  row->addWidget(body_, 1);
  auto* rows = new QVBoxLayout(this);
  rows->setContentsMargins(6, 6, 6, 6);
  rows->setSpacing(4);
  rows->addWidget(search_);
  rows->addWidget(list_, 1);
  rows->addLayout(row);
  rows->addWidget(trouble_);

  connect(search_, &QLineEdit::textChanged, this, &QuantityPicker::filter);
  connect(search_, &QLineEdit::returnPressed, this, &QuantityPicker::chooseOnlyMatch);
  connect(list_, &QTreeWidget::itemClicked, this, &QuantityPicker::choose);
}

void QuantityPicker::open(const QPoint& at, const QStringList& bodies,
                          const std::function<bool(const Quantity&)>& is_plotted) {
  setBodies(bodies);
  trouble_->hide();
  search_->clear();
  for (QTreeWidgetItemIterator it(list_); *it; ++it) {
    const Quantity* quantity = quantityOf(*it);
    if (quantity && !quantity->isOfBody())
      (*it)->setCheckState(0, is_plotted(*quantity) ? Qt::Checked : Qt::Unchecked);
  }
  move(at);
  show();
  search_->setFocus();
}

void QuantityPicker::setBodies(const QStringList& bodies) {
  const QString typed = body_->currentText();
  body_->clear();
  body_->addItems(bodies);
  body_->setEditText(typed.isEmpty() && !bodies.isEmpty() ? bodies.last() : typed);
}

void QuantityPicker::filter(const QString& words) {
  for (QTreeWidgetItemIterator it(list_); *it; ++it)
    if (quantityOf(*it)) (*it)->setHidden(!(*it)->text(0).contains(words.trimmed(), Qt::CaseInsensitive));
}

void QuantityPicker::chooseOnlyMatch() {
  for (QTreeWidgetItemIterator it(list_, QTreeWidgetItemIterator::NotHidden); *it; ++it)
    if (quantityOf(*it)) return choose(*it);
}

void QuantityPicker::choose(QTreeWidgetItem* item) {
  const Quantity* const quantity = quantityOf(item);
  if (!quantity) return;
  const QString body = quantity->isOfBody() ? body_->currentText().trimmed() : QString();
  trouble_->setVisible(quantity->isOfBody() &&
                       body_->findText(body, Qt::MatchExactly | Qt::MatchCaseSensitive) < 0);
  trouble_->setText(body.isEmpty() ? "Name a body first."
                                   : QString("No body is named '%1' in this scene.").arg(body));
  if (!trouble_->isHidden()) return;
  if (!quantity->isOfBody())
    item->setCheckState(0, item->checkState(0) == Qt::Checked ? Qt::Unchecked : Qt::Checked);
  Q_EMIT toggled(*quantity, body);
}

}  // namespace rbs
