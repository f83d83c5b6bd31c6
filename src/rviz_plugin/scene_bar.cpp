// SPDX-License-Identifier: BSD-3-Clause
#include "scene_bar.h"

#include "drop_edits.h"
#include "hinted_box.h"
#include "scene_list.h"
#include "wheel_guard.h"

#include <QDir>
#include <QFileDialog>
#include <QFileInfo>
#include <QHBoxLayout>
#include <QInputDialog>

namespace rbs {
namespace {

constexpr int kMostRecent = 8;
constexpr int kSettling = 1000;  // ms from the answer to a load until every status is of its world
const QString kState = "state:";

// A recent file as people read it.
QString nameOf(const QString& recent) {
  return recent.startsWith(kState) ? recent.mid(kState.size()) + " (state)" : recent;
}

}  // namespace

SceneBar::SceneBar(SimulatorClient& simulator) : simulator_(simulator), scenes_(new HintedBox) {
  scenes_->setToolTip("Loads a scene of the catalogue");
  scenes_->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
  guardFromWheel(*scenes_);
  showAsSceneList(*scenes_);
  auto* const files = new QToolButton;
  files->setText("File");
  files->setToolTip("Opens and saves scenes and states");
  files->setMenu(&menu_);
  files->setPopupMode(QToolButton::InstantPopup);
  auto* const row = new QHBoxLayout(this);
  row->setContentsMargins(0, 0, 0, 0);
  row->setSpacing(4);
  row->addWidget(scenes_, 1);
  row->addWidget(files);

  connect(scenes_, qOverload<int>(&QComboBox::activated), this, [this](int index) {
    const QString name = scenes_->itemText(index);
    load(name, [this, name] { simulator_.loadScene(name); });
  });
  connect(&menu_, &QMenu::aboutToShow, this, &SceneBar::fillMenu);
  connect(&simulator_, &SimulatorClient::scenesListed, this, &SceneBar::listScenes);
  connect(&simulator_, &SimulatorClient::sceneFileUsed, this, &SceneBar::useScene);
  connect(&simulator_, &SimulatorClient::stateFileUsed, this, &SceneBar::useState);
}

void SceneBar::listScenes(const QStringList& names, const QStringList& properties) {
  fillSceneList(*scenes_, names, properties);
}

// By a load, an undo or redo of one, or a simulator that was started anew. An undo of another edit makes a new
// world of the same scene.
bool SceneBar::isAnotherScene(const rigid_body_sim::Status& status) const {
  const auto isLoad = [](const std::string& edit) { return edit.compare(0, 7, "loaded ") == 0; };
  if (status.world <= world_) return status.world < world_ || status.steps < steps_;
  const bool has_loaded = isLoad(status.undo) && (status.redo.empty() || isLoad(redo_));
  return QString::fromStdString(status.scene) != scene_ || isLoad(status.redo) || has_loaded;
}

// What is not in our file, Save would write over it. A status that was on its way while the file was loaded tells
// of the scene before.
void SceneBar::show(const rigid_body_sim::Status& status) {
  const QString scene = QString::fromStdString(status.scene);
  const bool is_fresh = !file_.isEmpty() && since_file_.elapsed() < kSettling;
  const bool is_undone = status.redo.compare(0, 7, "loaded ") == 0 && redo_.compare(0, 7, "loaded ") != 0;
  if (is_fresh ? is_undone : isAnotherScene(status)) file_.clear();
  world_ = status.world;
  steps_ = status.steps;
  redo_ = status.redo;
  scene_ = scene;
  const bool is_replay = !status.recording.empty();  // which has no catalogue
  if (is_replay && scenes_->findText(scene) < 0) scenes_->addItem(scene);
  is_unsaved_ = status.unsaved && !is_replay;
  showScene();
}

// A file by its own name, which people look for: the name of the scene in it may be another one, or of the catalogue.
void SceneBar::showScene() {
  const QString name = file_.isEmpty() ? scene_ : QFileInfo(file_).fileName();
  scenes_->setPlaceholderText(name);  // of what is not in the catalogue
  scenes_->setCurrentIndex(file_.isEmpty() ? scenes_->findText(scene_) : -1);
}

void SceneBar::load(const QString& name, const std::function<void()>& act) {
  if (!is_unsaved_) return act();
  askToDropEdits(
      *this, "Load", QString("Load '%1'?").arg(name), QMessageBox::Open,
      [this, act] { isEnabled() ? act() : showScene(); }, [this] { showScene(); });
}

void SceneBar::forgetFile() {
  file_.clear();
  showScene();
}

void SceneBar::useScene(const QString& file) {
  file_ = file;
  since_file_.start();
  showScene();
  if (!file.isEmpty()) keep(file);
}

// Save would write a scene over the state.
void SceneBar::useState(const QString& file) {
  forgetFile();
  keep(kState + file);
}

void SceneBar::keep(const QString& file) {
  recent_.removeAll(file);
  recent_.prepend(file);
  while (recent_.size() > kMostRecent) recent_.removeLast();
  Q_EMIT recentChanged();
}

void SceneBar::openRecent(const QString& file) {
  load(nameOf(file), [this, file] {
    file.startsWith(kState) ? simulator_.loadState(file.mid(kState.size())) : simulator_.loadScene(file);
  });
}

void SceneBar::fillMenu() {
  menu_.clear();
  menu_.addAction("Open scene…", this, [this] { askFile("Open scene", false, &SimulatorClient::loadScene); });
  menu_.addAction("Open state…", this, [this] { askFile("Open state", false, &SimulatorClient::loadState); });
  QMenu* const recent = menu_.addMenu("Recent");
  recent->setEnabled(!recent_.isEmpty());
  for (const QString& file : recent_)
    recent->addAction(nameOf(file), this, [this, file] { openRecent(file); });
  menu_.addAction("Load again with a seed…", this, &SceneBar::askSeed)->setEnabled(!scene_.isEmpty());
  menu_.addSeparator();
  const QString save = file_.isEmpty() ? "Save scene" : "Save scene to " + QFileInfo(file_).fileName();
  menu_.addAction(save, this, [this] { simulator_.saveScene(file_); })->setEnabled(!file_.isEmpty());
  menu_.addAction("Save scene as…", this,
                  [this] { askFile("Save scene", true, &SimulatorClient::saveScene); });
  menu_.addAction("Save state as…", this,
                  [this] { askFile("Save state", true, &SimulatorClient::saveState); });
}

void SceneBar::askFile(const QString& title, bool is_new, void (SimulatorClient::*act)(const QString&)) {
  const QString folder =
      recent_.isEmpty() ? QDir::homePath() : QFileInfo(QString(recent_[0]).remove(kState)).path();
  auto* const dialog = new QFileDialog(this, title, folder, "Scenes (*.yaml *.yml)");
  dialog->setAttribute(Qt::WA_DeleteOnClose);
  dialog->setAcceptMode(is_new ? QFileDialog::AcceptSave : QFileDialog::AcceptOpen);
  dialog->setFileMode(QFileDialog::AnyFile);
  dialog->setDefaultSuffix("yaml");
  const auto use = [this, is_new, act](const QString& file) {
    const auto send = [this, act, file] { (simulator_.*act)(file); };
    is_new ? send() : load(QFileInfo(file).fileName(), send);
  };
  connect(dialog, &QFileDialog::fileSelected, this, use, Qt::QueuedConnection);  // once this dialog is gone
  dialog->open();
}

void SceneBar::askSeed() {
  auto* const dialog = new QInputDialog(this);
  dialog->setAttribute(Qt::WA_DeleteOnClose);
  dialog->setWindowTitle("Seed");
  dialog->setLabelText(QString("Seed of '%1', 0 to 18446744073709551615:").arg(scene_));
  connect(dialog, &QInputDialog::textValueSelected, this, [this](const QString& text) {
    bool is_number = false;
    const qulonglong seed = text.trimmed().toULongLong(&is_number);
    const QString scene = file_.isEmpty() ? scene_ : file_;
    if (is_number) {
      load(scene_, [this, scene, seed] { simulator_.loadSceneWithSeed(scene, seed); });
    } else {
      Q_EMIT simulator_.reported(
          QString("'%1' is no seed: a whole number from 0 to 18446744073709551615").arg(text.left(64)), true);
    }
  });
  dialog->open();
}

}  // namespace rbs
