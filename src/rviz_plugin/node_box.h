// SPDX-License-Identifier: BSD-3-Clause
// NodeBox: chooses a simulator by the name of its node.
#pragma once

#include <QComboBox>

#include <string>

namespace rbs {

/// The full name of a node, relative to the namespace of RViz unless it begins with '/'; empty for what ROS does not
/// take as a name.
std::string resolvedNode(const QString& node);

/// Any name can be typed, and Enter takes it: a box that loses the focus shows its node again. The list has the simulators
/// that the ROS master knows when it is opened.
class NodeBox : public QComboBox {
  Q_OBJECT
 public:
  NodeBox();

  const QString& node() const { return node_; }
  void setNode(const QString& node);

 Q_SIGNALS:
  void chosen(const QString& node);

 protected:
  void showPopup() override;

 private:
  void choose();

  QString node_;
};

}  // namespace rbs
