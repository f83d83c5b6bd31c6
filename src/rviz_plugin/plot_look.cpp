// SPDX-License-Identifier: BSD-3-Clause
#include "plot_look.h"

#include <QFontInfo>

namespace rbs {
namespace {

constexpr std::size_t kColors = 8;
constexpr const char* kOnLight[kColors] = {"#0072b2", "#d55e00", "#009e73", "#b0568f",
                                           "#e69f00", "#56b4e9", "#8a8200", "#555555"};
constexpr const char* kOnDark[kColors] = {"#56b4e9", "#ff8a3d", "#2bc79a", "#dd9fc3",
                                          "#f0e442", "#8f9dff", "#e6b800", "#b8b8b8"};

bool isDark(const QPalette& palette) {
  return palette.color(QPalette::Base).lightnessF() < 0.5;
}

}  // namespace

QColor curveColor(std::size_t curve, const QPalette& palette) {
  return (isDark(palette) ? kOnDark : kOnLight)[curve % kColors];
}

QColor gridColor(const QPalette& palette) {
  QColor color = palette.color(QPalette::Text);
  color.setAlphaF(0.12);
  return color;
}

QFont smallFont(const QFont& font) {
  QFont small(font.family());
  small.setPointSizeF(0.85 * QFontInfo(font).pointSizeF());
  return small;
}

QString numberText(double value, int digits) {
  return QString::number(value, 'g', digits).replace('-', QChar(0x2212));
}

}  // namespace rbs
