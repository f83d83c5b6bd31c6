// SPDX-License-Identifier: BSD-3-Clause
// WarningsView: the warnings of a simulation, each with when it came last and how often.
#pragma once

#include <rigid_body_sim/Status.h>

#include <QToolButton>
#include <QTreeWidget>
#include <QWidget>

#include <cstdint>

namespace rbs {

/// The newest is on top. A warning that comes again moves up and is counted. Those of another world go: a scene that is loaded,
/// reset or undone has its own time and bodies.
class WarningsView : public QWidget {
  Q_OBJECT
 public:
  WarningsView();

  void show(const rigid_body_sim::Status& status);
  void clear();
  int count() const { return list_->topLevelItemCount(); }

 Q_SIGNALS:
  void countChanged(int count);

 private:
  void add(const QString& text, double time);

  QTreeWidget* list_;
  std::uint64_t world_ = 0;  ///< Status::world
};

}  // namespace rbs
