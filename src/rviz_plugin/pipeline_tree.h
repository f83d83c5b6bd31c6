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
  /// What the selected stage costs and why it runs or does not, as its row is too narrow to say. Where none is selected, it is
  /// the stage without parts that costs the most. Empty before the first show().
  QString explanation() const;

 private:
  void build(const std::vector<rigid_body_sim::StageStatus>& pipeline);
  const QTreeWidgetItem* costliest() const;  ///< of those without parts; null: there is none

  std::vector<QTreeWidgetItem*> rows_;  ///< as the pipeline
};

}  // namespace rbs
