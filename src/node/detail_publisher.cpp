// SPDX-License-Identifier: BSD-3-Clause
#include "detail_publisher.h"

#include "convert.h"

#include <rigid_body_sim/BodyDetails.h>

#include <algorithm>
#include <array>
#include <string_view>

namespace rbs {
namespace {

using rigid_body_sim::BodyDetails;

struct MethodNumber {
  std::string_view name;
  std::uint8_t number;
};
constexpr std::array kMethods{
    MethodNumber{"asleep", BodyDetails::ASLEEP},
    MethodNumber{"ballistic", BodyDetails::BALLISTIC},
    MethodNumber{"flight", BodyDetails::FLIGHT},
    MethodNumber{"soft_step", BodyDetails::SOFT_STEP},
    MethodNumber{"warm_start", BodyDetails::WARM_START},
    MethodNumber{"gauss_seidel", BodyDetails::GAUSS_SEIDEL},
    MethodNumber{"newton", BodyDetails::NEWTON},
    MethodNumber{"interior_point", BodyDetails::INTERIOR_POINT},
    MethodNumber{"admm", BodyDetails::ADMM},
};

std::uint8_t numberOf(std::string_view method) {
  const auto known =
      std::find_if(kMethods.begin(), kMethods.end(), [&](const auto& row) { return row.name == method; });
  return known != kMethods.end() ? known->number : std::uint8_t{BodyDetails::NONE};
}

BodyDetails detailsMsg(const Timeline::Moment& moment, const RunComparison::Distances* distances) {
  const Snapshot& snapshot = *moment.snapshot;
  BodyDetails msg;
  msg.header.stamp = moment.stamp;
  msg.header.frame_id = worldFrame();
  for (std::size_t k = 0; k < snapshot.states.size(); ++k) {
    msg.ids.push_back(snapshot.states[k].id.serial);
    msg.methods.push_back(numberOf(snapshot.states[k].method));
    msg.islands.push_back(snapshot.states[k].island.serial);
  }
  if (!distances || distances->of_bodies.size() != msg.ids.size()) return msg;
  for (const double distance : distances->of_bodies) msg.reference_distances.push_back(finite(distance));
  msg.reference_age = std::max(0.0, snapshot.time - distances->time);
  return msg;
}

}  // namespace

DetailPublisher::DetailPublisher(ros::NodeHandle& node, ReferenceRun& reference_run)
    : reference_run_(reference_run), topic_(Topic::of<BodyDetails>(node, "body_details", 10)) {}

void DetailPublisher::publish(const Timeline::Moment& moment) {
  constexpr double kPeriod = 0.1;  // s
  due_ = due_ || moment.changed;
  if (!topic_.isHeard()) return;
  reference_run_.compareWith(*moment.snapshot);
  const std::shared_ptr<const RunComparison::Distances> distances = reference_run_.distances();
  due_ = due_ || distances != sent_distances_;
  const bool is_soon = ros::WallTime::now() - sent_ < ros::WallDuration(kPeriod);
  if (topic_.hasNewcomer() || (due_ && !is_soon)) {
    due_ = false;
    sent_ = ros::WallTime::now();
    sent_distances_ = distances;
    topic_.send(detailsMsg(moment, distances.get()));
  }
}

}  // namespace rbs
