// SPDX-License-Identifier: BSD-3-Clause
#include "step_view.h"

#include "elided_text.h"

#include <QVBoxLayout>

namespace rbs {

StepView::StepView() : tree_(new PipelineTree), explanation_(new ElidedText(3)) {
  auto* rows = new QVBoxLayout(this);
  rows->setContentsMargins(0, 0, 0, 0);
  rows->setSpacing(4);
  rows->addWidget(tree_, 1);
  rows->addWidget(explanation_);
  connect(tree_, &QTreeWidget::itemSelectionChanged, this, &StepView::explain);
}

void StepView::show(const std::vector<rigid_body_sim::StageStatus>& pipeline) {
  tree_->show(pipeline);
  explain();
}

void StepView::explain() {
  explanation_->setText(tree_->explanation());
}

}  // namespace rbs
