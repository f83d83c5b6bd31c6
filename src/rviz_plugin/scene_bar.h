// SPDX-License-Identifier: BSD-3-Clause
// SceneBar: chooses a scene of the catalogue, and opens and saves files.
#pragma once

#include "simulator_client.h"

#include <QComboBox>
#include <QElapsedTimer>
#include <QMenu>
#include <QStringList>
#include <QToolButton>
#include <QWidget>

#include <functional>

namespace rbs {

/// Files are those of the machine on which the simulator runs. Save writes the file that was opened or saved
/// last; the most recent ones are offered again.
class SceneBar : public QWidget {
  Q_OBJECT
 public:
  explicit SceneBar(SimulatorClient& simulator);

  void show(const rigid_body_sim::Status& status);
  /// Files of scenes, and of states with "state:" before their path; the newest first.
  const QStringList& recent() const { return recent_; }
  void setRecent(const QStringList& files) { recent_ = files; }
  /// Save has no file any more.
  void forgetFile();

 Q_SIGNALS:
  void recentChanged();

 private:
  void listScenes(const QStringList& names, const QStringList& properties);
  bool isAnotherScene(const rigid_body_sim::Status& status) const;
  void useScene(const QString& file);
  void useState(const QString& file);
  void keep(const QString& file);
  void fillMenu();
  /// Asks for a file, without holding anything up meanwhile.
  void askFile(const QString& title, bool is_new, void (SimulatorClient::*act)(const QString&));
  void openRecent(const QString& file);
  /// Asks first where that drops edits.
  void load(const QString& name, const std::function<void()>& act);
  void showScene();
  void askSeed();

  SimulatorClient& simulator_;
  QComboBox* scenes_;
  QMenu menu_;
  QString scene_, file_;                 ///< name of the scene; file that holds it, empty: none
  QElapsedTimer since_file_;             ///< since `file_` was loaded or saved
  std::uint64_t world_ = 0, steps_ = 0;  ///< of the last status
  std::string redo_;                     ///< edit that a redo would have made at the last status
  bool is_unsaved_ = false;              ///< no file holds the edits
  QStringList recent_;
};

}  // namespace rbs
