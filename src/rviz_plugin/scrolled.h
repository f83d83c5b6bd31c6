// SPDX-License-Identifier: BSD-3-Clause
// Pages of panels that scroll.
#pragma once

#include <QScrollArea>

namespace rbs {

/// A page that asks for no height, so that two panels fit above each other.
QScrollArea* scrolled(QWidget* page);

}  // namespace rbs
