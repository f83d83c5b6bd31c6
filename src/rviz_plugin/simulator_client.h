// SPDX-License-Identifier: BSD-3-Clause
// SimulatorClient: the topics and services of one simulator, as the panel uses them.
#pragma once

#include "hearing.h"
#include "service_worker.h"

#include <rigid_body_sim/AccuracyStudy.h>
#include <rigid_body_sim/BodyNames.h>
#include <rigid_body_sim/SettingCost.h>
#include <rigid_body_sim/SpawnBody.h>
#include <rigid_body_sim/Status.h>
#include <rigid_body_sim/Wind.h>
#include <ros/ros.h>
#include <std_msgs/String.h>

#include <QObject>
#include <QString>
#include <QStringList>
#include <QTimer>

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace rbs {

/// Follows one node. It may start, die and come back at any time. Lives on the GUI thread, where RViz also
/// handles the messages of subscribers.
class SimulatorClient : public QObject {
  Q_OBJECT
 public:
  SimulatorClient();

  /// Follows the node of this name, relative to the namespace of RViz unless it begins with '/'. A name
  /// that ROS does not take is reported by reported() and no simulator is followed then.
  void follow(const QString& node);
  const QString& node() const { return node_; }

  void resume();
  void pause();
  void step(int steps);
  void reset();
  void undo();
  void redo();
  /// Of a replay: goes to a time, s from the start of the recording. Of many calls, those are left out that are
  /// overtaken by a later one.
  void seek(double time);
  bool isSeeking() const { return is_seeking_; }  ///< whether an answer to seek() is outstanding
  void setSpeed(double factor);                   ///< times real time; 0 is as fast as possible
  /// By its name in the catalogue, or the path of its file.
  void loadScene(const QString& name);
  void loadSceneWithSeed(const QString& name, std::uint64_t seed);
  void loadState(const QString& file);
  /// Writes the scene, or the whole state, to a file. A file that exists is replaced.
  void saveScene(const QString& file);
  void saveState(const QString& file);
  /// Sets the velocity of the air, m/s, and the standard deviation of its gusts, m/s, and switches the wind on.
  void setWind(const geometry_msgs::Vector3& velocity, double gust);
  /// `mode` is "auto", "on" or "off".
  void forceEffect(const QString& effect, const QString& mode);
  void enableWind(bool on);
  void toggleWind() { enableWind(!wind_); }
  void setFidelity(const QString& preset);
  void tuneFidelity(const rigid_body_sim::SettingCost& setting);
  void measureAccuracy();
  void estimateError(bool on);
  void showGhost(bool on);
  void select(const QStringList& bodies);
  /// With Shift they are added to the selection, with Ctrl taken away.
  void select(const QStringList& bodies, Qt::KeyboardModifiers keys);
  /// Adds a body to the selection, or takes it away.
  void toggleSelected(const QString& body);
  void deleteSelection();
  void spawn(const rigid_body_sim::SpawnBody::Request& body);
  const QStringList& selection() const { return selection_; }  ///< names of the selected bodies

 Q_SIGNALS:
  void statusReceived(const rigid_body_sim::Status& status);
  void windReceived(const rigid_body_sim::Wind& wind);
  /// What is neglected by forcing an effect off, in words.
  void effectNeglected(const QString& effect, const QString& error);
  /// A scene was loaded from this file or saved to it; empty: it is one of the catalogue.
  void sceneFileUsed(const QString& file);
  /// The same of a state.
  void stateFileUsed(const QString& file);
  void studyReceived(const rigid_body_sim::AccuracyStudy& study);
  void heardChanged(bool is_heard);
  void selectionChanged(const QStringList& bodies);
  /// The catalogue of the node: names, and what each scene shows.
  void scenesListed(const QStringList& names, const QStringList& properties);
  /// A sentence for the user: an answer, a refusal, or that there is no answer.
  void reported(const QString& text, bool is_trouble);

 private:
  void receive(const rigid_body_sim::Status& status);
  void receiveWind(const rigid_body_sim::Wind& wind) { Q_EMIT windReceived(wind); }
  void receiveStudy(const rigid_body_sim::AccuracyStudy& study);
  void receiveSelection(const rigid_body_sim::BodyNames& bodies);
  void receiveAnswer(const std_msgs::String& text);
  void watch();
  void takeHeard(bool is_heard);
  void listScenes();
  void reportAnswer(const QString& service, bool success, const QString& message);
  template <class Service>
  void call(const char* service, const typename Service::Request& request);
  void callFile(const char* service, const QString& file, void (SimulatorClient::*used)(const QString&));
  void callSwitch(const char* service, bool on);
  std::string inNode(const char* name) const;

  // Made anew for each node: what hangs in a call to the last one must not hold up the next.
  std::unique_ptr<ServiceWorker> worker_;
  std::unique_ptr<ServiceWorker>
      stepper_;  ///< its call lasts as long as the steps, and may be ended by another
  ros::NodeHandle ros_;
  std::vector<ros::Subscriber> subscribers_;
  ros::Publisher select_;
  QString node_;
  QStringList selection_;
  QTimer watchdog_;
  Hearing hearing_;
  bool wind_ = false;
  bool is_replay_ = false;
  bool is_seeking_ = false;
  std::optional<std::uint32_t> running_study_;  ///< its job
  std::optional<double> next_seek_;             ///< the time that is asked for meanwhile, s
};

}  // namespace rbs
