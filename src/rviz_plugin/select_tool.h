// SPDX-License-Identifier: BSD-3-Clause
// SelectTool: selects bodies by a rectangle in the view.
#pragma once

#include <rviz/tool.h>

#include <QRect>

#include <optional>

namespace rbs {

/// A drag with the left button selects the bodies whose centres are in the rectangle, hidden behind others or
/// not; a click selects the body under the mouse. With Shift they are added to the selection, with Ctrl taken
/// away. The other buttons move the view.
class SelectTool : public rviz::Tool {
  Q_OBJECT
 public:
  SelectTool();

  void onInitialize() override;
  void activate() override {}
  void deactivate() override;
  int processMouseEvent(rviz::ViewportMouseEvent& event) override;

 private:
  void drawRectangle(const rviz::ViewportMouseEvent& event);
  void select(const rviz::ViewportMouseEvent& event);

  std::optional<QRect> rectangle_;  ///< from the press to the mouse, pixels; empty: no drag
};

}  // namespace rbs
