// SPDX-License-Identifier: BSD-3-Clause
// The list of all keys and mouse actions, in RViz's menu Help.
#pragma once

#include <QWidget>

namespace rbs {

/// Object name of its menu entry.
inline constexpr const char* kShortcutsName = "rigid_body_sim_shortcuts";

/// Adds the list to the menu Help of RViz's window, where it is not there yet, for as long as `owner` lives.
void offerShortcuts(QWidget& window, QObject& owner);

}  // namespace rbs
