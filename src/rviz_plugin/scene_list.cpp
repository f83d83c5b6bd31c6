// SPDX-License-Identifier: BSD-3-Clause
#include "scene_list.h"

#include "elided_text.h"

#include <ros/package.h>

#include <QAbstractItemView>
#include <QPainter>
#include <QStyledItemDelegate>

namespace rbs {
namespace {

constexpr int kPictureMargin = 4;
const QSize kPicture(96, 60);

class SceneRow : public QStyledItemDelegate {
 public:
  using QStyledItemDelegate::QStyledItemDelegate;

  QSize sizeHint(const QStyleOptionViewItem&, const QModelIndex&) const override {
    constexpr int kTextWidth = 360;
    return {kPicture.width() + 3 * kPictureMargin + kTextWidth, kPicture.height() + 2 * kPictureMargin};
  }

  void paint(QPainter* painter, const QStyleOptionViewItem& option, const QModelIndex& index) const override {
    const bool is_chosen = option.state & QStyle::State_Selected;
    if (is_chosen) painter->fillRect(option.rect, option.palette.highlight());
    const QRect row = option.rect.adjusted(kPictureMargin, kPictureMargin, -kPictureMargin, -kPictureMargin);
    const QRect picture(row.topLeft(), kPicture);
    const QPixmap pixmap = index.data(Qt::UserRole).value<QPixmap>();
    if (!pixmap.isNull()) painter->drawPixmap(picture, pixmap);
    const QRect text = row.adjusted(kPicture.width() + kPictureMargin, 0, 0, 0);
    painter->save();
    painter->setPen(option.palette.color(is_chosen ? QPalette::HighlightedText : QPalette::Text));
    QFont bold = option.font;
    bold.setBold(true);
    painter->setFont(bold);
    const int line = option.fontMetrics.height();
    painter->drawText(text, Qt::AlignTop | Qt::AlignLeft, index.data(Qt::DisplayRole).toString());
    painter->setFont(option.font);
    drawElided(*painter, text.adjusted(0, line + 2, 0, 0), index.data(Qt::ToolTipRole).toString());
    painter->restore();
  }
};

}  // namespace

void showAsSceneList(QComboBox& box) {
  box.setItemDelegate(new SceneRow(&box));
  box.setMaxVisibleItems(8);
  box.view()->setMinimumWidth(box.itemDelegate()->sizeHint({}, {}).width());
}

void fillSceneList(QComboBox& box, const QStringList& names, const QStringList& properties) {
  const QString folder =
      QString::fromStdString(ros::package::getPath("rigid_body_sim")) + "/scenes/pictures/";
  box.clear();
  for (int i = 0; i < names.size(); ++i) {
    box.addItem(names[i]);
    box.setItemData(i, properties.value(i), Qt::ToolTipRole);
    box.setItemData(i, QPixmap(folder + names[i] + ".png"), Qt::UserRole);
  }
}

}  // namespace rbs
