// SPDX-License-Identifier: BSD-3-Clause
#include "elided_text.h"

#include <QAction>
#include <QClipboard>
#include <QGuiApplication>
#include <QTextLayout>

namespace rbs {

namespace {
constexpr int kBelow = 2;  // pixels: some fonts draw the underscore below their last row
}

ElidedText::ElidedText(int rows) : rows_(rows) {
  setSizePolicy(QSizePolicy::Ignored, QSizePolicy::Fixed);
  auto* const copy = new QAction("Copy", this);
  connect(copy, &QAction::triggered, this, [this] { QGuiApplication::clipboard()->setText(text_); });
  addAction(copy);
  setContextMenuPolicy(Qt::ActionsContextMenu);
}

void ElidedText::setText(const QString& text) {
  if (text == text_) return;
  text_ = text;
  setToolTip(text.toHtmlEscaped());
  update();
}

QSize ElidedText::sizeHint() const {
  return {1, rows_ * fontMetrics().lineSpacing() + kBelow};
}

void ElidedText::paintEvent(QPaintEvent*) {
  QPainter painter(this);
  drawElided(painter, QRect(0, 0, width(), rows_ * fontMetrics().lineSpacing()), text_);
}

void drawElided(QPainter& painter, const QRect& place, const QString& text) {
  const QFontMetrics metrics = painter.fontMetrics();
  const int rows = place.height() / metrics.lineSpacing();
  QString rest = text;
  rest.replace('\n', ' ');
  QTextLayout layout(rest, painter.font());
  QTextOption option;
  option.setWrapMode(QTextOption::WrapAtWordBoundaryOrAnywhere);
  layout.setTextOption(option);
  layout.beginLayout();
  for (int row = 0; row < rows; ++row) {
    QTextLine line = layout.createLine();
    if (!line.isValid()) break;
    line.setLineWidth(place.width());
    const QPoint corner = place.topLeft() + QPoint(0, row * metrics.lineSpacing());
    if (row + 1 < rows) {
      line.draw(&painter, corner);
    } else {  // the last row has all that is left
      painter.drawText(corner + QPoint(0, metrics.ascent()),
                       metrics.elidedText(rest.mid(line.textStart()), Qt::ElideRight, place.width()));
    }
  }
  layout.endLayout();
}

}  // namespace rbs
