// SPDX-License-Identifier: BSD-3-Clause
#include "number_box.h"

#include <QKeyEvent>
#include <QLocale>

namespace rbs {
namespace {

// Whether it is a key that is no part of a number, which a widget could keep from the shortcuts; or Undo or Redo, while nothing
// is typed.
bool leaveToShortcuts(QEvent* event, bool is_typing) {
  if (event->type() != QEvent::ShortcutOverride) return false;
  auto* const key = static_cast<QKeyEvent*>(event);
  if (!is_typing && (key->matches(QKeySequence::Undo) || key->matches(QKeySequence::Redo))) {
    event->ignore();
    return true;
  }
  const QString text = key->text();
  const bool is_other =
      !text.isEmpty() && text[0].isPrint() && !text[0].isDigit() && !QString("+-.,eE").contains(text[0]);
  if (is_other) event->ignore();
  return is_other;
}

}  // namespace

NumberBox::NumberBox() {
  QLocale locale = QLocale::c();
  locale.setNumberOptions(QLocale::OmitGroupSeparator | QLocale::RejectGroupSeparator);
  setLocale(locale);
  lineEdit()->installEventFilter(this);
  connect(this, &QAbstractSpinBox::editingFinished, this, [this] { lineEdit()->setModified(false); });
}

// Both the line and the box take keys for themselves before they are shortcuts.
bool NumberBox::eventFilter(QObject* object, QEvent* event) {
  return leaveToShortcuts(event, lineEdit()->isModified()) || QDoubleSpinBox::eventFilter(object, event);
}

bool NumberBox::event(QEvent* event) {
  return leaveToShortcuts(event, lineEdit()->isModified()) || QDoubleSpinBox::event(event);
}

QValidator::State NumberBox::validate(QString& text, int& position) const {
  text.replace(',', '.');
  const QValidator::State state = QDoubleSpinBox::validate(text, position);
  if (state != QValidator::Invalid) return state;
  // A digit too many is refused. A letter, or what makes a number too large, is not: the rest would be another number,
  // 19 of 1e9. Enter then brings back what was there.
  QString number = text;
  if (number.endsWith(suffix())) number.chop(suffix().size());
  bool is_number = false;
  const double value = locale().toDouble(number, &is_number);
  const bool fits =
      is_number && !number.contains('e', Qt::CaseInsensitive) && value >= minimum() && value <= maximum();
  return fits ? QValidator::Invalid : QValidator::Intermediate;
}

QString NumberBox::textFromValue(double value) const {
  QString text = QDoubleSpinBox::textFromValue(value);
  while (text.contains('.') && (text.endsWith('0') || text.endsWith('.'))) text.chop(1);
  return text;
}

}  // namespace rbs
