// SPDX-License-Identifier: BSD-3-Clause
#include "simulation_panel.h"

#include "view.h"

#include <rviz/view_manager.h>
#include <rviz/visualization_manager.h>
#include <rviz/window_manager_interface.h>
#include <pluginlib/class_list_macros.hpp>

#include <QHBoxLayout>
#include <QVBoxLayout>

namespace rbs {

SimulationPanel::SimulationPanel()
    : controls_(new QWidget),
      transport_(new TransportBar(simulator_)),
      scenes_(new QComboBox),
      wind_(new QCheckBox("Wind (key 1)")),
      node_(new QLineEdit("sim")),
      message_(new QLabel),
      status_(new StatusView),
      dial_(new DialView(simulator_)),
      pipeline_(new PipelineTable) {
  layOut();
  connectWidgets();
  showHeard(false);
}

SimulationPanel::~SimulationPanel() {
  delete wind_key_;
}

void SimulationPanel::layOut() {
  scenes_->setToolTip("Loads a scene of the catalogue");
  node_->setToolTip("Name of the simulator's node");
  node_->setMaximumWidth(90);
  message_->setWordWrap(true);
  message_->setTextInteractionFlags(Qt::TextSelectableByMouse);
  message_->setAlignment(Qt::AlignLeft | Qt::AlignTop);
  message_->setMinimumHeight(2 * fontMetrics().lineSpacing());  // so that short answers do not move the rest

  auto* choices = new QHBoxLayout;
  choices->addWidget(scenes_, 1);
  choices->addWidget(wind_);
  auto* rows = new QVBoxLayout(controls_);
  rows->setContentsMargins(0, 0, 0, 0);
  rows->setSpacing(4);
  rows->addWidget(transport_);
  rows->addLayout(choices);
  rows->addWidget(status_);
  rows->addWidget(dial_);
  rows->addWidget(pipeline_, 1);

  auto* last_row = new QHBoxLayout;
  last_row->addStretch();
  last_row->addWidget(new QLabel("Node"));
  last_row->addWidget(node_);
  auto* panel = new QVBoxLayout(this);
  panel->setContentsMargins(6, 4, 6, 4);
  panel->setSpacing(4);
  panel->addWidget(controls_, 1);
  panel->addWidget(message_);
  panel->addLayout(last_row);
}

void SimulationPanel::connectWidgets() {
  connect(&simulator_, &SimulatorClient::statusReceived, this, &SimulationPanel::show);
  connect(&simulator_, &SimulatorClient::heardChanged, this, &SimulationPanel::showHeard);
  connect(&simulator_, &SimulatorClient::scenesListed, this, &SimulationPanel::showScenes);
  connect(&simulator_, &SimulatorClient::told, this, &SimulationPanel::tell);
  connect(scenes_, qOverload<int>(&QComboBox::activated), this,
          [this](int index) { simulator_.loadScene(scenes_->itemText(index)); });
  connect(wind_, &QCheckBox::clicked, &simulator_, &SimulatorClient::enableWind);
  connect(node_, &QLineEdit::editingFinished, this, [this] {
    if (node_->text() == simulator_.node()) return;
    follow(node_->text());
    Q_EMIT configChanged();
  });
}

void SimulationPanel::onInitialize() {
  wind_key_ = new QShortcut(Qt::Key_1, vis_manager_->getWindowManager()->getParentWindow());
  wind_key_->setContext(Qt::ApplicationShortcut);
  wind_key_->setAutoRepeat(false);
  connect(wind_key_, &QShortcut::activated, &simulator_, &SimulatorClient::toggleWind);
  follow(node_->text());
}

void SimulationPanel::load(const rviz::Config& config) {
  rviz::Panel::load(config);
  QString node;
  if (config.mapGetString("Node", &node)) follow(node);
  config.mapGetString("Scene", &scene_);
}

void SimulationPanel::save(rviz::Config config) const {
  rviz::Panel::save(config);
  config.mapSetValue("Node", node_->text());
  config.mapSetValue("Scene", scene_);
}

void SimulationPanel::follow(const QString& node) {
  node_->setText(node);
  tell(QString("No simulator is heard at '%1'.").arg(node), true);
  simulator_.follow(node);
}

void SimulationPanel::show(const rigid_body_sim::Status& status) {
  look(status);
  transport_->show(status);
  status_->show(status);
  dial_->show(status);
  pipeline_->show(status.pipeline);
  scenes_->setCurrentIndex(scenes_->findText(QString::fromStdString(status.scene)));
  wind_->setChecked(status.wind);
  for (const std::string& warning : status.warnings) tell(QString::fromStdString(warning), true);
}

void SimulationPanel::look(const rigid_body_sim::Status& status) {
  const QString scene = QString::fromStdString(status.scene);
  if (scene == scene_) return;
  scene_ = scene;
  if (rviz::ViewController* const view = vis_manager_->getViewManager()->getCurrent()) {
    lookFrom(*view, status.view_eye, status.view_target);
  }
}

void SimulationPanel::showHeard(bool is_heard) {
  controls_->setEnabled(is_heard);
  if (is_heard) {
    tell({}, false);
  } else {
    tell(QString("No simulator is heard at '%1'.").arg(simulator_.node()), true);
  }
}

void SimulationPanel::showScenes(const QStringList& names, const QStringList& properties) {
  scenes_->clear();
  for (int i = 0; i < names.size(); ++i) {
    scenes_->addItem(names[i]);
    scenes_->setItemData(i, properties.value(i), Qt::ToolTipRole);
  }
}

void SimulationPanel::tell(const QString& text, bool is_trouble) {
  message_->setText(text);
  message_->setStyleSheet(is_trouble ? "color: #b00020" : "");
}

}  // namespace rbs

PLUGINLIB_EXPORT_CLASS(rbs::SimulationPanel, rviz::Panel)
