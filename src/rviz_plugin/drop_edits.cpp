// SPDX-License-Identifier: BSD-3-Clause
#include "drop_edits.h"

namespace rbs {

void askToDropEdits(QWidget& parent, const QString& title, const QString& question,
                    QMessageBox::StandardButton yes, const std::function<void()>& act,
                    const std::function<void()>& stay) {
  auto* const box = new QMessageBox(QMessageBox::Question, title, "No file holds your edits. " + question,
                                    yes | QMessageBox::Cancel, parent.window());  // which stays enabled
  box->setAttribute(Qt::WA_DeleteOnClose);
  box->setInformativeText("Undo brings the edits back.");
  box->setDefaultButton(QMessageBox::Cancel);
  QObject::connect(box, &QMessageBox::finished, &parent, [box, yes, act, stay] {
    const QAbstractButton* const clicked = box->clickedButton();
    if (clicked && clicked == box->button(yes)) return act();
    if (stay) stay();
  });
  box->open();
}

}  // namespace rbs
