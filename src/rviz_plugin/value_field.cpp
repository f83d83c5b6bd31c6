// SPDX-License-Identifier: BSD-3-Clause
#include "value_field.h"

#include "colors.h"

#include <QKeyEvent>

namespace rbs {

ValueField::ValueField() {
  setMinimumWidth(fontMetrics().horizontalAdvance("-0.000000"));
  connect(this, &QLineEdit::editingFinished, this, &ValueField::enter);
}

void ValueField::show(const std::optional<QString>& value) {
  value_ = value;
  if (!isBusy()) put();
}

void ValueField::put() {
  setPlaceholderText(value_ ? "" : "mixed");
  const QString text = value_.value_or("");
  if (text == this->text()) return;
  setText(text);
  setCursorPosition(0);
}

void ValueField::enter() {
  if (!isModified()) return;
  setModified(false);
  const QString typed = text().trimmed();
  if (typed.isEmpty() || (value_ && typed == *value_)) return restore();
  is_asked_ = true;
  Q_EMIT entered(typed);
}

void ValueField::answer(const QString& refusal) {
  is_asked_ = false;
  is_refused_ = !refusal.isEmpty();
  showTrouble(*this, is_refused_);
  if (!is_refused_) Q_EMIT restored();
}

void ValueField::restore() {
  setModified(false);
  is_refused_ = is_asked_ = false;
  showTrouble(*this, false);
  put();
  Q_EMIT restored();
}

bool ValueField::event(QEvent* event) {
  if (event->type() == QEvent::ShortcutOverride && !isModified()) {
    auto* const key = static_cast<QKeyEvent*>(event);
    if (key->matches(QKeySequence::Undo) || key->matches(QKeySequence::Redo)) {
      key->ignore();
      return false;
    }
  }
  return QLineEdit::event(event);
}

void ValueField::keyPressEvent(QKeyEvent* event) {
  if (event->key() != Qt::Key_Escape) return QLineEdit::keyPressEvent(event);
  restore();
  event->accept();
}

}  // namespace rbs
