// SPDX-License-Identifier: BSD-3-Clause
#include "bodies_client.h"

#include "body_names.h"
#include "body_renames.h"

#include <rigid_body_sim/DuplicateBodies.h>
#include <rigid_body_sim/EditBodies.h>
#include <rigid_body_sim/NamedBodies.h>

namespace rbs {
BodiesClient::BodiesClient() {
  constexpr int kWatchPeriod = 500;  // ms
  connect(&watchdog_, &QTimer::timeout, this, &BodiesClient::watch);
  watchdog_.start(kWatchPeriod);
  connect(&hearing_, &Hearing::changed, this, &BodiesClient::heardChanged);
}

void BodiesClient::watch() {
  constexpr double kPatience = 2.0;  // s
  const QString service = worker_ ? worker_->overdue(kPatience) : QString();
  if (!service.isEmpty())
    Q_EMIT reported(QString("%1: no answer for %2 s").arg(service).arg(int(worker_->waited())), true);
}

void BodiesClient::follow(const QString& node) {
  node_ = node;
  hearing_.forget();
  worker_ = std::make_unique<ServiceWorker>();
  connect(
      worker_.get(), &ServiceWorker::answered, this,
      [this](const QString&, bool success, const QString& message) { Q_EMIT reported(message, !success); });
  states_topic_.shutdown();
  descriptions_topic_.shutdown();
  selection_topic_.shutdown();
  status_topic_.shutdown();
  select_.shutdown();
  descriptions_ = {};
  places_.clear();
  states_.reset();
  motions_.clear();
  selection_.clear();
  try {
    descriptions_topic_ = ros_.subscribe(inNode("body_descriptions"), 1, &BodiesClient::receive, this);
    // From the start: where another part of RViz listens as well, who comes later gets no state of its own.
    states_topic_ = ros_.subscribe(inNode("body_states"), 1, &BodiesClient::receiveStates, this);
    selection_topic_ = ros_.subscribe(inNode("selected_bodies"), 1, &BodiesClient::receiveSelection, this);
    status_topic_ = ros_.subscribe(inNode("status"), 1, &BodiesClient::receiveStatus, this);
    select_ = ros_.advertise<rigid_body_sim::BodyNames>(inNode("select_bodies"), 10);
  } catch (const ros::Exception& error) {
    Q_EMIT reported(QString::fromStdString(error.what()), true);
  }
  setReplay(false);
  Q_EMIT bodiesChanged();
  Q_EMIT selectionChanged();
}

std::optional<std::size_t> BodiesClient::find(const QString& name) const {
  const auto it = places_.find(name.toStdString());
  return it == places_.end() ? std::nullopt : std::make_optional(it->second);
}

std::optional<BodyMotion> BodiesClient::motion(std::size_t index) const {
  return index < motions_.size() ? std::make_optional(motions_[index]) : std::nullopt;
}

void BodiesClient::receive(const rigid_body_sim::BodyDescriptions& descriptions) {
  hearing_.hear();
  if (descriptions.version == descriptions_.version && descriptions.header.frame_id == frame() &&
      descriptions.bodies == bodies())
    return;  // sent again
  const QHash<QString, QString> new_names = renamesOf(descriptions_, descriptions);
  descriptions_ = descriptions;
  places_.clear();
  for (std::size_t i = 0; i < bodies().size(); ++i) places_.emplace(bodies()[i].name, i);
  matchMotions();
  if (!new_names.isEmpty()) Q_EMIT renamed(new_names);
  Q_EMIT bodiesChanged();
}

void BodiesClient::receiveStates(const rigid_body_sim::BodyStatesConstPtr& states) {
  states_ = states;
  matchMotions();
  Q_EMIT motionChanged();
}

// Either may come first. States of other bodies than the described ones wait for their descriptions.
void BodiesClient::matchMotions() {
  const std::size_t count = bodies().size();
  motions_.clear();
  if (!states_ || states_->ids.size() != count || states_->poses.size() != count ||
      states_->twists.size() != count)
    return;
  for (std::size_t i = 0; i < count; ++i)
    if (states_->ids[i] != bodies()[i].id) return;
  for (std::size_t i = 0; i < count; ++i) motions_.push_back({states_->poses[i], states_->twists[i]});
}

void BodiesClient::receiveSelection(const rigid_body_sim::BodyNames& selection) {
  selection_ = toQt(selection.names);
  Q_EMIT selectionChanged();
}

void BodiesClient::receiveStatus(const rigid_body_sim::Status& status) {
  hearing_.hear();
  setReplay(!status.recording.empty());
}

void BodiesClient::setReplay(bool is_replay) {
  if (is_replay == is_replay_) return;
  is_replay_ = is_replay;
  Q_EMIT replayChanged();
}

void BodiesClient::select(const QStringList& names) {
  rigid_body_sim::BodyNames message;
  message.names = toStd(names);
  select_.publish(message);
}

void BodiesClient::edit(const std::vector<rigid_body_sim::BodyChange>& changes, Answer answer) {
  using rigid_body_sim::EditBodies;
  if (!hearing_.isHeard()) {
    Q_EMIT reported(silence(), true);
    return answer(silence());
  }
  EditBodies::Request request;
  request.changes = changes;
  worker_->call<EditBodies>(
      inNode("edit_bodies"), request, [answer](const EditBodies::Response&) { answer({}); }, answer);
}

void BodiesClient::remove(const QStringList& names) {
  if (!hearing_.isHeard()) return void(Q_EMIT reported(silence(), true));
  rigid_body_sim::NamedBodies::Request request;
  request.names = toStd(names);
  worker_->call<rigid_body_sim::NamedBodies>(inNode("delete_bodies"), request);
}

void BodiesClient::duplicate(const QStringList& names, unsigned count, const geometry_msgs::Vector3& offset) {
  using rigid_body_sim::DuplicateBodies;
  if (!hearing_.isHeard()) return void(Q_EMIT reported(silence(), true));
  QStringList copied, planes;
  for (const QString& name : names) {
    const std::optional<std::size_t> i = find(name);
    const bool is_plane = i && bodies()[*i].shape == "plane";
    (is_plane && offset == geometry_msgs::Vector3() ? planes : copied).append(name);
  }
  DuplicateBodies::Request request;
  request.names = toStd(copied.isEmpty() ? names : copied);  // the simulator says why it copies no plane
  request.count = count;
  request.offset = offset;
  worker_->call<DuplicateBodies>(
      inNode("duplicate_bodies"), request, [this, planes](const DuplicateBodies::Response& response) {
        select(toQt(response.names));
        if (planes.isEmpty()) return;
        const QString done = QString::fromStdString(response.message);
        Q_EMIT reported(QString("%1, but none of '%2': the copy of a plane needs an offset")
                            .arg(done, planes.join("', '")),
                        false);
      });
}

}  // namespace rbs
