// SPDX-License-Identifier: BSD-3-Clause
// StepView: the stages of a step, and below them one of these in full.
#pragma once

#include "pipeline_tree.h"

#include <QWidget>

#include <vector>

namespace rbs {

class ElidedText;

/// A click on a stage explains it; until then it is the one that costs the most.
class StepView : public QWidget {
  Q_OBJECT
 public:
  StepView();

  void show(const std::vector<rigid_body_sim::StageStatus>& pipeline);

 private:
  void explain();

  PipelineTree* const tree_;
  ElidedText* const explanation_;
};

}  // namespace rbs
