// SPDX-License-Identifier: BSD-3-Clause
#include "body_inbox.h"

#include <utility>

namespace rbs {
namespace {

constexpr std::size_t kMost = 64;  // states that wait where RViz draws no picture for long

bool repeats(const rigid_body_sim::BodyDescriptions& a, const rigid_body_sim::BodyDescriptions& b) {
  return a.version == b.version && a.header.frame_id == b.header.frame_id && a.bodies == b.bodies;
}

}  // namespace

void BodyInbox::receive(const rigid_body_sim::BodyDescriptionsConstPtr& message) {
  std::shared_ptr<const BodyCatalog> catalog = last_ && repeats(*last_, *message) ? last_catalog_ : nullptr;
  std::string complaint;
  try {
    if (!catalog) catalog = readDescriptions(*message, hulls_);
  } catch (const BadMessage& error) {
    complaint = std::string("Descriptions: ") + error.what() + ".";
  }
  std::lock_guard<std::mutex> lock(mutex_);
  ++content_.descriptions;
  if (catalog) {
    last_ = message;
    last_catalog_ = catalog;
    content_.catalogs = {catalog};
  }
  if (!complaint.empty()) content_.complaints = {complaint};
}

void BodyInbox::receive(const rigid_body_sim::BodyStatesConstPtr& message) {
  std::shared_ptr<const BodyFrame> frame;
  std::string complaint;
  try {
    frame = readStates(*message, ros::WallTime::now().toSec());
  } catch (const BadMessage& error) {
    complaint = std::string("States: ") + error.what() + ".";
  }
  std::lock_guard<std::mutex> lock(mutex_);
  ++content_.states;
  if (frame) content_.frames.push_back(frame);
  if (content_.frames.size() > kMost) content_.frames.erase(content_.frames.begin());
  if (!complaint.empty()) content_.complaints = {complaint};
}

void BodyInbox::receive(const rigid_body_sim::ContactsConstPtr& message) {
  std::lock_guard<std::mutex> lock(mutex_);
  content_.contacts = message;
}

void BodyInbox::receive(const rigid_body_sim::BodyDetailsConstPtr& message) {
  std::lock_guard<std::mutex> lock(mutex_);
  content_.details = message;
}

void BodyInbox::receive(const rigid_body_sim::StatusConstPtr& message) {
  std::lock_guard<std::mutex> lock(mutex_);
  content_.step = message->step;
}

BodyInbox::Content BodyInbox::take() {
  std::lock_guard<std::mutex> lock(mutex_);
  return std::exchange(content_, {});
}

}  // namespace rbs
