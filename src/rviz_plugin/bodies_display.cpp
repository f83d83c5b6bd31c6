// SPDX-License-Identifier: BSD-3-Clause
#include "bodies_display.h"

#include "legend_row.h"

#include <OgreCamera.h>
#include <OgreSceneNode.h>
#include <OgreViewport.h>
#include <ros/message_traits.h>
#include <rviz/display_context.h>
#include <rviz/display_group.h>
#include <rviz/frame_manager.h>
#include <rviz/properties/status_property.h>
#include <std_srvs/Trigger.h>

#include <algorithm>
#include <cmath>
#include <limits>
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
  addOptions();
}

void BodiesDisplay::addOptions() {
  color_by_ = new rviz::EnumProperty("Color By", "Material", "", this, SLOT(explainColors()));
  color_by_->addOption("Material", static_cast<int>(ColorBy::Material));
  color_by_->addOption("Island", static_cast<int>(ColorBy::Island));
  color_by_->addOption("Awake", static_cast<int>(ColorBy::Awake));
  color_by_->addOption("Speed", static_cast<int>(ColorBy::Speed));
  color_by_->addOption("Solver", static_cast<int>(ColorBy::Solver));
  color_by_->addOption("Error", static_cast<int>(ColorBy::Error));
  fastest_ = new rviz::FloatProperty("Fastest", 5.0f, "Speed at the bright end of the colours, m/s.",
                                     color_by_, SLOT(explainColors()), this);
  fastest_->setMin(1e-3f);
  largest_error_ = new rviz::FloatProperty("Largest Error", 0.0f,
                                           "Error at the bright end of the colours, m; the dark end is a "
                                           "thousandth of it. 0: the power of ten above the largest one.",
                                           color_by_, SLOT(explainColors()), this);
  largest_error_->setMin(0.0f);
  const auto option = [this](const QString& name, bool on, const QString& what, const char* slot = nullptr) {
    return new rviz::BoolProperty(name, on, what, this, slot);
  };
  shadows_ = option("Shadows", true, "A soft spot on the floor straight below each body: how high it is.");
  trails_ = option("Trails", false, "The ways that the centres of dynamic bodies have gone.");
  trail_seconds_ =
      new rviz::FloatProperty("Duration", 2.0f, "How long a trail stays, s of simulation.", trails_);
  trail_seconds_->setMin(0.05f);
  names_ = option("Names", false, QString("The names of the %1 nearest bodies.").arg(NamesVisual::kMost));
  axes_ =
      option("Axes", false, "The principal axes of each body that is not static: x red, y green, z blue.");
  centres_ = option("Centres of Mass", false,
                    "A chequered ball at the centre of mass of each body that is not static.");
  bounds_ = option("Bounding Boxes", false,
                   "The bounds of each body that is not static, along the axes of the world.");
  points_ =
      option("Contact Points", false, "A dot at each contact point of ~contacts.", SLOT(followOptions()));
  forces_ =
      option("Contact Forces", false,
             "The mean forces over the last step on the body that was created later: the normal force in "
             "blue, friction in orange.",
             SLOT(followOptions()));
  force_scale_ =
      new rviz::FloatProperty("Scale", 0.0f,
                              "Length of an arrow, m per N. 0: the largest force is drawn as long as a "
                              "body is wide; the status has the scale.",
                              forces_);
  force_scale_->setMin(0.0f);
  cones_ = option("Friction Cones", false, "What the force at each contact point cannot leave.",
                  SLOT(followOptions()));
  explainColors();
}

Coloring BodiesDisplay::coloring() const {
  Coloring coloring;
  coloring.by = static_cast<ColorBy>(color_by_->getOptionInt());
  coloring.fastest = fastest_->getFloat();
  if (error_range_ > 0.0f) coloring.largest = error_range_;
  if (largest_error_->getFloat() > 0.0f) coloring.largest = largest_error_->getFloat();
  return coloring;
}

void BodiesDisplay::explainColors() {
  const Coloring colors = coloring();
  color_by_->setDescription(
      QString::fromStdString("What the colours stand for. Now: " + sentenceOf(colors) + "."));
  fastest_->setHidden(colors.by != ColorBy::Speed);
  largest_error_->setHidden(colors.by != ColorBy::Error);
  showLegend();
  if (!isEnabled() || !visuals_) return;
  followOptions();
  showColors();
}

