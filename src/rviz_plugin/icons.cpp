// SPDX-License-Identifier: BSD-3-Clause
#include "icons.h"

#include <QGuiApplication>
#include <QIconEngine>
#include <QPainter>
#include <QPalette>
#include <QPixmap>
#include <QPolygonF>

#include <functional>
#include <utility>

namespace rbs {
namespace {

const QColor kRecordRed(0xd4, 0x1f, 0x2f);

using Draw = std::function<void(QPainter&)>;

/// An icon that is drawn anew in every size, in a square of 18 units, y down. Without a colour it has that of the texts
/// on buttons.
class DrawnIcon : public QIconEngine {
 public:
  DrawnIcon(const QColor& color, Draw draw) : color_(color), draw_(std::move(draw)) {}

  QIconEngine* clone() const override { return new DrawnIcon(*this); }

  void paint(QPainter* painter, const QRect& rect, QIcon::Mode mode, QIcon::State) override {
    constexpr double kFaint = 0.35;
    painter->save();
    painter->translate(rect.topLeft());
    painter->scale(double(rect.width()) / kIconSize, double(rect.height()) / kIconSize);
    painter->setRenderHint(QPainter::Antialiasing);
    painter->setOpacity(mode == QIcon::Disabled ? kFaint : 1.0);
    const QColor color = color_.isValid() ? color_ : QGuiApplication::palette().color(QPalette::ButtonText);
    painter->setPen(Qt::NoPen);
    painter->setBrush(color);
    draw_(*painter);
    painter->restore();
  }

  QPixmap pixmap(const QSize& size, QIcon::Mode mode, QIcon::State state) override {
    QPixmap pixmap(size);
    pixmap.fill(Qt::transparent);
    QPainter painter(&pixmap);
    paint(&painter, QRect(QPoint(), size), mode, state);
    return pixmap;
  }

 private:
  QColor color_;
  Draw draw_;
};

// RViz does not say that its icons may have as many pixels as the screen has for their points.
QIcon drawn(const QColor& color, Draw draw) {
  QCoreApplication::setAttribute(Qt::AA_UseHighDpiPixmaps);
  return QIcon(new DrawnIcon(color, std::move(draw)));
}

// An arrow to the left whose tail turns down; seen in a mirror where `forward`.
QIcon turned(bool forward) {
  return drawn({}, [=](QPainter& painter) {
    const QColor color = painter.brush().color();
    if (forward) painter.translate(kIconSize, 0), painter.scale(-1.0, 1.0);
    painter.drawPolygon(QPolygonF({{1, 7}, {8, 1}, {8, 13}}));
    painter.setBrush(Qt::NoBrush);
    painter.setPen(QPen(color, 2.5));
    constexpr int kSixteenths = 16;  // of a degree, Qt's unit of angle
    painter.drawArc(QRectF(2, 7, 13, 9), -90 * kSixteenths, 180 * kSixteenths);
  });
}

}  // namespace

QIcon recordIcon() {
  return drawn(kRecordRed, [](QPainter& painter) { painter.drawEllipse(QRectF(3, 3, 12, 12)); });
}

QIcon stopRecordIcon() {
  return drawn(kRecordRed, [](QPainter& painter) { painter.drawRect(QRectF(4, 4, 10, 10)); });
}

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
  return drawn(color, [=](QPainter& painter) {
    painter.drawPolygon(QPolygonF({{9, 0}, {9, 8}, {14, 4}}));
    painter.setBrush(Qt::NoBrush);
    painter.setPen(QPen(color, 2.5));
    constexpr int kSixteenths = 16;  // of a degree, Qt's unit of angle
    painter.drawArc(QRectF(3, 4, 12, 12), 100 * kSixteenths, 290 * kSixteenths);
  });
}

}  // namespace rbs
