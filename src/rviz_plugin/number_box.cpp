// SPDX-License-Identifier: BSD-3-Clause
#include "number_box.h"

#include <QLocale>

namespace rbs {

NumberBox::NumberBox() {
  QLocale locale = QLocale::c();
  locale.setNumberOptions(QLocale::OmitGroupSeparator | QLocale::RejectGroupSeparator);
  setLocale(locale);
}

QValidator::State NumberBox::validate(QString& text, int& position) const {
  text.replace(',', '.');
  return QDoubleSpinBox::validate(text, position);
}

}  // namespace rbs
