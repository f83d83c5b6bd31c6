// SPDX-License-Identifier: BSD-3-Clause
#include "recorder.h"

#include "body_renames.h"

#include <algorithm>

namespace rbs {
namespace {

constexpr std::size_t kPending = 2000;  // what waits for its time: more comes only from a node that is stuck
constexpr int kStatusQueue = 10, kEventQueue = 1000, kStateQueue = 50;

bool contains(const std::vector<Recorder::Wanted>& all, const Recorder::Wanted& one) {
  return std::find(all.begin(), all.end(), one) != all.end();
}

bool isEdit(const std::string& kind) {
  return kind == "spawned" || kind == "deleted" || kind == "edited" || kind == "undone" || kind == "redone";
}

}  // namespace

std::string curveName(const Quantity& quantity, std::size_t curve, const std::string& body) {
  const std::string of = body.empty() ? "" : " of " + body;
  const std::string part = quantity.curves.size() == 1 ? "" : " " + quantity.curves[curve];
  return quantity.name + part + of;
}

Recorder::Recorder() {
  connect(&hearing_, &Hearing::changed, this, &Recorder::heardChanged);
}

void Recorder::follow(const QString& node) {
  node_ = node;
  for (ros::Subscriber* subscriber : {&status_, &events_, &descriptions_, &states_, &contacts_})
    subscriber->shutdown();
  history_ = History();
  clock_ = PhysicsTime();
  stamp_ = 0.0;
  pending_.clear();
  pending_marks_.clear();
  fidelity_.clear();
  described_.reset();
  waiting_.reset();
  places_.clear();
  hearing_.forget();
  is_followed_ = false;
  try {
    status_ = ros_.subscribe(inNode("status"), kStatusQueue, &Recorder::receive, this);
    events_ = ros_.subscribe(inNode("events"), kEventQueue, &Recorder::receiveEvent, this);
    is_followed_ = true;
  } catch (const ros::Exception& error) {
    Q_EMIT reported(QString::fromStdString(error.what()));
  }
  subscribe();
  Q_EMIT bodiesChanged();
  Q_EMIT recorded();
}

// A topic is subscribed to while a plot needs it.
void Recorder::subscribe() {
  const auto needs = [this](auto reader) {
    return is_followed_ && std::any_of(wanted_.begin(), wanted_.end(),
                                       [&](const Wanted& wanted) { return wanted.quantity->*reader; });
  };
  const bool needs_states = needs(&Quantity::of_state), needs_contacts = needs(&Quantity::of_contacts);
  if (!needs_states) states_.shutdown();
  if (!needs_contacts) contacts_.shutdown();
  if (is_followed_ && (lists_bodies_ || !wanted_.empty()) && !descriptions_)
    descriptions_ = ros_.subscribe(inNode("body_descriptions"), 1, &Recorder::receiveDescriptions, this);
  if (needs_states && !states_)
    states_ = ros_.subscribe(inNode("body_states"), kStateQueue, &Recorder::receiveStates, this);
  if (needs_contacts && !contacts_)
    contacts_ = ros_.subscribe(inNode("contacts"), kStateQueue, &Recorder::receiveContacts, this);
}

void Recorder::want(std::vector<Wanted> wanted) {
  for (const Wanted& old : wanted_) {
    if (contains(wanted, old)) continue;
    for (std::size_t k = 0; k < old.quantity->curves.size(); ++k)
      history_.forget(curveName(*old.quantity, k, old.body));
  }
  const bool is_new = std::any_of(wanted.begin(), wanted.end(),
                                  [this](const Wanted& now) { return !contains(wanted_, now); });
  wanted_ = std::move(wanted);
  // A new subscriber gets the last states at once, also while the simulator is paused, unless another part of RViz
  // has subscribed to them as well.
  if (is_new) states_.shutdown(), contacts_.shutdown();
  subscribe();
}

void Recorder::listBodies() {
  lists_bodies_ = true;
  subscribe();
}

QStringList Recorder::bodies() const {
  QStringList names;
  if (!described_) return names;
  for (const rigid_body_sim::BodyDescription& body : described_->bodies)
    names.append(QString::fromStdString(body.name));
  return names;
}

bool Recorder::mayHave(const std::string& body) const {
  return !described_ || places_.count(body) > 0;
}

void Recorder::receive(const rigid_body_sim::Status& status) {
  hearing_.hear();
  step_ = status.step;
  const double stamp = status.header.stamp.toSec();
  if (stamp < stamp_) dropAfter(stamp);  // of a simulator that is no more
  stamp_ = stamp;
  const bool has_begun = clock_.learn(stamp, status.time);
  if (has_begun) {
    flush(false);
    history_.beginRun();
  }
  flush(true);
  for (const Quantity& quantity : quantities())
    if (quantity.of_status) record(quantity, "", status.time, quantity.of_status(status));
  if (status.fidelity != fidelity_ && !fidelity_.empty())
    history_.mark(status.time, "solver settings: " + status.fidelity + ", before: " + fidelity_);
  fidelity_ = status.fidelity;
  Q_EMIT recorded();
}

void Recorder::receiveEvent(const rigid_body_sim::Event& event) {
  if (!isEdit(event.kind) || pending_marks_.size() >= kPending) return;
  const std::string body = event.body.empty() ? "" : " " + event.body;
  const std::string text = event.text.empty() ? "" : ": " + event.text;
  pending_marks_.push_back({event.header.stamp.toSec(), event.kind + body + text});
}

void Recorder::receiveDescriptions(const rigid_body_sim::BodyDescriptionsConstPtr& descriptions) {
  const bool is_new = !described_ || described_->version != descriptions->version ||
                      described_->bodies.size() != descriptions->bodies.size();
  const QHash<QString, QString> new_names =
      described_ ? renamesOf(*described_, *descriptions) : QHash<QString, QString>();
  described_ = descriptions;
  places_.clear();
  for (std::size_t i = 0; i < descriptions->bodies.size(); ++i) places_[descriptions->bodies[i].name] = i;
  if (!new_names.isEmpty()) followRenames(new_names);
  if (const auto states = std::exchange(waiting_, nullptr)) receiveStates(states);
  if (is_new) Q_EMIT bodiesChanged();
}

void Recorder::followRenames(const QHash<QString, QString>& new_names) {
  const auto newName = [&](const std::string& body) {
    const QString name = QString::fromStdString(body);
    return new_names.value(name, name).toStdString();
  };
  CurveNames curves;
  for (Wanted& wanted : wanted_) {
    const std::string body = newName(wanted.body);
    for (std::size_t k = 0; body != wanted.body && k < wanted.quantity->curves.size(); ++k)
      curves[curveName(*wanted.quantity, k, wanted.body)] = curveName(*wanted.quantity, k, body);
    wanted.body = body;
  }
  history_.rename(curves);
  for (Pending& one : pending_) one.body = newName(one.body);
  Q_EMIT renamed(new_names);
}

// States that come before the descriptions of their version wait for them: of those, the newest.
void Recorder::receiveStates(const rigid_body_sim::BodyStatesConstPtr& states) {
  if (described_ && described_->version == states->version) {
    read(*states);
  } else {
    waiting_ = states;
  }
}

void Recorder::read(const rigid_body_sim::BodyStates& states) {
  for (const Wanted& wanted : wanted_) {
    const auto place = places_.find(wanted.body);
    if (!wanted.quantity->of_state || place == places_.end()) continue;
    const std::size_t i = place->second;
    if (i >= states.poses.size() || i >= states.twists.size()) continue;
    pending_.push_back({states.header.stamp.toSec(), wanted.quantity, wanted.body,
                        wanted.quantity->of_state(states.poses[i], states.twists[i])});
    if (pending_.size() > kPending) pending_.pop_front();
  }
}

void Recorder::receiveContacts(const rigid_body_sim::Contacts& contacts) {
  for (const Wanted& wanted : wanted_) {
    if (!wanted.quantity->of_contacts || !described_ || places_.count(wanted.body) == 0) continue;
    Quantity::Values values = wanted.quantity->of_contacts(contacts, wanted.body);
    for (double& value : values) value = step_ > 0.0 ? value / step_ : 0.0;
    pending_.push_back({contacts.header.stamp.toSec(), wanted.quantity, wanted.body, values});
    if (pending_.size() > kPending) pending_.pop_front();
  }
}

void Recorder::dropAfter(double stamp) {
  const auto is_after = [stamp](const auto& one) { return one.stamp > stamp; };
  pending_.erase(std::remove_if(pending_.begin(), pending_.end(), is_after), pending_.end());
  pending_marks_.erase(std::remove_if(pending_marks_.begin(), pending_marks_.end(), is_after),
                       pending_marks_.end());
}

// Records what has waited and belongs to this run, or to the one that ends. With this run, what has waited in
// vain is dropped.
void Recorder::flush(bool of_this_run) {
  const auto isMine = [&](double stamp, double& time) {
    const auto when = clock_.of(stamp);
    if (!when || when->is_of_this_run != of_this_run) return false;
    time = when->time;
    return true;
  };
  double time = 0.0;
  for (const Pending& one : pending_)
    if (isMine(one.stamp, time)) record(*one.quantity, one.body, time, one.values);
  for (const PendingMark& one : pending_marks_)
    if (isMine(one.stamp, time)) history_.mark(time, one.text);
  if (!of_this_run) return;
  const auto is_past = [this](const auto& one) { return !clock_.isAhead(one.stamp); };
  pending_.erase(std::remove_if(pending_.begin(), pending_.end(), is_past), pending_.end());
  pending_marks_.erase(std::remove_if(pending_marks_.begin(), pending_marks_.end(), is_past),
                       pending_marks_.end());
}

void Recorder::record(const Quantity& quantity, const std::string& body, double time,
                      const Quantity::Values& values) {
  for (std::size_t k = 0; k < values.size(); ++k)
    history_.add(curveName(quantity, k, body), {time, values[k]});
}

}  // namespace rbs
