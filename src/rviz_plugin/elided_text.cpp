// SPDX-License-Identifier: BSD-3-Clause
#include "elided_text.h"

#include <QAction>
#include <QClipboard>
#include <QGuiApplication>
#include <QPainter>
#include <QTextLayout>

namespace rbs {

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
  return {1, rows_ * fontMetrics().lineSpacing()};
}

void ElidedText::paintEvent(QPaintEvent*) {
  QPainter painter(this);
  const int row_height = fontMetrics().lineSpacing();
  QString rest = text_;
  rest.replace('\n', ' ');
  QTextLayout layout(rest, font());
  QTextOption option;
  option.setWrapMode(QTextOption::WrapAtWordBoundaryOrAnywhere);
  layout.setTextOption(option);
  layout.beginLayout();
  for (int row = 0; row < rows_; ++row) {
    QTextLine line = layout.createLine();
    if (!line.isValid()) break;
    line.setLineWidth(width());
    const QPoint corner(0, row * row_height);
    if (row + 1 < rows_) {
      line.draw(&painter, corner);
    } else {  // the last row has all that is left
      painter.drawText(corner + QPoint(0, fontMetrics().ascent()),
                       fontMetrics().elidedText(rest.mid(line.textStart()), Qt::ElideRight, width()));
    }
  }
  layout.endLayout();
}

}  // namespace rbs
