// SPDX-License-Identifier: BSD-3-Clause
#include "wheel_guard.h"

#include <QComboBox>
#include <QEvent>

namespace rbs {
namespace {

class WheelGuard : public QObject {
 public:
  explicit WheelGuard(QWidget& box) : QObject(&box) { box.installEventFilter(this); }

  bool eventFilter(QObject* box, QEvent* event) override {
    if (event->type() != QEvent::Wheel) return false;
    if (!qobject_cast<QComboBox*>(box) && static_cast<QWidget*>(box)->hasFocus()) return false;
    event->ignore();  // the widget around it scrolls
    return true;
  }
};

}  // namespace

void guardFromWheel(QWidget& box) {
  box.setFocusPolicy(Qt::StrongFocus);  // else a turn of the wheel brings the focus
  new WheelGuard(box);
}

}  // namespace rbs
