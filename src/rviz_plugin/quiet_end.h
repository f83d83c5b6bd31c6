// SPDX-License-Identifier: BSD-3-Clause
// The end of a panel whose members are used by its fields.
#pragma once

#include <QWidget>

namespace rbs {

/// To be called first in the destructor of a panel. Fields are destroyed after the members of the panel, and one
/// with the focus enters what is half typed in it: into a client that is gone. Now that is dropped.
inline void endQuietly(QWidget& panel) {
  for (QWidget* const child : panel.findChildren<QWidget*>()) child->blockSignals(true);
}

}  // namespace rbs
