// SPDX-License-Identifier: BSD-3-Clause
// The question before edits are dropped that no file holds.
#pragma once

#include <QMessageBox>
#include <QString>
#include <QWidget>

#include <functional>

namespace rbs {

/// Asks `question`, with a button `yes` that does `act`; else `stay` is done. Neither is done once `parent` is gone. The simulation
/// goes on while the question stands.
void askToDropEdits(QWidget& parent, const QString& title, const QString& question,
                    QMessageBox::StandardButton yes, const std::function<void()>& act,
                    const std::function<void()>& stay = {});

}  // namespace rbs
