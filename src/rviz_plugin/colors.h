// SPDX-License-Identifier: BSD-3-Clause
// Colours of the panels that follow the theme.
#pragma once

#include <QPalette>
#include <QWidget>

namespace rbs {

/// Red that can be read on the window's background of this palette, light or dark.
QColor troubleColor(const QPalette& palette);

/// Gives a text the colour of trouble, or the usual one.
void showTrouble(QWidget& text, bool is_trouble);

}  // namespace rbs
