// SPDX-License-Identifier: BSD-3-Clause
// Keeps a wheel that scrolls a panel from changing what happens to be under the mouse.
#pragma once

#include <QWidget>

namespace rbs {

/// The wheel changes a spin box only after a click into it, and a combo box only in its open list.
void guardFromWheel(QWidget& box);

}  // namespace rbs
