// SPDX-License-Identifier: BSD-3-Clause
#include "effects_view.h"

#include "rigid_body_sim/effect.h"
#include "wheel_guard.h"

#include <QAbstractItemView>
#include <QHeaderView>
#include <QSignalBlocker>

#include <algorithm>
#include <iterator>

namespace rbs {
namespace {

enum EffectColumn { kEffect, kSwitch, kEffectMilliseconds, kEffectReason, kEffectColumns };
const QStringList kModes = {"auto", "on", "off"};

/// An effect that can be switched, and the stage of the step that simulates it.
struct SwitchedEffect {
  const char *effect, *stage, *tip;
};
constexpr SwitchedEffect kSwitched[] = {
    {"gravity", "forces.gravity", "The weight of the bodies"},
    {"buoyancy", "forces.buoyancy", "The weight of the fluid that bodies displace"},
    {"drag", "forces.drag", "The resistance of air or fluid"},
    {"collision", "broadphase.pairs", "Bodies cannot pass through each other"},
    {"impacts", "impacts.predict", "Impacts are located within the step (continuous collision detection)"},
    {"friction", "contacts.friction", "Coulomb friction"},
    {"rolling", "contacts.rolling", "Rolling and torsional resistance"},
    {"restitution", "contacts.restitution", "Rebound"},
    {"gyroscopic", "rotation.gyroscopic", "The spin axis of an uneven body wanders"},
    {"rotation", "rotation.integrate", "Bodies rotate"},
    {"sleeping", "sleep.update", "What has been at rest for 0.5 s is left out of the step"}};
static_assert(std::size(kSwitched) == kEffects.size());

}  // namespace

EffectsView::EffectsView(SimulatorClient& simulator) : simulator_(simulator) {
  setColumnCount(kEffectColumns);
  setHeaderLabels({"Effect", "Switch", "ms", "Why"});
  setRootIsDecorated(false);
  setSelectionMode(QAbstractItemView::NoSelection);
  setFocusPolicy(Qt::NoFocus);
  header()->setStretchLastSection(true);
  for (const int column : {kEffect, kSwitch, kEffectMilliseconds})
    header()->setSectionResizeMode(column, QHeaderView::ResizeToContents);
  for (const SwitchedEffect& row : kSwitched) {
    addRow(row.effect);
    rows_[row.effect]->setToolTip(kEffect, row.tip);
  }
  connect(&simulator_, &SimulatorClient::effectNeglected, this, &EffectsView::keepNeglected);
}

void EffectsView::addRow(const QString& effect) {
  auto* const row = new QTreeWidgetItem(this, {effect});
  auto* const mode = new QComboBox;
  mode->addItems(kModes);
  mode->setAccessibleName(effect);
  mode->setToolTip("auto: simulated where the scene needs it; on, off: always, never");
  guardFromWheel(*mode);
  setItemWidget(row, kSwitch, mode);
  connect(mode, qOverload<int>(&QComboBox::activated), this,
          [this, effect, mode] { simulator_.forceEffect(effect, mode->currentText()); });
  rows_[effect] = row;
  switches_[effect] = mode;
}

void EffectsView::keepNeglected(const QString& effect, const QString& error) {
  neglected_[effect] = error;
}

void EffectsView::show(const rigid_body_sim::Status& status) {
  const auto isIn = [](const std::vector<std::string>& list, const char* name) {
    return std::find(list.begin(), list.end(), name) != list.end();
  };
  for (const SwitchedEffect& known : kSwitched) {
    const auto stage =
        std::find_if(status.pipeline.begin(), status.pipeline.end(),
                     [&](const rigid_body_sim::StageStatus& stage) { return stage.name == known.stage; });
    if (stage == status.pipeline.end()) continue;
    const bool is_off = isIn(status.forced_off, known.effect);
    QComboBox* const mode = switches_[known.effect];
    if (!mode->view()->isVisible()) {
      const QSignalBlocker quiet(mode);
      mode->setCurrentText(is_off ? "off" : isIn(status.forced_on, known.effect) ? "on" : "auto");
    }
    if (!is_off && off_.remove(known.effect))
      neglected_.remove(known.effect);  // the status may be an older one
    if (is_off) off_.insert(known.effect);
    QString reason = QString::fromStdString(stage->reason);
    if (neglected_.contains(known.effect)) reason = neglected_[known.effect];
    QTreeWidgetItem& row = *rows_[known.effect];
    row.setText(kEffectMilliseconds, stage->active && stage->seconds > 0.0
                                         ? QString::number(1e3 * stage->seconds, 'f', 3)
                                     : stage->active ? QString("on")
                                                     : QString("–"));
    row.setTextAlignment(kEffectMilliseconds, Qt::AlignRight | Qt::AlignVCenter);
    row.setText(kEffectReason, reason);
    row.setToolTip(kEffectReason, reason);
    const QBrush brush =
        palette().brush(stage->active ? QPalette::Active : QPalette::Disabled, QPalette::Text);
    for (int column = 0; column < kEffectColumns; ++column) row.setForeground(column, brush);
  }
}

}  // namespace rbs
