// SPDX-License-Identifier: BSD-3-Clause
// The icons of the transport buttons, each in a colour of its own.
#pragma once

#include <QIcon>

namespace rbs {

inline constexpr int kIconSize = 18;  ///< pixels

QIcon playIcon();        ///< green triangle
QIcon pauseIcon();       ///< amber bars
QIcon stepIcon();        ///< blue triangle with a bar
QIcon resetIcon();       ///< red turning arrow
QIcon recordIcon();      ///< red disc
QIcon stopRecordIcon();  ///< red square
QIcon undoIcon();        ///< arrow to the left in the colour of texts
QIcon redoIcon();        ///< arrow to the right in the colour of texts

}  // namespace rbs
