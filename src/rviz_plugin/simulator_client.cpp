// SPDX-License-Identifier: BSD-3-Clause
#include "simulator_client.h"

#include "body_names.h"

#include <rigid_body_sim/File.h>
#include <rigid_body_sim/ListScenes.h>
#include <rigid_body_sim/LoadScene.h>
#include <rigid_body_sim/LoadSceneWithSeed.h>
#include <rigid_body_sim/MeasureAccuracy.h>
#include <rigid_body_sim/NamedBodies.h>
#include <rigid_body_sim/Seek.h>
#include <rigid_body_sim/SetEffects.h>
#include <rigid_body_sim/SetFidelity.h>
#include <rigid_body_sim/SetSpeed.h>
#include <rigid_body_sim/SetWind.h>
#include <rigid_body_sim/Step.h>
#include <rigid_body_sim/TuneFidelity.h>
#include <std_srvs/SetBool.h>
#include <std_srvs/Trigger.h>

#include <utility>

namespace rbs {
namespace {

constexpr double kPatience = 2.0;  // s without an answer, after which the user gets a message

}  // namespace

SimulatorClient::SimulatorClient() {
  constexpr int kWatchPeriod = 250;  // ms
  connect(&watchdog_, &QTimer::timeout, this, &SimulatorClient::watch);
  watchdog_.start(kWatchPeriod);
  connect(&hearing_, &Hearing::changed, this, &SimulatorClient::takeHeard);
}

void SimulatorClient::follow(const QString& node) {
  node_ = node;
  for (std::unique_ptr<ServiceWorker>* const worker : {&worker_, &stepper_}) {
    *worker = std::make_unique<ServiceWorker>();
    connect(worker->get(), &ServiceWorker::answered, this, &SimulatorClient::reportAnswer);
  }
  hearing_.forget();
  is_seeking_ = false;
  next_seek_.reset();
  selection_.clear();
  subscribers_.clear();
  select_.shutdown();
  rigid_body_sim::AccuracyStudy none;  // that of the last simulator does not hold for this one
  none.done = true;
  Q_EMIT studyReceived(none);
  try {
    subscribers_ = {
        ros_.subscribe(inNode("status"), 1, &SimulatorClient::receive, this),
        ros_.subscribe(inNode("wind"), 1, &SimulatorClient::receiveWind, this),
        ros_.subscribe(inNode("accuracy"), 1, &SimulatorClient::receiveStudy, this),
        ros_.subscribe(inNode("selected_bodies"), 1, &SimulatorClient::receiveSelection, this),
        ros_.subscribe(inNode("interactive_bodies/answer"), 10, &SimulatorClient::receiveAnswer, this)};
    select_ = ros_.advertise<rigid_body_sim::BodyNames>(inNode("select_bodies"), 10);
  } catch (const ros::Exception& error) {
    Q_EMIT reported(QString::fromStdString(error.what()), true);
  }
}

void SimulatorClient::receive(const rigid_body_sim::Status& status) {
  wind_ = status.wind;
  is_replay_ = !status.recording.empty();
  hearing_.hear();
  Q_EMIT statusReceived(status);
}

void SimulatorClient::receiveStudy(const rigid_body_sim::AccuracyStudy& study) {
  Q_EMIT studyReceived(study);
  // Once, and not of one that was over when we came.
  if (!study.done) running_study_ = study.job;
  if (!study.done || std::exchange(running_study_, std::nullopt) != study.job) return;
  if (!study.trouble.empty()) Q_EMIT reported(QString::fromStdString(study.trouble), true);
}

void SimulatorClient::receiveSelection(const rigid_body_sim::BodyNames& bodies) {
  selection_ = toQt(bodies.names);
  Q_EMIT selectionChanged(selection_);
}

void SimulatorClient::receiveAnswer(const std_msgs::String& text) {
  Q_EMIT reported(QString::fromStdString(text.data), false);
}

void SimulatorClient::watch() {
  if (!worker_) return;
  const QString service = worker_->overdue(kPatience);
  if (service.isEmpty()) return;
  Q_EMIT reported(QString("%1: no answer for %2 s").arg(service).arg(int(worker_->waited())), true);
}

void SimulatorClient::takeHeard(bool is_heard) {
  if (!is_heard) {
    // What nobody sees happen is not to happen later, all at once.
    next_seek_.reset();
    for (const std::unique_ptr<ServiceWorker>* const worker : {&worker_, &stepper_})
      if (*worker) (*worker)->dropWaiting("not done: the simulator did not answer");
  }
  Q_EMIT heardChanged(is_heard);
  if (is_heard && !is_replay_) listScenes();
}

void SimulatorClient::listScenes() {
  using rigid_body_sim::ListScenes;
  worker_->call<ListScenes>(inNode("list_scenes"), {}, [this](const ListScenes::Response& response) {
    QStringList names, properties;
    for (const std::string& name : response.names) names.append(QString::fromStdString(name));
    for (const std::string& text : response.properties) properties.append(QString::fromStdString(text));
    Q_EMIT scenesListed(names, properties);
  });
}

void SimulatorClient::reportAnswer(const QString& service, bool success, const QString& message) {
  if (success && service.endsWith("/list_scenes")) return;  // the user did not ask for it
  if (success && service.endsWith("/seek")) return;         // the slider says it
  Q_EMIT reported(success ? message : QString("%1: %2").arg(service, message), !success);
}

std::string SimulatorClient::inNode(const char* name) const {
  return node_.toStdString() + "/" + name;
}

template <class Service>
void SimulatorClient::call(const char* service, const typename Service::Request& request) {
  worker_->call<Service>(inNode(service), request);
}

void SimulatorClient::resume() {
  call<std_srvs::Trigger>("resume", {});
}

void SimulatorClient::pause() {
  call<std_srvs::Trigger>("pause", {});
}

void SimulatorClient::reset() {
  call<std_srvs::Trigger>("reset", {});
}

void SimulatorClient::undo() {
  call<std_srvs::Trigger>("undo", {});
}

void SimulatorClient::redo() {
  call<std_srvs::Trigger>("redo", {});
}

void SimulatorClient::step(int steps) {
  rigid_body_sim::Step::Request request;
  request.n = steps;
  stepper_->call<rigid_body_sim::Step>(inNode("step"), request);
}

void SimulatorClient::seek(double time) {
  next_seek_ = time;
  if (is_seeking_) return;
  is_seeking_ = true;
  using rigid_body_sim::Seek;
  Seek::Request request;
  request.time = *std::exchange(next_seek_, std::nullopt);
  const auto goOn = [this] {
    is_seeking_ = false;
    if (next_seek_) seek(*next_seek_);
  };
  worker_->call<Seek>(
      inNode("seek"), request, [goOn](const Seek::Response&) { goOn(); }, [goOn](const QString&) { goOn(); });
}

void SimulatorClient::setSpeed(double factor) {
  rigid_body_sim::SetSpeed::Request request;
  request.factor = factor;
  call<rigid_body_sim::SetSpeed>("set_speed", request);
}

void SimulatorClient::loadScene(const QString& name) {
  using rigid_body_sim::LoadScene;
  LoadScene::Request request;
  request.name = name.toStdString();
  worker_->call<LoadScene>(inNode("load_scene"), request, [this, name](const LoadScene::Response&) {
    Q_EMIT sceneFileUsed(name.startsWith('/') ? name : QString());
  });
}

void SimulatorClient::loadSceneWithSeed(const QString& name, std::uint64_t seed) {
  rigid_body_sim::LoadSceneWithSeed::Request request;
  request.name = name.toStdString();
  request.seed = seed;
  using rigid_body_sim::LoadSceneWithSeed;
  const auto use = [this, name](const LoadSceneWithSeed::Response&) {
    Q_EMIT sceneFileUsed(name.startsWith('/') ? name : QString());
  };
  worker_->call<LoadSceneWithSeed>(inNode("load_scene_with_seed"), request, use);
}

void SimulatorClient::loadState(const QString& file) {
  callFile("load_state", file, &SimulatorClient::stateFileUsed);
}

void SimulatorClient::saveScene(const QString& file) {
  callFile("save_scene", file, &SimulatorClient::sceneFileUsed);
}

void SimulatorClient::saveState(const QString& file) {
  callFile("save_state", file, &SimulatorClient::stateFileUsed);
}

void SimulatorClient::callFile(const char* service, const QString& file,
                               void (SimulatorClient::*used)(const QString&)) {
  using rigid_body_sim::File;
  File::Request request;
  request.file = file.toStdString();
  // Qt has asked whether to replace this very name. The simulator adds the suffix that it lacks, and refuses then.
  request.overwrite = file.endsWith(".yaml") || file.endsWith(".yml");
  worker_->call<File>(inNode(service), request, [this, file, used](const File::Response&) {
    Q_EMIT(this->*used)(file);
  });
}

void SimulatorClient::setWind(const geometry_msgs::Vector3& velocity, double gust) {
  rigid_body_sim::SetWind::Request request;
  request.velocity = velocity;
  request.gust = gust;
  call<rigid_body_sim::SetWind>("set_wind", request);
}

void SimulatorClient::forceEffect(const QString& effect, const QString& mode) {
  using rigid_body_sim::SetEffects;
  SetEffects::Request request;
  (mode == "on"    ? request.force_on
   : mode == "off" ? request.force_off
                   : request.detect) = {effect.toStdString()};
  worker_->call<SetEffects>(inNode("set_effects"), request,
                            [this, effect](const SetEffects::Response& response) {
                              for (const std::string& error : response.neglected)
                                Q_EMIT effectNeglected(effect, QString::fromStdString(error));
                            });
}

void SimulatorClient::setFidelity(const QString& preset) {
  rigid_body_sim::SetFidelity::Request request;
  request.fidelity = preset.toStdString();
  call<rigid_body_sim::SetFidelity>("set_fidelity", request);
}

void SimulatorClient::tuneFidelity(const rigid_body_sim::SettingCost& setting) {
  rigid_body_sim::TuneFidelity::Request request;
  request.preset = setting.preset;
  request.divisions = setting.divisions;
  request.sub_steps = setting.sub_steps;
  request.tolerance = setting.tolerance;
  call<rigid_body_sim::TuneFidelity>("tune_fidelity", request);
}

void SimulatorClient::measureAccuracy() {
  call<rigid_body_sim::MeasureAccuracy>("measure_accuracy", {});
}

void SimulatorClient::estimateError(bool on) {
  callSwitch("estimate_error", on);
}

void SimulatorClient::showGhost(bool on) {
  callSwitch("show_ghost", on);
}

void SimulatorClient::enableWind(bool on) {
  callSwitch("enable_wind", on);
}

void SimulatorClient::select(const QStringList& bodies) {
  rigid_body_sim::BodyNames message;
  message.names = toStd(bodies);
  select_.publish(message);
}

void SimulatorClient::select(const QStringList& bodies, Qt::KeyboardModifiers keys) {
  if (!(keys & (Qt::ShiftModifier | Qt::ControlModifier))) return select(bodies);
  const QSet<QString> named = toSet(bodies);
  QStringList all;
  for (const QString& name : selection_)
    if (!named.contains(name)) all.append(name);
  if (keys & Qt::ShiftModifier) all += bodies;
  select(all);
}

void SimulatorClient::toggleSelected(const QString& body) {
  QStringList bodies = selection_;
  if (bodies.removeAll(body) == 0) bodies.append(body);
  select(bodies);
}

void SimulatorClient::deleteSelection() {
  rigid_body_sim::NamedBodies::Request request;
  request.names = toStd(selection_);
  call<rigid_body_sim::NamedBodies>("delete_bodies", request);
}

void SimulatorClient::spawn(const rigid_body_sim::SpawnBody::Request& body) {
  call<rigid_body_sim::SpawnBody>("spawn_body", body);
}

void SimulatorClient::callSwitch(const char* service, bool on) {
  std_srvs::SetBool::Request request;
  request.data = on;
  call<std_srvs::SetBool>(service, request);
}

}  // namespace rbs
