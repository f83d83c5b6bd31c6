// SPDX-License-Identifier: BSD-3-Clause
// The colours and texts of the plots, which follow the theme of the desktop.
#pragma once

#include <QColor>
#include <QFont>
#include <QPalette>
#include <QString>

namespace rbs {

/// The colour of the curve of this number: eight that people of any colour vision tell apart (Okabe and Ito 2008),
/// shifted to stand out from a light or a dark background; then from the first again.
QColor curveColor(std::size_t curve, const QPalette& palette);
/// A line that divides the background and does not strike the eye.
QColor gridColor(const QPalette& palette);
/// The font of the axes, a little smaller than that of the panel.
QFont smallFont(const QFont& font);
/// A number with so many digits that count.
QString numberText(double value, int digits);

}  // namespace rbs
