// SPDX-License-Identifier: BSD-3-Clause
#include "duplicate_dialog.h"

#include <QDialogButtonBox>
#include <QFormLayout>
#include <QHBoxLayout>
#include <QLabel>
#include <QPushButton>

namespace rbs {

DuplicateDialog::DuplicateDialog(int bodies, QWidget* parent) : QDialog(parent), count_(new NumberBox) {
  constexpr int kMostCopies = 10'000;
  constexpr double kFarthest = 1e6;  // m
  setWindowTitle("Duplicate");
  count_->setRange(1, kMostCopies);
  count_->setDecimals(0);
  auto* const form = new QFormLayout(this);
  form->addRow(bodies == 1 ? QString("Copies") : QString("Copies of each of %1 bodies").arg(bodies), count_);
  auto* const parts = new QHBoxLayout;
  for (NumberBox*& part : offset_) {
    part = new NumberBox;
    part->setRange(-kFarthest, kFarthest);
    part->setDecimals(3);
    part->setSingleStep(0.1);
    parts->addWidget(part);
  }
  form->addRow("Offset x, y, z, m", parts);
  form->addRow(new QLabel("From one copy to the next. Without an offset the copies stand above."));
  auto* const buttons = new QDialogButtonBox(QDialogButtonBox::Ok | QDialogButtonBox::Cancel);
  buttons->button(QDialogButtonBox::Ok)->setText("Duplicate");
  form->addRow(buttons);
  connect(buttons, &QDialogButtonBox::accepted, this, &QDialog::accept);
  connect(buttons, &QDialogButtonBox::rejected, this, &QDialog::reject);
}

void DuplicateDialog::accept() {
  bool are_taken = count_->takeTyped();
  for (NumberBox* const part : offset_) are_taken = part->takeTyped() && are_taken;
  if (are_taken) QDialog::accept();
}

geometry_msgs::Vector3 DuplicateDialog::offset() const {
  geometry_msgs::Vector3 v;
  v.x = offset_[0]->value();
  v.y = offset_[1]->value();
  v.z = offset_[2]->value();
  return v;
}

}  // namespace rbs
