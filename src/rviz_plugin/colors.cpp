// SPDX-License-Identifier: BSD-3-Clause
#include "colors.h"

#include <QApplication>

namespace rbs {

QColor troubleColor(const QPalette& palette) {
  const bool is_dark = palette.color(QPalette::Window).lightness() < 128;
  return is_dark ? QColor(0xff, 0x8a, 0x8f) : QColor(0xb0, 0x00, 0x20);
}

void showTrouble(QWidget& text, bool is_trouble) {
  QPalette palette = QApplication::palette();
  if (is_trouble) {
    for (const QPalette::ColorRole role : {QPalette::WindowText, QPalette::Text})
      palette.setColor(role, troubleColor(palette));
  }
  text.setPalette(palette);
}

}  // namespace rbs
