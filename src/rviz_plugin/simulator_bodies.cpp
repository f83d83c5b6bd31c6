// SPDX-License-Identifier: BSD-3-Clause
#include "simulator_bodies.h"

#include <rigid_body_sim/CastRay.h>
#include <rigid_body_sim/GetBody.h>

#include <QElapsedTimer>
#include <QTimer>

#include <algorithm>
#include <chrono>
#include <future>
#include <memory>
#include <thread>
#include <unordered_set>

namespace rbs {
namespace {

using Met = SimulatorBodies::Met;

std::optional<Met> ask(const std::string& node, rigid_body_sim::CastRay ray) {
  if (!ros::service::call(node + "/cast_ray", ray) || ray.response.hits.empty()) return std::nullopt;
  rigid_body_sim::GetBody body;
  body.request.name = ray.response.hits.front().body;
  if (!ros::service::call(node + "/get_body", body) || !body.response.success) return std::nullopt;
  if (body.response.body.description.shape == "plane") return std::nullopt;
  return Met{body.response.body, ray.response.hits.front().position};
}

}  // namespace

bool isSeeThrough(const rigid_body_sim::BodyDescription& body) {
  return body.kind == "static" && body.color.a < 1.0f;
}

SimulatorBodies::SimulatorBodies(const std::string& node) : node_(node) {
  constexpr int kQueue = 100;
  static const ros::WallDuration kKept(
      1.0);  // a node that starts later is not to find what nobody saw happen
  const boost::function<void(const rigid_body_sim::BodyDescriptionsConstPtr&)> keep =
      [this](const rigid_body_sim::BodyDescriptionsConstPtr& message) { descriptions_ = *message; };
  descriptions_topic_ =
      ros_.subscribe<rigid_body_sim::BodyDescriptions>(node + "/body_descriptions", 1, keep);
  const boost::function<void(const rigid_body_sim::BodyNamesConstPtr&)> keep_selection =
      [this](const rigid_body_sim::BodyNamesConstPtr& message) { selection_ = *message; };
  selection_topic_ = ros_.subscribe<rigid_body_sim::BodyNames>(node + "/selected_bodies", 1, keep_selection);
  publisher_ = ros_.advertise<Feedback>(node + "/interactive_bodies/mouse", kQueue,
                                        [this](const ros::SingleSubscriberPublisher& newcomer) {
                                          const ros::WallTime oldest = ros::WallTime::now() - kKept;
                                          for (const auto& [time, feedback] : unheard_)
                                            if (time > oldest) newcomer.publish(feedback);
                                          unheard_.clear();
                                        });
}

const rigid_body_sim::BodyDescription* SimulatorBodies::find(std::uint64_t low_id) const {
  constexpr std::uint64_t kLow = 0x7fffffff;
  const auto& bodies = descriptions_.bodies;
  const auto it = std::find_if(bodies.begin(), bodies.end(),
                               [&](const auto& body) { return (body.id & kLow) == low_id; });
  return it == bodies.end() ? nullptr : &*it;
}

MenuScope SimulatorBodies::menuScope(const std::string& body) const {
  const std::unordered_set<std::string> names(selection_.names.begin(), selection_.names.end());
  if (names.count(body) == 0) return {};
  std::vector<std::uint64_t> ids;
  for (const auto& each : descriptions_.bodies)
    if (names.count(each.name) != 0) ids.push_back(each.id);
  return rbs::menuScope(ids);
}

// A call of a service has no time-out, so it is made on a thread of its own, which owns all that it needs.
void SimulatorBodies::meet(const geometry_msgs::Point& origin, const geometry_msgs::Vector3& direction,
                           WithAnswer then) {
  constexpr int kPeriod = 5, kPatience = 200;  // ms
  rigid_body_sim::CastRay ray;
  ray.request.origin = origin;
  ray.request.direction = direction;
  for (const auto& body : descriptions_.bodies)
    if (isSeeThrough(body)) ray.request.ignore.push_back(body.name);
  auto promise = std::make_shared<std::promise<std::optional<Met>>>();
  const std::shared_future<std::optional<Met>> answer = promise->get_future().share();
  std::thread([promise, ray, node = node_] { promise->set_value(ask(node, ray)); }).detach();
  auto* const timer = new QTimer(&answers_);
  QElapsedTimer since;
  since.start();
  QObject::connect(timer, &QTimer::timeout, timer, [timer, since, answer, then] {
    const bool is_there = answer.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
    if (!is_there && since.elapsed() < kPatience) return;
    timer->stop();
    timer->deleteLater();
    then(is_there ? Answer{true, answer.get()} : Answer{});
  });
  timer->start(kPeriod);
}

void SimulatorBodies::send(const Feedback& feedback) {
  if (listens() && unheard_.empty()) return publisher_.publish(feedback);
  if (feedback.event_type == Feedback::MOUSE_DOWN) unheard_.clear();  // nobody waits for an earlier drag
  unheard_.emplace_back(ros::WallTime::now(), feedback);
}

}  // namespace rbs
