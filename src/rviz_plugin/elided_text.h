// SPDX-License-Identifier: BSD-3-Clause
// ElidedText: text of any length in a place of a fixed height.
#pragma once

#include <QPainter>
#include <QString>
#include <QWidget>

namespace rbs {

/// Wraps a text into the rows that a place has room for, and ends it in an ellipsis where there is more than fits. Breaks are between words, or within one that is longer than a row.
void drawElided(QPainter& painter, const QRect& place, const QString& text);

/// Wraps between words, or within one that is longer than a row, and ends in an ellipsis where there is more
/// than fits; the tool tip has all of it, and a right click copies it. Its text never changes the size of the
/// widget.
class ElidedText : public QWidget {
  Q_OBJECT
 public:
  explicit ElidedText(int rows);

  void setText(const QString& text);
  const QString& text() const { return text_; }
  QSize sizeHint() const override;
  QSize minimumSizeHint() const override { return sizeHint(); }

 protected:
  void paintEvent(QPaintEvent* event) override;

 private:
  const int rows_;
  QString text_;
};

}  // namespace rbs
