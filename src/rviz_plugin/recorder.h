// SPDX-License-Identifier: BSD-3-Clause
// Recorder: listens to one simulator and records the quantities that are plotted.
#pragma once

#include "hearing.h"
#include "history.h"
#include "physics_time.h"
#include "quantities.h"

#include <rigid_body_sim/BodyDescriptions.h>
#include <rigid_body_sim/BodyStates.h>
#include <rigid_body_sim/Contacts.h>
#include <rigid_body_sim/Event.h>
#include <rigid_body_sim/Status.h>
#include <ros/ros.h>

#include <QHash>
#include <QObject>
#include <QString>
#include <QStringList>

#include <deque>
#include <map>
#include <string>
#include <vector>

namespace rbs {

/// The name of a curve in a history. `body`: empty for a quantity of the simulation.
std::string curveName(const Quantity& quantity, std::size_t curve, const std::string& body);

/// Quantities of the simulation are always recorded. Bodies are, with the topics that have them, while they
/// are asked for. The simulator may start, die and come back at any time. Lives on the GUI thread, where RViz
/// also handles the messages of subscribers.
class Recorder : public QObject {
  Q_OBJECT
 public:
  /// A quantity of a body that is asked for.
  struct Wanted {
    const Quantity* quantity;
    std::string body;
    bool operator==(const Wanted& o) const { return quantity == o.quantity && body == o.body; }
  };

  Recorder();

  /// Follows the node of this name, relative to the namespace of RViz unless it begins with '/'; forgets what
  /// was recorded. For a name that ROS does not take there is an error by reported(), and nothing is followed.
  void follow(const QString& node);
  const QString& node() const { return node_; }
  /// Records these quantities of bodies and no others.
  void want(std::vector<Wanted> wanted);
  /// Listens to the descriptions of bodies, so that bodies() knows them.
  void listBodies();

  const History& history() const { return history_; }
  QStringList bodies() const;  ///< names in the order of creation, as far as descriptions have come
  /// Whether the scene has a body of this name, or its bodies are not known yet.
  bool mayHave(const std::string& body) const;
  bool isHeard() const { return hearing_.isHeard(); }

 Q_SIGNALS:
  void recorded();
  void bodiesChanged();
  /// Bodies have other names now: new names by the last ones. What is recorded and asked for follows.
  void renamed(const QHash<QString, QString>& new_names);
  void heardChanged(bool is_heard);
  void reported(const QString& text);

 private:
  /// What has come with a stamp before the status that has its time.
  struct Pending {
    double stamp;
    const Quantity* quantity;
    std::string body;
    Quantity::Values values;
  };
  struct PendingMark {
    double stamp;
    std::string text;
  };

  void subscribe();
  void receive(const rigid_body_sim::Status& status);
  void receiveEvent(const rigid_body_sim::Event& event);
  void receiveDescriptions(const rigid_body_sim::BodyDescriptionsConstPtr& descriptions);
  void receiveStates(const rigid_body_sim::BodyStatesConstPtr& states);
  void receiveContacts(const rigid_body_sim::Contacts& contacts);
  void read(const rigid_body_sim::BodyStates& states);
  void followRenames(const QHash<QString, QString>& new_names);
  void dropAfter(double stamp);
  void flush(bool of_this_run);
  void record(const Quantity& quantity, const std::string& body, double time, const Quantity::Values& values);
  std::string inNode(const char* topic) const { return node_.toStdString() + "/" + topic; }

  ros::NodeHandle ros_;
  ros::Subscriber status_, events_, descriptions_, states_, contacts_;
  QString node_;
  bool is_followed_ = false;  ///< whether ROS takes the name of the node
  bool lists_bodies_ = false;
  std::vector<Wanted> wanted_;
  History history_;
  PhysicsTime clock_;
  double stamp_ = 0.0;  ///< of the last status, s
  double step_ = 0.0;   ///< length of a step, s
  std::string fidelity_;
  std::deque<Pending> pending_;
  std::deque<PendingMark> pending_marks_;
  rigid_body_sim::BodyDescriptionsConstPtr described_;  ///< null: none yet
  std::map<std::string, std::size_t> places_;           ///< of the bodies in the lists of states
  rigid_body_sim::BodyStatesConstPtr waiting_;          ///< for their descriptions; null: none are
  Hearing hearing_;
};

}  // namespace rbs