void BodiesDisplay::showLegend() {
  for (rviz::Property* const row : legend_) delete row;
  legend_.clear();
  const Coloring colors = coloring();
  for (const LegendEntry& entry : legendOf(colors)) legend_.push_back(new LegendRow(entry, color_by_));
  if (colors.by != legend_of_ && !legend_.empty()) color_by_->expand();
  legend_of_ = colors.by;
}

// What the colours say, or why they say nothing.
void BodiesDisplay::showColors() {
  const Coloring colors = coloring();
  const auto has_distance = [](const BodyDetail& detail) { return detail.distance.has_value(); };
  if (colors.needsDetails() && !details_message_) {
    setStatus(StatusProperty::Warn, "Colors",
              QString("No message of %1/body_details yet").arg(node().c_str()));
  } else if (colors.by == ColorBy::Error && !details_message_->reference_distances.empty() &&
             details_message_->reference_age > 0.0) {
    setStatus(StatusProperty::Ok, "Colors",
              QString("%1; %2 s ago, since the reference run is behind")
                  .arg(sentenceOf(colors).c_str())
                  .arg(details_message_->reference_age, 0, 'f', 2));
  } else if (colors.by == ColorBy::Error && std::none_of(details_.begin(), details_.end(), has_distance)) {
    setStatus(
        StatusProperty::Warn, "Colors",
        "No reference run to compare with: switch it on in the panel Simulation (Accuracy, Reference), or "
        "call show_ghost");
  } else {
    setStatusStd(StatusProperty::Ok, "Colors", sentenceOf(colors));
  }
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
  visuals_ = std::make_unique<Visuals>(*context_, *scene_node_);
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
  try {
    const std::string topic = update_nh_.resolveName(topic_->getTopicStd());
    return topic.substr(0, topic.rfind('/'));
  } catch (const ros::InvalidNameException&) {
    return {};
  }
}

template <class Message>
ros::Subscriber BodiesDisplay::listen(const std::string& topic) {
  constexpr std::uint32_t kQueue = 10;
  using Pointer = boost::shared_ptr<const Message>;
  const boost::function<void(const Pointer&)> receive = [inbox = inbox_](const Pointer& message) {
    inbox->receive(message);
  };
  return threaded_nh_.subscribe<Message>(topic, kQueue, receive);
}

// What is known of the same topic stays until a state comes.
void BodiesDisplay::subscribe() {
  unsubscribe();
  if (topic_->getTopicStd() != known_topic_) playback_.clear();
  known_topic_ = topic_->getTopicStd();
  if (!isEnabled() || !visuals_) return;
  inbox_ = std::make_shared<BodyInbox>();
  try {
    states_ = listen<rigid_body_sim::BodyStates>(topic_->getTopicStd());
    descriptions_ = listen<rigid_body_sim::BodyDescriptions>(node() + "/body_descriptions");
    selection_topic_ =
        update_nh_.subscribe(node() + "/selected_bodies", 1, &BodiesDisplay::receiveSelection, this);
    explainColors();
    setStatus(StatusProperty::Warn, "Topic", "No message received");
    askAgain();
  } catch (const ros::Exception& error) {
    inbox_.reset();
    setStatus(StatusProperty::Error, "Topic", QString("Cannot subscribe: ") + error.what());
  }
}

// Where another part of RViz listens to the states as well, the simulator sees nobody new, and would send none while
// it is paused. A bag has no such service, and goes on anyway.
void BodiesDisplay::askAgain() {
  worker_ = std::make_unique<ServiceWorker>();
  worker_->call<std_srvs::Trigger>(node() + "/republish", {});
}

// What only an option needs is only listened to for that option.
void BodiesDisplay::followOptions() {
  const bool needs_contacts = inbox_ && shownContacts().any();
  const bool needs_details = inbox_ && coloring().needsDetails();
  const bool needs_step = inbox_ && shownContacts().forces;
  if (!needs_contacts) contacts_topic_.shutdown(), contacts_message_.reset(), contacts_.clear();
  if (!needs_details)
    details_topic_.shutdown(), details_message_.reset(), details_.clear(), error_range_ = 0.0f;
  if (!needs_step) status_topic_.shutdown(), step_ = 0.0, deleteStatus("Forces");
  if (needs_contacts && !contacts_topic_)
    contacts_topic_ = listen<rigid_body_sim::Contacts>(node() + "/contacts");
  if (needs_details && !details_topic_)
    details_topic_ = listen<rigid_body_sim::BodyDetails>(node() + "/body_details");
  if (needs_step && !status_topic_) status_topic_ = listen<rigid_body_sim::Status>(node() + "/status");
}

