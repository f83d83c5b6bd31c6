// SPDX-License-Identifier: BSD-3-Clause
#include "node_box.h"

#include "wheel_guard.h"

#include <rigid_body_sim/Status.h>
#include <ros/master.h>
#include <ros/names.h>

#include <QLineEdit>

namespace rbs {

std::string resolvedNode(const QString& node) {
  const std::string name = node.toStdString();
  std::string error;
  return !name.empty() && ros::names::validate(name, error) ? ros::names::resolve(name) : std::string();
}

NodeBox::NodeBox() {
  guardFromWheel(*this);
  setEditable(true);
  setInsertPolicy(QComboBox::NoInsert);
  setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
  setMinimumContentsLength(8);
  setToolTip("The simulator that this panel steers: the name of its node");
  connect(lineEdit(), &QLineEdit::returnPressed, this, &NodeBox::choose);
  connect(lineEdit(), &QLineEdit::editingFinished, this, [this] { setEditText(node_); });
  connect(this, qOverload<int>(&QComboBox::activated), this, &NodeBox::choose);
}

void NodeBox::setNode(const QString& node) {
  node_ = node;
  setEditText(node);
}

void NodeBox::choose() {
  const QString node = currentText().trimmed();
  if (node == node_) return;
  setNode(node);
  Q_EMIT chosen(node);
}

// Who publishes a status of this type is a simulator. Without a master getTopics() would wait for one.
void NodeBox::showPopup() {
  const QString before = currentText();
  ros::master::V_TopicInfo topics;
  if (ros::master::check()) ros::master::getTopics(topics);
  clear();
  for (const ros::master::TopicInfo& topic : topics) {
    const QString name = QString::fromStdString(topic.name);
    if (topic.datatype == ros::message_traits::datatype<rigid_body_sim::Status>() && name.endsWith("/status"))
      addItem(name.left(name.lastIndexOf('/')));
  }
  setEditText(before);
  QComboBox::showPopup();
}

}  // namespace rbs
