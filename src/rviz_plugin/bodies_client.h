// SPDX-License-Identifier: BSD-3-Clause
// BodiesClient: the bodies of one simulator, those that are selected, and the services that change them.
#pragma once

#include "hearing.h"
#include "service_worker.h"

#include <rigid_body_sim/BodyChange.h>
#include <rigid_body_sim/BodyDescriptions.h>
#include <rigid_body_sim/BodyNames.h>
#include <rigid_body_sim/BodyStates.h>
#include <rigid_body_sim/Status.h>
#include <ros/ros.h>

#include <QHash>
#include <QObject>
#include <QString>
#include <QStringList>
#include <QTimer>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

namespace rbs {

/// Pose and velocity of a body, in the frame of the world.
struct BodyMotion {
  geometry_msgs::Pose pose;    ///< of the centre of mass and the principal axes, m
  geometry_msgs::Twist twist;  ///< at the centre of mass, along the axes of the world, m/s and rad/s
};

/// Lives on the GUI thread, where RViz also handles the messages of subscribers.
class BodiesClient : public QObject {
  Q_OBJECT
 public:
  BodiesClient();

  /// Follows the node of this name, relative to the namespace of RViz unless it begins with '/'. A name that
  /// ROS does not take is reported, and no simulator is followed then.
  void follow(const QString& node);
  const QString& node() const { return node_; }

  /// In the order of their creation; empty until the simulator is heard.
  const std::vector<rigid_body_sim::BodyDescription>& bodies() const { return descriptions_.bodies; }
  /// Where in bodies() the one of this name is; empty where there is none.
  std::optional<std::size_t> find(const QString& name) const;
  /// The name of their scene. Bodies of two scenes have the same ids.
  const std::string& scene() const { return descriptions_.scene; }
  /// The frame of the world.
  const std::string& frame() const { return descriptions_.header.frame_id; }
  /// The last state of bodies()[index]; empty where none of these bodies has come yet.
  std::optional<BodyMotion> motion(std::size_t index) const;
  /// Names in the order in which they were selected.
  const QStringList& selection() const { return selection_; }
  bool isHeard() const { return hearing_.isHeard(); }
  /// That no simulator answers, in words.
  QString silence() const { return QString("No simulator answers at '%1'.").arg(node_); }
  /// Whether a recording is replayed, of which nothing can be changed.
  bool isReplay() const { return is_replay_; }
  /// Whether bodies can be changed now.
  bool takesEdits() const { return isHeard() && !isReplay(); }

  void select(const QStringList& names);
  // What nobody sees happen is not to happen later, all at once: edits are refused while the simulator is silent.
  /// Gets why an edit was refused; an empty text where it was done.
  using Answer = std::function<void(const QString& refusal)>;
  void edit(const std::vector<rigid_body_sim::BodyChange>& changes, Answer answer);
  void remove(const QStringList& names);
  /// The copies are selected afterwards. Without an offset planes are left out, which is reported.
  void duplicate(const QStringList& names, unsigned count, const geometry_msgs::Vector3& offset);

 Q_SIGNALS:
  void bodiesChanged();
  void motionChanged();
  void selectionChanged();
  void replayChanged();
  void heardChanged(bool is_heard);
  /// Bodies have other names now, whoever gave them: new names by the last ones. bodiesChanged() follows.
  void renamed(const QHash<QString, QString>& new_names);
  /// A sentence for the user: an answer, a refusal, or that there is no answer.
  void reported(const QString& text, bool is_trouble);

 private:
  void receive(const rigid_body_sim::BodyDescriptions& descriptions);
  void receiveStates(const rigid_body_sim::BodyStatesConstPtr& states);
  void matchMotions();
  void receiveSelection(const rigid_body_sim::BodyNames& selection);
  void receiveStatus(const rigid_body_sim::Status& status);
  void setReplay(bool is_replay);
  std::string inNode(const char* name) const { return node_.toStdString() + "/" + name; }

  void watch();

  std::unique_ptr<ServiceWorker> worker_;  ///< made anew for each node: a call that hangs holds up no other
  QTimer watchdog_;
  Hearing hearing_;
  ros::NodeHandle ros_;
  ros::Subscriber descriptions_topic_, states_topic_, selection_topic_, status_topic_;
  ros::Publisher select_;
  QString node_;
  QStringList selection_;
  bool is_replay_ = false;
  rigid_body_sim::BodyDescriptions descriptions_;
  std::unordered_map<std::string, std::size_t> places_;  ///< of bodies(), by their names
  rigid_body_sim::BodyStatesConstPtr states_;            ///< the last ones; null: none have come
  std::vector<BodyMotion> motions_;                      ///< as bodies(), or empty
};

}  // namespace rbs
