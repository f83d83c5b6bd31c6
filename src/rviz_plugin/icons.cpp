// SPDX-License-Identifier: BSD-3-Clause
#include "icons.h"

#include <QPainter>
#include <QPixmap>
#include <QPolygonF>

namespace rbs {
namespace {

/// Drawn by `draw` in a square of 18 units, y down.
template <class Draw>
QIcon drawn(const QColor& color, Draw draw) {
  QPixmap pixmap(kIconSize, kIconSize);
  pixmap.fill(Qt::transparent);
  QPainter painter(&pixmap);
  painter.setRenderHint(QPainter::Antialiasing);
  painter.setPen(Qt::NoPen);
  painter.setBrush(color);
  draw(painter);
  return QIcon(pixmap);
}

// An arrow to the left whose tail turns down; seen in a mirror where `forward`.
QIcon turned(bool forward) {
  const QColor color(0x5f, 0x6b, 0x7a);
  return drawn(color, [&](QPainter& painter) {
    if (forward) painter.translate(kIconSize, 0), painter.scale(-1.0, 1.0);
    painter.drawPolygon(QPolygonF({{1, 7}, {8, 1}, {8, 13}}));
    painter.setBrush(Qt::NoBrush);
    painter.setPen(QPen(color, 2.5));
    constexpr int kSixteenths = 16;  // of a degree, Qt's unit of angle
    painter.drawArc(QRectF(2, 7, 13, 9), -90 * kSixteenths, 180 * kSixteenths);
  });
}

}  // namespace

QIcon undoIcon() {
  return turned(false);
}

QIcon redoIcon() {
  return turned(true);
}

QIcon playIcon() {
  return drawn(QColor(0x2e, 0x9e, 0x4f), [](QPainter& painter) {
    painter.drawPolygon(QPolygonF({{4, 2}, {16, 9}, {4, 16}}));
  });
}

QIcon pauseIcon() {
  return drawn(QColor(0xd9, 0x8a, 0x00), [](QPainter& painter) {
    painter.drawRect(3, 2, 4, 14);
    painter.drawRect(11, 2, 4, 14);
  });
}

QIcon stepIcon() {
  return drawn(QColor(0x2f, 0x6f, 0xbf), [](QPainter& painter) {
    painter.drawPolygon(QPolygonF({{3, 2}, {12, 9}, {3, 16}}));
    painter.drawRect(12, 2, 3, 14);
  });
}

QIcon resetIcon() {
  const QColor color(0xb8, 0x43, 0x3a);
  return drawn(color, [&](QPainter& painter) {
    painter.drawPolygon(QPolygonF({{9, 0}, {9, 8}, {14, 4}}));
    painter.setBrush(Qt::NoBrush);
    painter.setPen(QPen(color, 2.5));
    constexpr int kSixteenths = 16;  // of a degree, Qt's unit of angle
    painter.drawArc(QRectF(3, 4, 12, 12), 100 * kSixteenths, 290 * kSixteenths);
  });
}

}  // namespace rbs
