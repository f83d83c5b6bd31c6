// SPDX-License-Identifier: BSD-3-Clause
// Inbox: the messages about bodies, received and read on a thread of RViz that is not that of the window.
#pragma once

#include "body_catalog.h"

#include <rigid_body_sim/BodyDetails.h>
#include <rigid_body_sim/Contacts.h>
#include <rigid_body_sim/Status.h>
#include <ros/ros.h>

#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace rbs {

/// Thread-safe.
class BodyInbox {
 public:
  /// What has come since the last take().
  struct Content {
    std::vector<std::shared_ptr<const BodyCatalog>> catalogs;
    std::vector<std::shared_ptr<const BodyFrame>> frames;
    rigid_body_sim::ContactsConstPtr contacts;    ///< the newest; null: none
    rigid_body_sim::BodyDetailsConstPtr details;  ///< the newest; null: none
    double step = 0.0;                            ///< length of a step, s; 0: not known
    std::vector<std::string> complaints;          ///< why a message was not taken, with its topic
    std::size_t descriptions = 0, states = 0;     ///< messages, whether taken or not
  };

  /// Descriptions that repeat the last ones give the same catalog.
  void receive(const rigid_body_sim::BodyDescriptionsConstPtr& message);
  void receive(const rigid_body_sim::BodyStatesConstPtr& message);
  void receive(const rigid_body_sim::ContactsConstPtr& message);
  void receive(const rigid_body_sim::BodyDetailsConstPtr& message);
  void receive(const rigid_body_sim::StatusConstPtr& message);
  Content take();

 private:
  std::mutex mutex_;
  Content content_;
  rigid_body_sim::BodyDescriptionsConstPtr last_;  ///< that could be read
  std::shared_ptr<const BodyCatalog> last_catalog_;
  DrawnHulls hulls_;  ///< of that catalog
};

}  // namespace rbs
