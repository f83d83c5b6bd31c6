// SPDX-License-Identifier: BSD-3-Clause
// PipelineTree: the stages of a step, what each costs as a bar, and why it runs or does not.
#pragma once

#include <rigid_body_sim/StageStatus.h>

#include <QTreeWidget>

#include <vector>

namespace rbs {

/// Parts of a stage are below it. A bar is the share of the step.
class PipelineTree : public QTreeWidget {
  Q_OBJECT
 public:
  PipelineTree();

  void show(const std::vector<rigid_body_sim::StageStatus>& pipeline);

 private:
  void build(const std::vector<rigid_body_sim::StageStatus>& pipeline);

  std::vector<QTreeWidgetItem*> rows_;  ///< as the pipeline
};

}  // namespace rbs
