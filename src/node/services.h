// SPDX-License-Identifier: BSD-3-Clause
// The services of the node: each posts a command to the simulator, waits until it is done and replies.
//
// A reply has `success` and `message`. The message of a success says what was done and assumed. That of a
// refusal lists every fault, and the world is unchanged. The call itself never fails.
#pragma once

#include "accuracy_job.h"
#include "answer.h"
#include "reference_run.h"
#include "session.h"

#include <ros/callback_queue.h>
#include <ros/ros.h>

#include <functional>
#include <string>
#include <vector>

namespace rbs {

class Services {
 public:
  /// Offers all services, private to the node.
  Services(Session& session, ReferenceRun& reference_run);

 private:
  /// Handler of a service: returns the message of the reply, or throws.
  template <class Service>
  using Handler = std::function<std::string(const typename Service::Request&, typename Service::Response&)>;

  /// Handler of a service that edits the world, between two steps.
  template <class Service>
  using Edit = std::string (*)(World&, const typename Service::Request&, typename Service::Response&);

  /// Handler of a service that only reads the last snapshot.
  template <class Service>
  using Query = std::string (*)(const Snapshot&, const typename Service::Request&,
                                typename Service::Response&);

  /// Offers a service on this callback queue, or on the global one.
  template <class Service>
  void offer(const std::string& name, Handler<Service> handler, ros::CallbackQueue* queue = nullptr);
  template <class Service>
  void offerEdit(const std::string& name, Edit<Service> edit);
  template <class Service>
  void offerQuery(const std::string& name, Query<Service> query);

  void offerBodyEdits();
  void offerPushes();
  void offerReading();
  void offerQueries();
  void offerSurroundings();
  void offerRun();
  void offerScenes();
  void offerAccuracy();

  Session& session_;
  Simulator& simulator_;
  ros::NodeHandle node_;
  AccuracyJob accuracy_;
  ReferenceRun& reference_run_;
  std::vector<ros::ServiceServer> servers_;
  ros::CallbackQueue step_queue_;
  ros::AsyncSpinner step_spinner_;
};

template <class Service>
void Services::offer(const std::string& name, Handler<Service> handler, ros::CallbackQueue* queue) {
  auto service =
      ros::AdvertiseServiceOptions::create<Service>(name, answerBy<Service>(handler), nullptr, queue);
  servers_.push_back(node_.advertiseService(service));
}

template <class Service>
void Services::offerEdit(const std::string& name, Edit<Service> edit) {
  offer<Service>(name, [this, edit](const auto& request, auto& response) {
    return simulator_.apply([&](World& world) { return edit(world, request, response); });
  });
}

template <class Service>
void Services::offerQuery(const std::string& name, Query<Service> query) {
  offer<Service>(name, [this, query](const auto& request, auto& response) {
    return query(*simulator_.snapshot(), request, response);
  });
}

}  // namespace rbs
