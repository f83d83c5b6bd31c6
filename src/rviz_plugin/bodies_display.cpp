// SPDX-License-Identifier: BSD-3-Clause
#include "bodies_display.h"

#include <OgreCamera.h>
#include <OgreSceneNode.h>
#include <OgreViewport.h>
#include <ros/message_traits.h>
#include <rviz/display_context.h>
#include <rviz/frame_manager.h>
#include <rviz/properties/status_property.h>
#include <pluginlib/class_list_macros.hpp>

namespace rbs {
namespace {

using rviz::StatusProperty;

}  // namespace

BodiesDisplay::BodiesDisplay() {
  const QString type = ros::message_traits::datatype<rigid_body_sim::BodyStates>();
  topic_ = new rviz::RosTopicProperty(
      "Topic", "/sim/body_states", type,
      type + " topic of a simulator. What else it publishes is found beside it.", this, SLOT(subscribe()));
  interpolates_ = new rviz::BoolProperty(
      "Smooth Motion", true,
      "Draw the bodies between the states that come, about one and a half messages behind the newest. Off: "
      "where the newest message has them.",
      this);
}

BodiesDisplay::~BodiesDisplay() {
  unsubscribe();
}

void BodiesDisplay::onInitialize() {
  if (!Instances::areSupported()) {
    setStatus(StatusProperty::Error, "Graphics",
              "The graphics driver has no hardware instancing: use a MarkerArray display of "
              "~visualization_marker_array.");
    return;
  }
  bodies_ = std::make_unique<BodiesVisual>(*context_, *scene_node_);
}

void BodiesDisplay::onEnable() {
  subscribe();
}

void BodiesDisplay::onDisable() {
  unsubscribe();
}

void BodiesDisplay::setTopic(const QString& topic, const QString&) {
  topic_->setString(topic);
}

// The states come again to who subscribes anew, also while the simulator is paused.
void BodiesDisplay::reset() {
  rviz::Display::reset();
  subscribe();
}

std::string BodiesDisplay::node() const {
  const std::string topic = update_nh_.resolveName(topic_->getTopicStd());
  return topic.substr(0, topic.rfind('/'));
}

void BodiesDisplay::subscribe() {
  unsubscribe();
  if (!isEnabled() || !bodies_) return;
  constexpr std::uint32_t kQueue = 10;
  inbox_ = std::make_shared<BodyInbox>();
  try {
    const boost::function<void(const rigid_body_sim::BodyDescriptionsConstPtr&)> describe =
        [inbox = inbox_](const rigid_body_sim::BodyDescriptionsConstPtr& message) {
          inbox->receive(message);
        };
    const boost::function<void(const rigid_body_sim::BodyStatesConstPtr&)> move =
        [inbox = inbox_](const rigid_body_sim::BodyStatesConstPtr& message) { inbox->receive(message); };
    states_ = threaded_nh_.subscribe<rigid_body_sim::BodyStates>(topic_->getTopicStd(), kQueue, move);
    descriptions_ = threaded_nh_.subscribe<rigid_body_sim::BodyDescriptions>(node() + "/body_descriptions",
                                                                             kQueue, describe);
    setStatus(StatusProperty::Warn, "Topic", "No message received");
  } catch (const ros::Exception& error) {
    inbox_.reset();
    setStatus(StatusProperty::Error, "Topic", QString("Cannot subscribe: ") + error.what());
  }
}

void BodiesDisplay::unsubscribe() {
  states_.shutdown();
  descriptions_.shutdown();
  inbox_.reset();
  playback_.clear();
  drawn_.reset();
  places_.clear();
  descriptions_count_ = states_count_ = states_shown_ = 0;
  if (!bodies_) return;
  bodies_->setCatalog(nullptr, "");
  clearStatuses();
}

void BodiesDisplay::update(float, float) {
  if (!inbox_) return;
  takeIn(inbox_->take());
  places_ = playback_.at(interpolates_->getBool() ? ros::WallTime::now().toSec()
                                                  : std::numeric_limits<double>::infinity());
  if (playback_.catalog() != drawn_) {
    drawn_ = playback_.catalog();
    bodies_->setCatalog(drawn_, node());
  }
  if (!told_.isValid() || told_.elapsed() >= 1000) showCounts();
  if (!drawn_ || !place()) return;
  std::vector<Ogre::ColourValue> colors;
  for (const CatalogBody& body : drawn_->bodies) colors.push_back(body.color);
  bodies_->draw(places_, colors, eyeOf(*context_, *scene_node_));
}

void BodiesDisplay::takeIn(BodyInbox::Content content) {
  for (auto& catalog : content.catalogs) playback_.add(std::move(catalog));
  for (auto& frame : content.frames) playback_.add(std::move(frame));
  for (const std::string& complaint : content.complaints)
    setStatusStd(StatusProperty::Error, "Last refused message", complaint);
  descriptions_count_ += content.descriptions;
  states_count_ += content.states;
}

void BodiesDisplay::showCounts() {
  const double seconds = told_.isValid() ? 1e-3 * static_cast<double>(told_.restart()) : 0.0;
  if (!told_.isValid()) told_.start();
  const std::size_t news = states_count_ - states_shown_;
  states_shown_ = states_count_;
  if (states_count_ + descriptions_count_ > 0)
    setStatus(StatusProperty::Ok, "Topic",
              QString("%1 states and %2 descriptions received").arg(states_count_).arg(descriptions_count_));
  if (playback_.waits()) {
    setStatus(StatusProperty::Warn, "Bodies",
              QString("The states wait for the descriptions of version %1").arg(playback_.awaitedVersion()));
  } else if (drawn_) {
    setStatus(StatusProperty::Ok, "Bodies",
              QString("%1 bodies, %2 Hz")
                  .arg(drawn_->bodies.size())
                  .arg(seconds > 0.0 ? static_cast<double>(news) / seconds : 0.0, 0, 'f', 0));
  }
}

// The frame of the world in the fixed frame. Nothing is drawn where that is not known.
bool BodiesDisplay::place() {
  Ogre::Vector3 position;
  Ogre::Quaternion orientation;
  const bool is_known =
      context_->getFrameManager()->getTransform(drawn_->frame, ros::Time(), position, orientation);
  scene_node_->setVisible(is_known && isEnabled());
  if (!is_known) {
    std::string trouble = "No transform from '" + drawn_->frame + "' to the fixed frame";
    context_->getFrameManager()->transformHasProblems(drawn_->frame, ros::Time(), trouble);
    setStatusStd(StatusProperty::Error, "Transform", trouble);
    return false;
  }
  setStatus(StatusProperty::Ok, "Transform", "OK");
  scene_node_->setPosition(position);
  scene_node_->setOrientation(orientation);
  return true;
}

void BodiesDisplay::setHighlighted(const std::set<std::string>& names) {
  if (bodies_) bodies_->setHighlighted(names);
}

std::vector<std::string> BodiesDisplay::namesIn(const QRect& pixels, const Ogre::Viewport& viewport) const {
  std::vector<std::string> names;
  const Ogre::Camera& camera = *viewport.getCamera();
  const Ogre::Matrix4 to_eye = camera.getViewMatrix();
  const Ogre::Matrix4 to_view = camera.getProjectionMatrix();
  const auto width = static_cast<float>(viewport.getActualWidth());
  const auto height = static_cast<float>(viewport.getActualHeight());
  for (std::size_t k = 0; k < places_.size(); ++k) {
    if (drawn_->bodies[k].shape == BodyShape::Plane) continue;
    const Ogre::Vector3 seen = to_eye * scene_node_->convertLocalToWorldPosition(places_[k].position);
    if (seen.z >= 0.0f) continue;  // behind the eye
    const Ogre::Vector3 at = to_view * seen;
    const QPoint pixel(static_cast<int>(0.5f * (1.0f + at.x) * width),
                       static_cast<int>(0.5f * (1.0f - at.y) * height));
    if (pixels.contains(pixel)) names.push_back(drawn_->bodies[k].name);
  }
  return names;
}

}  // namespace rbs

PLUGINLIB_EXPORT_CLASS(rbs::BodiesDisplay, rviz::Display)
