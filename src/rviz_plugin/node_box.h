// SPDX-License-Identifier: BSD-3-Clause
// NodeBox: chooses a simulator by the name of its node.
#pragma once

#include <QComboBox>

#include <string>

namespace rbs {

/// The full name of a node, relative to the namespace of RViz unless it begins with '/'; empty for what ROS does not
/// take as a name.
std::string resolvedNode(const QString& node);

/// Any name can be typed; the list has the simulators that the ROS master knows when it is opened.
class NodeBox : public QComboBox {
  Q_OBJECT
 public:
  NodeBox();

  QString node() const { return currentText().trimmed(); }
  void setNode(const QString& node) { setEditText(node); }

 Q_SIGNALS:
  void chosen(const QString& node);

 protected:
  void showPopup() override;
};

}  // namespace rbs
