// SPDX-License-Identifier: BSD-3-Clause
#include "simulation_panel.h"

#include "colors.h"
#include "quiet_end.h"
#include "scrolled.h"
#include "shortcuts.h"
#include "stale_markers.h"
#include "view.h"

#include <QAction>
#include <QApplication>
#include <QHBoxLayout>
#include <QLabel>
#include <QVBoxLayout>

#include <rviz/frame_manager.h>
#include <rviz/panel_dock_widget.h>
#include <rviz/render_panel.h>
#include <rviz/view_manager.h>
#include <rviz/visualization_manager.h>
#include <rviz/window_manager_interface.h>
#include <pluginlib/class_list_macros.hpp>

#include <algorithm>
#include <utility>

namespace rbs {
namespace {

constexpr int kReadIn = 10000;  // ms

}  // namespace

SimulationPanel::SimulationPanel()
    : controls_(new QWidget),
      transport_(new TransportBar(simulator_)),
      scenes_(new SceneBar(simulator_)),
      wind_(new QCheckBox("Wind")),
      node_(new NodeBox),
      answer_(new ElidedText(2)),
      status_(new StatusView),
      pages_(new QTabWidget),
      accuracy_(new AccuracyView(simulator_)),
      step_(new StepView),
      effects_(new EffectsView(simulator_)),
      air_(new WindView(simulator_)),
      warnings_(new WarningsView) {
  node_->setNode("sim");
  layOut();
  connectWidgets();
  showHeard(false);
}

SimulationPanel::~SimulationPanel() {
  endQuietly(*this);
  const bool had_keys = hasKeys();
  for (const QPointer<QShortcut>& key : keys_) delete key;
  const QList<SimulationPanel*> all = panels();
  const auto heir = std::find_if(all.begin(), all.end(), [this](const auto* other) { return other != this; });
  if (heir == all.end()) return;
  if (had_keys) (*heir)->takeKeys();
  delete findChild<QAction*>(kShortcutsName, Qt::FindDirectChildrenOnly);
  offerShortcuts(*window_, **heir);
}

void SimulationPanel::layOut() {
  pages_->setDocumentMode(true);
  pages_->addTab(step_, "Step");
  pages_->addTab(scrolled(accuracy_), "Accuracy");
  pages_->addTab(effects_, "Effects");
  pages_->addTab(scrolled(air_), "Wind");
  pages_->addTab(warnings_, "Warnings");

  auto* choices = new QHBoxLayout;
  choices->addWidget(scenes_, 1);
  choices->addWidget(wind_);
  auto* rows = new QVBoxLayout(controls_);
  rows->setContentsMargins(0, 0, 0, 0);
  rows->setSpacing(4);
  rows->addWidget(transport_);
  rows->addLayout(choices);
  rows->addWidget(status_);
  rows->addWidget(pages_, 1);

  auto* last_row = new QHBoxLayout;
  last_row->addStretch();
  last_row->addWidget(new QLabel("Node"));
  last_row->addWidget(node_);
  auto* panel = new QVBoxLayout(this);
  panel->setContentsMargins(6, 4, 6, 4);
  panel->setSpacing(4);
  panel->addWidget(controls_, 1);
  panel->addWidget(transport_->recordingNote());
  panel->addWidget(answer_);
  panel->addLayout(last_row);
}

void SimulationPanel::connectWidgets() {
  read_.setSingleShot(true);
  connect(&read_, &QTimer::timeout, this, [this] { showMessage({}, false); });
  connect(&simulator_, &SimulatorClient::statusReceived, this, &SimulationPanel::show);
  connect(&simulator_, &SimulatorClient::heardChanged, this, &SimulationPanel::showHeard);
  connect(&simulator_, &SimulatorClient::reported, this, &SimulationPanel::showMessage);
  connect(&simulator_, &SimulatorClient::selectionChanged, this, &SimulationPanel::followSelection);
  connect(scenes_, &SceneBar::recentChanged, this, &rviz::Panel::configChanged);
  connect(transport_, &TransportBar::folderChanged, this, &rviz::Panel::configChanged);
  connect(transport_, &TransportBar::recordingChanged, this, &SimulationPanel::enableControls);
  connect(warnings_, &WarningsView::countChanged, this, &SimulationPanel::countWarnings);
  connect(wind_, &QCheckBox::clicked, &simulator_, &SimulatorClient::enableWind);
  connect(node_, &NodeBox::chosen, this, [this](const QString& node) {
    if (node == simulator_.node()) return;
    keeps_view_ = true;
    follow(node);
    Q_EMIT configChanged();
  });
  connect(qApp, &QApplication::focusChanged, this, [this](QWidget*, QWidget* now) {
    if (now && isAncestorOf(now)) takeKeys();
  });
}

void SimulationPanel::onInitialize() {
  shareDock(*this);
  window_ = vis_manager_->getWindowManager()->getParentWindow();
  addKeys();
  offerShortcuts(*window_, *this);
  connect(vis_manager_, &rviz::VisualizationManager::escapePressed, this, [this] { simulator_.select({}); });
  const QList<SimulationPanel*> all = panels();
  const bool is_taken = std::any_of(all.begin(), all.end(), [this](const SimulationPanel* other) {
    return other != this && other->hasKeys();
  });
  setKeys(!is_taken);
  follow(node_->node());
}

void SimulationPanel::addKeys() {
  addKey(Qt::Key_Space, [this] { transport_->playOrPause(); });
  addKey(Qt::Key_Period, [this] { transport_->step(); });
  addKey(Qt::Key_Plus, [this] { transport_->goFaster(); });
  addKey(Qt::Key_Minus, [this] { transport_->goSlower(); });
  addKey(Qt::Key_R, [this] { transport_->record(); });
  addKey(Qt::Key_1, [this] { simulator_.toggleWind(); });
  addKey(Qt::CTRL | Qt::Key_Z, [this] { simulator_.undo(); });
  addKey(Qt::CTRL | Qt::SHIFT | Qt::Key_Z, [this] { simulator_.redo(); });
  addKey(
      Qt::Key_Delete, [this] { deleteSelection(window_); }, vis_manager_->getRenderPanel());
  addKey(
      Qt::Key_Home, [this] { look(); }, vis_manager_->getRenderPanel());
  qApp->installEventFilter(this);
}

// What is typed into an open list or menu is meant for it, which sees it all the same: a list takes Return here.
bool SimulationPanel::eventFilter(QObject*, QEvent* event) {
  if (event->type() == QEvent::ShortcutOverride && QApplication::activePopupWidget()) event->accept();
  return false;
}

void SimulationPanel::addKey(const QKeySequence& keys, const std::function<void()>& act, QWidget* focus) {
  auto* const key = new QShortcut(keys, focus ? focus : window_.data());
  key->setContext(focus ? Qt::WidgetShortcut : Qt::ApplicationShortcut);
  key->setAutoRepeat(false);
  // While nobody answers, edits would wait, and happen all at once; a recording can be ended.
  const bool is_for_record = keys == QKeySequence(Qt::Key_R);
  connect(key, &QShortcut::activated, this, [this, act, is_for_record] {
    if (is_heard_ || is_for_record) act();
  });
  keys_.append(key);
}

void SimulationPanel::load(const rviz::Config& config) {
  rviz::Panel::load(config);
  keeps_view_ = false;
  QString node;
  if (config.mapGetString("Node", &node)) follow(node);
  config.mapGetString("Scene", &scene_);
  QStringList recent;
  const rviz::Config files = config.mapGetChild("Recent");
  for (int i = 0; i < files.listLength(); ++i) recent.append(files.listChildAt(i).getValue().toString());
  scenes_->setRecent(recent);
  QString folder;
  if (config.mapGetString("Recordings", &folder) && !folder.isEmpty()) transport_->setFolder(folder);
  int page = 0;
  if (config.mapGetInt("Page", &page)) pages_->setCurrentIndex(page);
}

void SimulationPanel::save(rviz::Config config) const {
  rviz::Panel::save(config);
  config.mapSetValue("Node", node_->node());
  config.mapSetValue("Scene", scene_);
  config.mapSetValue("Page", pages_->currentIndex());
  config.mapSetValue("Recordings", transport_->folder());
  rviz::Config recent = config.mapMakeChild("Recent");
  for (const QString& file : scenes_->recent()) recent.listAppendNew().setValue(file);
}

void SimulationPanel::follow(const QString& node) {
  node_->setNode(node);
  is_heard_ = false;
  showMessage({}, true);
  scenes_->forgetFile();
  effects_->forgetNeglected();
  warnings_->clear();
  simulator_.follow(node);
}

void SimulationPanel::show(const rigid_body_sim::Status& status) {
  look(status);
  transport_->show(status);
  status_->show(status);
  accuracy_->show(status);
  step_->show(status.pipeline);
  effects_->show(status);
  warnings_->show(status);
  scenes_->show(status);
  wind_->setChecked(status.wind);
  is_unsaved_ = status.unsaved;
  showTitle();
  const bool is_replay = !status.recording.empty();
  if (is_replay && !is_replay_) dropMarkersOf(resolvedNode(simulator_.node()), *vis_manager_);
  is_replay_ = is_replay;
  enableEdits(!is_replay);
}

void SimulationPanel::showTitle() {
  if (auto* const dock = qobject_cast<rviz::PanelDockWidget*>(parentWidget()))
    dock->setWindowTitle(getName() + (is_unsaved_ ? " *" : "") +
                         (transport_->isRecording() ? " ● recording" : ""));
}

void SimulationPanel::countWarnings(int count) {
  const int page = pages_->indexOf(warnings_);
  const QString counted = count == 1 ? "1 warning" : QString("%1 warnings").arg(count);
  pages_->setTabText(page, count == 0 ? "Warnings" : counted);
}

void SimulationPanel::look(const rigid_body_sim::Status& status) {
  frame_ = status.header.frame_id;
  eye_ = status.view_eye;
  target_ = status.view_target;
  const QString scene = QString::fromStdString(status.scene);
  const bool keeps_view = !scene.isEmpty() && std::exchange(keeps_view_, false);
  if (scene == scene_) return;
  scene_ = scene;
  if (!keeps_view) look();
}

// As the scene asks, in the fixed frame: the worlds of two simulators may stand beside each other.
void SimulationPanel::look() {
  rviz::ViewController* const view = vis_manager_->getViewManager()->getCurrent();
  if (!view) return;
  const auto inFixedFrame = [this](const geometry_msgs::Point& point) {
    geometry_msgs::Pose pose;
    pose.position = point;
    pose.orientation.w = 1.0;
    Ogre::Vector3 place;
    Ogre::Quaternion turn;
    const bool is_known =
        !frame_.empty() && vis_manager_->getFrameManager()->transform(frame_, ros::Time(), pose, place, turn);
    if (!is_known) return point;
    geometry_msgs::Point there;
    there.x = place.x, there.y = place.y, there.z = place.z;
    return there;
  };
  lookFrom(*view, inFixedFrame(eye_), inFixedFrame(target_));
}

void SimulationPanel::showHeard(bool is_heard) {
  is_heard_ = is_heard;
  is_unsaved_ = is_unsaved_ && is_heard;
  transport_->setHeard(is_heard);
  enableControls();
  if (!is_heard) {  // who answers next may be another simulator of this name
    scenes_->forgetFile();
    warnings_->clear();
    is_replay_ = false;
    if (window_) dropMarkersOf(resolvedNode(simulator_.node()), *vis_manager_);
  }
  showMessage({}, false);
}

// A recording can be ended also when nothing is heard any more, and is seen when another page covers this one.
void SimulationPanel::enableControls() {
  const bool is_recording = transport_->isRecording();
  controls_->setEnabled(is_heard_ || is_recording);
  for (QWidget* const widget : std::initializer_list<QWidget*>{status_, pages_})
    widget->setEnabled(is_heard_);
  if (!is_heard_) enableEdits(false);  // the next status enables what it allows
  showTitle();
}

// Nothing but the time of a replay can be steered.
void SimulationPanel::enableEdits(bool is_live) {
  for (QWidget* const widget : std::initializer_list<QWidget*>{scenes_, wind_, accuracy_, effects_, air_})
    widget->setEnabled(is_live);
}

// While nothing is heard, that is what there is to say. What is no trouble is over after a while.
void SimulationPanel::showMessage(const QString& text, bool is_trouble) {
  answer_->setText(is_heard_ ? text : QString("No simulator answers at '%1'.").arg(node_->node()));
  showTrouble(*answer_, is_trouble || !is_heard_);
  if (is_trouble || !is_heard_)
    read_.stop();
  else
    read_.start(kReadIn);
}

QList<SimulationPanel*> SimulationPanel::panels() const {
  return window_ ? window_->findChildren<SimulationPanel*>() : QList<SimulationPanel*>();
}

// The keys are those of the window: were two panels to listen to one, Qt would hand it to neither.
void SimulationPanel::takeKeys() {
  for (SimulationPanel* const panel : panels()) panel->setKeys(panel == this);
}

void SimulationPanel::setKeys(bool has_keys) {
  for (const QPointer<QShortcut>& key : keys_)
    if (key) key->setEnabled(has_keys);
  wind_->setText(has_keys ? "Wind (key 1)" : "Wind");
}

void SimulationPanel::followSelection(const QStringList& bodies) {
  if (bodies.isEmpty()) return;
  takeKeys();
  for (SimulationPanel* const other : panels()) {
    const bool is_elsewhere = resolvedNode(other->simulator_.node()) != resolvedNode(simulator_.node());
    if (is_elsewhere && !other->simulator_.selection().isEmpty()) other->simulator_.select({});
  }
}

std::vector<std::string> SimulationPanel::nodes(QWidget* window) {
  std::vector<std::string> names;
  for (const SimulationPanel* const panel : window->findChildren<SimulationPanel*>())
    if (const std::string name = resolvedNode(panel->simulator_.node()); !name.empty()) names.push_back(name);
  return names;
}

void SimulationPanel::select(QWidget* window, const std::string& node, const QStringList& bodies,
                             Qt::KeyboardModifiers keys) {
  for (SimulationPanel* const panel : window->findChildren<SimulationPanel*>())
    if (resolvedNode(panel->simulator_.node()) == node) return panel->simulator_.select(bodies, keys);
}

void SimulationPanel::toggleSelected(QWidget* window, const std::string& node, const QString& body) {
  for (SimulationPanel* const panel : window->findChildren<SimulationPanel*>())
    if (resolvedNode(panel->simulator_.node()) == node) return panel->simulator_.toggleSelected(body);
}

void SimulationPanel::spawn(QWidget* window, const rigid_body_sim::SpawnBody::Request& body) {
  for (SimulationPanel* const panel : window->findChildren<SimulationPanel*>())
    if (panel->hasKeys()) return panel->simulator_.spawn(body);
}

void SimulationPanel::deleteSelection(QWidget* window) {
  const QList<SimulationPanel*> panels = window->findChildren<SimulationPanel*>();
  const auto it = std::find_if(panels.begin(), panels.end(), [](const SimulationPanel* panel) {
    return !panel->simulator_.selection().isEmpty();
  });
  if (it != panels.end()) return (*it)->simulator_.deleteSelection();
  for (SimulationPanel* const panel : panels)
    panel->showMessage("No body is selected, so none is deleted.", false);
}

void SimulationPanel::dropSelections(QWidget* window, const QString& why) {
  for (SimulationPanel* const panel : window->findChildren<SimulationPanel*>()) {
    if (!panel->simulator_.selection().isEmpty()) panel->simulator_.select({});
    panel->showMessage(why, false);
  }
}

}  // namespace rbs

PLUGINLIB_EXPORT_CLASS(rbs::SimulationPanel, rviz::Panel)
