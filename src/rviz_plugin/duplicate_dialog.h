// SPDX-License-Identifier: BSD-3-Clause
// DuplicateDialog: asks how many copies of the selected bodies are wanted, and how far apart.
#pragma once

#include "number_box.h"

#include <geometry_msgs/Vector3.h>

#include <QDialog>

#include <array>

namespace rbs {

class DuplicateDialog : public QDialog {
  Q_OBJECT
 public:
  DuplicateDialog(int bodies, QWidget* parent);

  unsigned count() const { return static_cast<unsigned>(count_->value()); }
  /// Not where a number that was typed is refused.
  void accept() override;
  /// Of each copy from the one before it, in the world, m; zero: above the originals.
  geometry_msgs::Vector3 offset() const;

 private:
  NumberBox* count_;
  std::array<NumberBox*, 3> offset_;
};

}  // namespace rbs
