// SPDX-License-Identifier: BSD-3-Clause
#include "scrolled.h"

#include <QDockWidget>
#include <QMainWindow>

namespace rbs {

QScrollArea* scrolled(QWidget* page) {
  auto* const area = new QScrollArea;
  area->setWidget(page);
  area->setWidgetResizable(true);
  area->setFrameShape(QFrame::NoFrame);
  return area;
}

void shareDock(QWidget& panel) {
  auto* const dock = qobject_cast<QDockWidget*>(panel.parentWidget());
  auto* const window = dock ? qobject_cast<QMainWindow*>(dock->parentWidget()) : nullptr;
  if (!window) return;
  const auto isClosed = [](const QDockWidget& other) {  // a dock that is new is hidden as well
    return other.isHidden() && other.testAttribute(Qt::WA_WState_ExplicitShowHide);
  };
  for (QDockWidget* const other : window->findChildren<QDockWidget*>(QString(), Qt::FindDirectChildrenOnly)) {
    if (other == dock || other->isFloating() || isClosed(*other) ||
        window->dockWidgetArea(other) != window->dockWidgetArea(dock))
      continue;
    window->tabifyDockWidget(other, dock);
    dock->raise();
    return;
  }
}

}  // namespace rbs
