// SPDX-License-Identifier: BSD-3-Clause
#include "service_worker.h"

#include <condition_variable>
#include <deque>
#include <iterator>
#include <mutex>
#include <thread>
#include <vector>

namespace rbs {

struct ServiceWorker::Queue {
  std::mutex mutex;
  std::condition_variable changed;
  std::deque<Call> calls;
  ServiceWorker* owner = nullptr;  ///< null once it is gone: the thread then ends
};

ServiceWorker::ServiceWorker() : queue_(std::make_shared<Queue>()) {
  queue_->owner = this;
  std::thread(work, queue_).detach();
}

ServiceWorker::~ServiceWorker() {
  const std::lock_guard<std::mutex> lock(queue_->mutex);
  queue_->owner = nullptr;
  queue_->calls.clear();
  queue_->changed.notify_one();
}

QString ServiceWorker::overdue(double seconds) const {
  return waited() > seconds ? waiting_.front() : QString();
}

double ServiceWorker::waited() const {
  return waiting_.isEmpty() ? 0.0 : 1e-3 * under_way_.elapsed();
}

void ServiceWorker::post(const std::string& name, Call call, Refused otherwise) {
  if (waiting_.isEmpty()) under_way_.start();
  waiting_.append(QString::fromStdString(name));
  otherwise_.push_back(std::move(otherwise));
  const std::lock_guard<std::mutex> lock(queue_->mutex);
  queue_->calls.push_back(std::move(call));
  queue_->changed.notify_one();
}

// The first of those that wait is under way, or its answer is.
void ServiceWorker::dropWaiting(const std::string& message) {
  std::size_t dropped = 0;
  {
    const std::lock_guard<std::mutex> lock(queue_->mutex);
    dropped = queue_->calls.size();
    queue_->calls.clear();
  }
  const int kept = waiting_.size() - static_cast<int>(dropped);
  const QStringList services = waiting_.mid(kept);
  const std::vector<Refused> refused(std::make_move_iterator(otherwise_.begin() + kept),
                                     std::make_move_iterator(otherwise_.end()));
  waiting_.erase(waiting_.begin() + kept, waiting_.end());
  otherwise_.erase(otherwise_.begin() + kept, otherwise_.end());
  for (std::size_t k = 0; k < refused.size(); ++k) {
    Q_EMIT answered(services[static_cast<int>(k)], false, QString::fromStdString(message));
    if (refused[k]) refused[k](QString::fromStdString(message));
  }
}

void ServiceWorker::finish(const Answer& answer) {
  const QString service = waiting_.takeFirst(), message = QString::fromStdString(answer.message);
  const Refused otherwise = std::move(otherwise_.front());
  otherwise_.pop_front();
  under_way_.start();
  Q_EMIT answered(service, answer.success, message);
  if (answer.then) answer.then();
  if (!answer.success && otherwise) otherwise(message);
}

void ServiceWorker::work(const std::shared_ptr<Queue>& queue) {
  Connections connections;
  std::unique_lock<std::mutex> lock(queue->mutex);
  while (true) {
    queue->changed.wait(lock, [&] { return !queue->owner || !queue->calls.empty(); });
    if (!queue->owner) return;
    const Call call = std::move(queue->calls.front());
    queue->calls.pop_front();
    lock.unlock();
    const Answer answer = answerOf(call, connections);
    lock.lock();
    if (!queue->owner) return;
    // Qt drops the event when the owner is destroyed before it is handled.
    ServiceWorker* const owner = queue->owner;
    QMetaObject::invokeMethod(
        owner, [owner, answer] { owner->finish(answer); }, Qt::QueuedConnection);
  }
}

ServiceWorker::Answer ServiceWorker::answerOf(const Call& call, Connections& connections) {
  try {
    return call(connections);
  } catch (const std::exception& error) {
    return Answer{false, error.what(), {}};
  }
}

}  // namespace rbs
