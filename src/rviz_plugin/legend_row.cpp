// SPDX-License-Identifier: BSD-3-Clause
#include "legend_row.h"

#include <QLinearGradient>
#include <QPainter>
#include <QStyleOptionViewItem>

#include <algorithm>

namespace rbs {
namespace {

QColor toQt(const Ogre::ColourValue& color) {
  return QColor::fromRgbF(static_cast<double>(color.r), static_cast<double>(color.g),
                          static_cast<double>(color.b));
}

QBrush scaleBrush(const LegendEntry& entry, const QRect& bar) {
  QLinearGradient gradient(bar.topLeft(), bar.topRight());
  const auto last = static_cast<double>(entry.colors.size() - 1);
  for (std::size_t k = 0; k < entry.colors.size(); ++k)
    gradient.setColorAt(static_cast<double>(k) / last, toQt(entry.colors[k]));
  return gradient;
}

}  // namespace

LegendRow::LegendRow(LegendEntry entry, rviz::Property* parent)
    : rviz::Property(QString::fromStdString(entry.label),
                     entry.is_scale ? QString::fromStdString(entry.low + " to " + entry.high) : QString(),
                     "What this colour stands for.", parent),
      entry_(std::move(entry)) {
  setReadOnly(true);
  setShouldBeSaved(false);
}

// One field for each colour, or the scale with its ends written on it.
bool LegendRow::paint(QPainter* painter, const QStyleOptionViewItem& option) const {
  const QRect bar = option.rect.adjusted(2, 2, -4, -2);
  painter->save();
  painter->setPen(Qt::NoPen);
  if (entry_.is_scale) {
    painter->fillRect(bar, scaleBrush(entry_, bar));
    const QRect text = bar.adjusted(4, 0, -4, 0);
    painter->setPen(Qt::white);
    painter->drawText(text, Qt::AlignLeft | Qt::AlignVCenter, QString::fromStdString(entry_.low));
    painter->setPen(Qt::black);
    painter->drawText(text, Qt::AlignRight | Qt::AlignVCenter, QString::fromStdString(entry_.high));
  } else {
    const int width = std::min(2 * bar.height(), bar.width() / static_cast<int>(entry_.colors.size()));
    for (std::size_t k = 0; k < entry_.colors.size(); ++k)
      painter->fillRect(bar.left() + static_cast<int>(k) * width, bar.top(), width, bar.height(),
                        toQt(entry_.colors[k]));
  }
  painter->restore();
  return true;
}

}  // namespace rbs
