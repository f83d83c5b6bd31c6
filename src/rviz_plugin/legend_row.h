// SPDX-License-Identifier: BSD-3-Clause
// LegendRow: a line of a legend in the tree of displays, with its colours painted.
#pragma once

#include "body_colors.h"

#include <rviz/properties/property.h>

namespace rbs {

/// It cannot be edited and is not saved.
class LegendRow : public rviz::Property {
  Q_OBJECT
 public:
  LegendRow(LegendEntry entry, rviz::Property* parent);

  bool paint(QPainter* painter, const QStyleOptionViewItem& option) const override;

 private:
  const LegendEntry entry_;
};

}  // namespace rbs