void BodiesDisplay::unsubscribe() {
  states_.shutdown();
  descriptions_.shutdown();
  selection_topic_.shutdown();
  worker_.reset();
  inbox_.reset();
  followOptions();
  known_.reset();
  drawn_.reset();
  shown_.clear();
  places_.clear();
  descriptions_count_ = states_count_ = states_shown_ = 0;
  if (!visuals_) return;
  visuals_->clear();
  clearStatuses();
}

void BodiesDisplay::update(float, float) {
  if (!inbox_) return;
  takeIn(inbox_->take());
  const std::vector<BodyPlace> all = playback_.at(
      interpolates_->getBool() ? ros::WallTime::now().toSec() : std::numeric_limits<double>::infinity());
  if (playback_.catalog() != known_) {
    known_ = playback_.catalog();
    leaveOutHidden();
    visuals_->bodies.setCatalog(drawn_, node());
    visuals_->trails.clear();
    readContacts();
    readDetails();
  }
  places_.clear();
  if (!all.empty())
    for (const std::size_t k : shown_) places_.push_back(all[k]);
  if (!reported_.isValid() || reported_.elapsed() >= 1000) showCounts();
  if (!drawn_ || !place()) return;
  draw();
}

void BodiesDisplay::Visuals::clear() {
  bodies.setCatalog(nullptr, "");
  shadows.clear();
  guides.clear();
  trails.clear();
  contacts.clear();
  names.clear();
}

void BodiesDisplay::draw() {
  const Eye eye = eyeOf(*context_, *scene_node_);
  const std::vector<Ogre::ColourValue> colors = colorsOf(*drawn_, places_, details_, coloring());
  visuals_->bodies.draw(places_, colors, eye);
  const GuidesVisual::Shown guides = shownGuides();
  shadows_->getBool() ? visuals_->shadows.draw(*drawn_, places_, eye) : visuals_->shadows.clear();
  guides.any() ? visuals_->guides.draw(*drawn_, places_, guides, eye) : visuals_->guides.clear();
  names_->getBool() ? visuals_->names.draw(*drawn_, places_, eye) : visuals_->names.clear();
  shownContacts().any() ? drawContacts(eye) : visuals_->contacts.clear();
  if (trails_->getBool())
    visuals_->trails.draw(*drawn_, places_, colors, playback_.stamp(), trail_seconds_->getFloat(), eye);
  else
    visuals_->trails.clear();
}

void BodiesDisplay::drawContacts(const Eye& eye) {
  const float scale = visuals_->contacts.draw(*drawn_, contacts_, shownContacts(), static_cast<float>(step_),
                                              force_scale_->getFloat(), eye);
  if (shownContacts().forces && step_ > 0.0)
    setStatus(StatusProperty::Ok, "Forces",
              QString("%1 contact points, %2 m/N").arg(contacts_.size()).arg(scale, 0, 'g', 2));
}

GuidesVisual::Shown BodiesDisplay::shownGuides() const {
  return {axes_->getBool(), centres_->getBool(), bounds_->getBool()};
}

ContactsVisual::Shown BodiesDisplay::shownContacts() const {
  return {points_->getBool(), forces_->getBool(), cones_->getBool()};
}

void BodiesDisplay::takeIn(BodyInbox::Content content) {
  for (auto& catalog : content.catalogs) playback_.add(std::move(catalog));
  for (auto& frame : content.frames) playback_.add(std::move(frame));
  for (const std::string& complaint : content.complaints)
    setStatusStd(StatusProperty::Error, "Last refused message", complaint);
  descriptions_count_ += content.descriptions;
  states_count_ += content.states;
  if (std::isfinite(content.step) && content.step > 0.0) step_ = content.step;
  if (content.contacts && contacts_topic_) {
    contacts_message_ = content.contacts;
    readContacts();
  }
  if (content.details && details_topic_) {
    details_message_ = content.details;
    readDetails();
  }
}

