// SPDX-License-Identifier: BSD-3-Clause
#include "number_box.h"

#include <QLocale>

#include <algorithm>

namespace rbs {

NumberBox::NumberBox() {
  QLocale locale = QLocale::c();
  locale.setNumberOptions(QLocale::OmitGroupSeparator | QLocale::RejectGroupSeparator);
  setLocale(locale);
}

QValidator::State NumberBox::validate(QString& text, int& position) const {
  text.replace(',', '.');
  // A letter that is refused would make another number of the rest: 19 of 1e9. Enter brings back what was there.
  return std::max(QDoubleSpinBox::validate(text, position), QValidator::Intermediate);
}

QString NumberBox::textFromValue(double value) const {
  QString text = QDoubleSpinBox::textFromValue(value);
  while (text.contains('.') && (text.endsWith('0') || text.endsWith('.'))) text.chop(1);
  return text;
}

}  // namespace rbs
