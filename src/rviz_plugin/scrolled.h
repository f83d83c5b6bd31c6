// SPDX-License-Identifier: BSD-3-Clause
// How panels share the height of RViz's window: pages that scroll, and docks behind tabs.
#pragma once

#include <QScrollArea>

namespace rbs {

/// A page that asks for no height, so that two panels fit above each other.
QScrollArea* scrolled(QWidget* page);

/// Puts the dock of a panel that RViz has just added behind a tab, beside the docks at the same edge of the window. RViz stacks
/// them, beyond the lower edge of a small screen. What a saved layout says of the docks comes later, and holds.
void shareDock(QWidget& panel);

}  // namespace rbs
