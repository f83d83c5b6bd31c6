// SPDX-License-Identifier: BSD-3-Clause
#include "hearing.h"

#include <ros/callback_queue.h>
#include <ros/init.h>

#include <boost/make_shared.hpp>

namespace rbs {
namespace {

/// What RViz finds in its queue beside the messages.
class QueueMark : public ros::CallbackInterface {
 public:
  explicit QueueMark(std::shared_ptr<bool> taken) : taken_(std::move(taken)) {}
  CallResult call() override {
    *taken_ = true;
    return Success;
  }

 private:
  std::shared_ptr<bool> taken_;
};

}  // namespace

Hearing::Hearing() {
  constexpr int kPeriod = 250;  // ms
  connect(&looks_, &QTimer::timeout, this, &Hearing::look);
  looks_.start(kPeriod);
}

void Hearing::look() {
  constexpr int kMostQuiet = 8;
  if (!*takes_messages_ && ros::ok()) return;
  if (is_heard_ && ++quiet_ > kMostQuiet) set(false);
  *takes_messages_ = false;
  ros::getGlobalCallbackQueue()->addCallback(boost::make_shared<QueueMark>(takes_messages_), markId());
}

Hearing::~Hearing() {
  ros::getGlobalCallbackQueue()->removeByID(markId());
}

void Hearing::hear() {
  quiet_ = 0;
  set(true);
}

void Hearing::set(bool is_heard) {
  if (is_heard == is_heard_) return;
  is_heard_ = is_heard;
  Q_EMIT changed(is_heard);
}

}  // namespace rbs
