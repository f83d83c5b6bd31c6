// SPDX-License-Identifier: BSD-3-Clause
// The stages of the pipeline: which of them run, what each costs, and why.
#pragma once

#include <rigid_body_sim/StageStatus.h>

#include <QTreeWidget>

#include <vector>

namespace rbs {

/// A row a stage, in the order of the pipeline. Stages that the scene does not need are grey.
class PipelineTable : public QTreeWidget {
  Q_OBJECT
 public:
  PipelineTable();

  void show(const std::vector<rigid_body_sim::StageStatus>& pipeline);

 private:
  void setRowCount(int count);
};

}  // namespace rbs
