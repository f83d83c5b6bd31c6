// SPDX-License-Identifier: BSD-3-Clause
#include "number_box.h"

#include "colors.h"

#include <QFocusEvent>
#include <QKeyEvent>
#include <QLocale>

#include <algorithm>
#include <utility>

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

NumberBox::NumberBox() : refusal_(new QLabel(this, Qt::ToolTip)), read_(new QTimer(this)) {
  constexpr int kMargin = 4, kReadIn = 10000;  // pixels; ms
  refusal_->setTextFormat(Qt::PlainText);
  refusal_->setFrameStyle(QFrame::Box);
  refusal_->setMargin(kMargin);
  showTrouble(*refusal_, true);
  setKeyboardTracking(false);  // the last number is the one before what is typed, not a part of that
  read_->setSingleShot(true);
  read_->setInterval(kReadIn);
  const auto forget = [this] {
    instead_.reset();
    refusal_->hide();
  };
  connect(read_, &QTimer::timeout, this, forget);
  connect(lineEdit(), &QLineEdit::textEdited, this, forget);
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
  if (event->type() == QEvent::Hide || event->type() == QEvent::EnabledChange ||
      event->type() == QEvent::WindowDeactivate)
    refusal_->hide();
  if (leaveToShortcuts(event, lineEdit()->isModified())) return true;
  const bool is_done = QDoubleSpinBox::event(event);
  // The window is behind another one: what the end of typing has refused is not said over that.
  if (event->type() == QEvent::FocusOut &&
      static_cast<QFocusEvent*>(event)->reason() == Qt::ActiveWindowFocusReason)
    refusal_->hide();
  return is_done;
}

QValidator::State NumberBox::validate(QString& text, int& position) const {
  if (isSpecial(text)) return QValidator::Acceptable;
  text.replace(',', '.');
  const QValidator::State state = QDoubleSpinBox::validate(text, position);
  if (state != QValidator::Invalid) return state;
  // The key of a decimal too many is refused. A letter, or what makes a number too large, is not: the rest would be another number,
  // 19 of 1e9, and 25 of 2.5 where it has to be whole. Enter then brings back what was there.
  const QString number = withoutSuffix(text);
  bool is_number = false;
  const double value = locale().toDouble(number, &is_number);
  const bool fits =
      is_number && !number.contains('e', Qt::CaseInsensitive) && value >= minimum() && value <= maximum();
  return fits && decimals() > 0 ? QValidator::Invalid : QValidator::Intermediate;
}

bool NumberBox::takeTyped() {
  interpretText();
  if (std::exchange(instead_, std::nullopt) != value()) return true;
  showRefusal();
  return false;
}

// The last number takes the place of this text. The refusal covers what is below: a row of its own would move the rest.
void NumberBox::fixup(QString& text) const {
  constexpr int kShown = 20;  // letters
  const QString typed = withoutSuffix(text).trimmed();
  if (typed.isEmpty() || isSpecial(typed) || !isVisible()) return;
  refusal_->setText(QString("%1 (allowed: %2, %3 to %4%5)")
                        .arg(typed.size() > kShown ? typed.left(kShown) + "…" : typed,
                             decimals() > 0 ? "a number such as 1.5" : "a whole number",
                             textFromValue(minimum()), textFromValue(maximum()), suffix()));
  instead_ = value();
  showRefusal();
}

void NumberBox::showRefusal() const {
  refusal_->adjustSize();
  const QPoint below = mapToGlobal(QPoint(width() - refusal_->width(), height()));
  refusal_->move(std::max(below.x(), window()->geometry().left()), below.y());
  refusal_->show();
  read_->start();
}

bool NumberBox::isSpecial(const QString& text) const {
  return !specialValueText().isEmpty() && text == specialValueText();
}

QString NumberBox::withoutSuffix(QString text) const {
  if (text.endsWith(suffix())) text.chop(suffix().size());
  return text;
}

QString NumberBox::textFromValue(double value) const {
  QString text = QDoubleSpinBox::textFromValue(value);
  while (text.contains('.') && (text.endsWith('0') || text.endsWith('.'))) text.chop(1);
  return text;
}

}  // namespace rbs
