// SPDX-License-Identifier: BSD-3-Clause
// ServiceWorker: calls services on a thread of its own, so that a slow or dead node never stops the GUI.
#pragma once

#include <ros/ros.h>

#include <QElapsedTimer>
#include <QObject>
#include <QString>
#include <QStringList>

#include <deque>
#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <string>

namespace rbs {

/// Calls services one after the other, in the order of the requests. All but the calls themselves
/// happens on the thread that made this object.
class ServiceWorker : public QObject {
  Q_OBJECT
 public:
  ServiceWorker();
  /// Does not wait for a call that is under way: roscpp has no time-out for it.
  ~ServiceWorker() override;

  /// Asks for a call. The service's answer has `success` and `message`. `then` gets a successful answer,
  /// `otherwise` the message of a refusal, or that there is no answer.
  template <class Service>
  void call(const std::string& name, const typename Service::Request& request,
            std::function<void(const typename Service::Response&)> then = {},
            std::function<void(const QString&)> otherwise = {});

  /// Gives up the calls that have not begun: each is answered by this message.
  void dropWaiting(const std::string& message);

  /// Name of the service that has been under way for longer than this; empty when there is none.
  QString overdue(double seconds) const;
  /// How long the call under way has lasted, s; 0 when there is none.
  double waited() const;

 Q_SIGNALS:
  void answered(const QString& service, bool success, const QString& message);

 private:
  struct Answer {
    bool success = false;
    std::string message;
    std::function<void()> then;  ///< may be empty
  };
  /// By the name of the service. They last: where a connection is closed while roscpp polls it, a new one that
  /// gets its file descriptor is now and then closed in its place, and the call fails.
  using Connections = std::map<std::string, ros::ServiceClient>;
  using Call = std::function<Answer(Connections&)>;
  struct Queue;

  using Refused = std::function<void(const QString&)>;

  void post(const std::string& name, Call call, Refused otherwise);
  void finish(const Answer& answer);
  static void work(const std::shared_ptr<Queue>& queue);
  static Answer answerOf(const Call& call, Connections& connections);

  std::shared_ptr<Queue> queue_;   ///< shared with the thread, which may outlive this object
  QStringList waiting_;            ///< names of the calls without an answer; the first is under way
  std::deque<Refused> otherwise_;  ///< of the same calls; each may be empty
  QElapsedTimer under_way_;
};

template <class Service>
void ServiceWorker::call(const std::string& name, const typename Service::Request& request,
                         std::function<void(const typename Service::Response&)> then,
                         std::function<void(const QString&)> otherwise) {
  const auto call = [name, request, then](Connections& connections) mutable {
    ros::ServiceClient& client = connections[name];
    if (!client || !client.isValid()) client = ros::NodeHandle().serviceClient<Service>(name, true);
    typename Service::Response response;
    if (!client.call(request, response)) {
      client.shutdown();
      return Answer{false, "no answer; is the simulator running?", {}};
    }
    const bool success = response.success;
    const std::string message = response.message;
    if (!success || !then) return Answer{success, message, {}};
    return Answer{success, message, [then, response] { then(response); }};
  };
  post(name, call, std::move(otherwise));
}

}  // namespace rbs
