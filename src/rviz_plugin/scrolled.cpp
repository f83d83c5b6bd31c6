// SPDX-License-Identifier: BSD-3-Clause
#include "scrolled.h"

namespace rbs {

QScrollArea* scrolled(QWidget* page) {
  auto* const area = new QScrollArea;
  area->setWidget(page);
  area->setWidgetResizable(true);
  area->setFrameShape(QFrame::NoFrame);
  return area;
}

}  // namespace rbs