void BodiesDisplay::readDetails() {
  details_.clear();
  if (!details_message_ || !drawn_) return;
  try {
    details_ = rbs::readDetails(*details_message_, *drawn_);
  } catch (const BadMessage& error) {
    setStatus(StatusProperty::Error, "Last refused message", QString("Details: %1.").arg(error.what()));
  }
  const float range = errorRange(details_, error_range_);
  if (range != error_range_ && coloring().by == ColorBy::Error) {
    error_range_ = range;
    explainColors();
  } else {
    showColors();
  }
}

void BodiesDisplay::readContacts() {
  contacts_.clear();
  if (!contacts_message_ || !drawn_) return;
  try {
    contacts_ = rbs::readContacts(*contacts_message_, *drawn_);
  } catch (const BadMessage& error) {
    setStatus(StatusProperty::Error, "Last refused message", QString("Contacts: %1.").arg(error.what()));
  }
}

void BodiesDisplay::showCounts() {
  const double seconds = reported_.isValid() ? 1e-3 * static_cast<double>(reported_.restart()) : 0.0;
  if (!reported_.isValid()) reported_.start();
  const std::size_t news = states_count_ - states_shown_;
  states_shown_ = states_count_;
  if (states_count_ + descriptions_count_ > 0)
    setStatus(StatusProperty::Ok, "Topic",
              QString("%1 states and %2 descriptions received").arg(states_count_).arg(descriptions_count_));
  if (playback_.waits()) {
    setStatus(StatusProperty::Warn, "Bodies",
              QString("The states wait for the descriptions of version %1").arg(playback_.awaitedVersion()));
  } else if (known_) {
    setStatus(StatusProperty::Ok, "Bodies",
              QString("%1 bodies, %2 Hz")
                  .arg(known_->bodies.size())
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

void BodiesDisplay::receiveSelection(const rigid_body_sim::BodyNames& selection) {
  if (visuals_) visuals_->bodies.setHighlighted({selection.names.begin(), selection.names.end()});
}

namespace {

void collectDisplays(rviz::DisplayGroup& group, std::vector<BodiesDisplay*>& displays) {
  for (int i = 0; i < group.numDisplays(); ++i) {
    if (rviz::DisplayGroup* const inner = group.getGroupAt(i)) collectDisplays(*inner, displays);
    auto* const display = qobject_cast<BodiesDisplay*>(group.getDisplayAt(i));
    if (display) displays.push_back(display);
  }
}

}  // namespace

std::vector<BodiesDisplay*> BodiesDisplay::allIn(rviz::DisplayContext& context) {
  std::vector<BodiesDisplay*> displays;
  collectDisplays(*context.getRootDisplayGroup(), displays);
  return displays;
}

std::string BodiesDisplay::nameOf(std::uint64_t low_id) const {
  if (drawn_)
    for (const CatalogBody& body : drawn_->bodies)
      if ((body.id & kLowId) == low_id) return body.name;
  return {};
}

void BodiesDisplay::setHovered(std::optional<std::uint64_t> low_id) {
  if (visuals_) visuals_->bodies.setHovered(low_id);
}

void BodiesDisplay::setHidden(const std::set<std::string>& names) {
  if (names == hidden_) return;
  hidden_ = names;
  known_.reset();  // the next picture begins anew
}

// What is hidden is as if it were not there, for every visual.
void BodiesDisplay::leaveOutHidden() {
  shown_.clear();
  drawn_ = known_;
  if (!known_) return;
  for (std::size_t k = 0; k < known_->bodies.size(); ++k)
    if (hidden_.count(known_->bodies[k].name) == 0) shown_.push_back(k);
  if (shown_.size() == known_->bodies.size()) return;
  auto rest = std::make_shared<BodyCatalog>();
  rest->version = known_->version;
  rest->frame = known_->frame;
  for (const std::size_t k : shown_) {
    rest->by_name.emplace(known_->bodies[k].name, rest->bodies.size());
    rest->bodies.push_back(known_->bodies[k]);
  }
  drawn_ = rest;
}

std::vector<std::string> BodiesDisplay::namesIn(const QRect& pixels, const Ogre::Viewport& viewport) const {
  std::vector<std::string> names, see_through;
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
    if (!pixels.contains(pixel)) continue;
    const CatalogBody& body = drawn_->bodies[k];
    (body.isSeeThrough() ? see_through : names).push_back(body.name);
  }
  return names.empty() ? see_through : names;
}

}  // namespace rbs

PLUGINLIB_EXPORT_CLASS(rbs::BodiesDisplay, rviz::Display)
