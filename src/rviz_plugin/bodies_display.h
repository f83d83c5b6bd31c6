// SPDX-License-Identifier: BSD-3-Clause
// BodiesDisplay: a display of RViz that draws the bodies of a simulator.
#pragma once

#include "bodies_visual.h"
#include "body_colors.h"
#include "body_inbox.h"
#include "body_playback.h"
#include "contacts_visual.h"
#include "guides_visual.h"
#include "names_visual.h"
#include "service_worker.h"
#include "shadow_visual.h"
#include "trails_visual.h"

#include <rigid_body_sim/BodyNames.h>
#include <rviz/display.h>
#include <rviz/properties/bool_property.h>
#include <rviz/properties/enum_property.h>
#include <rviz/properties/float_property.h>
#include <rviz/properties/ros_topic_property.h>

#include <QElapsedTimer>
#include <QRect>

#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace Ogre {
class Viewport;
}

namespace rbs {

/// Follows ~body_states and what the node publishes beside it. Draws thousands of bodies by a few draw calls;
/// each can be clicked, selected and focused on. Those that are selected (~selected_bodies) are outlined and brighter.
class BodiesDisplay : public rviz::Display {
  Q_OBJECT
 public:
  BodiesDisplay();
  ~BodiesDisplay() override;

  void setTopic(const QString& topic, const QString& datatype) override;
  void update(float wall_dt, float ros_dt) override;
  void reset() override;

  /// Those of a window, disabled ones too.
  static std::vector<BodiesDisplay*> allIn(rviz::DisplayContext& context);

  /// The resolved name of the simulator's node, which is the namespace of the topic; empty for a topic that ROS
  /// does not take.
  std::string node() const;
  /// The name of the drawn body whose id has these lower 31 bits; empty for an unknown one.
  std::string nameOf(std::uint64_t low_id) const;
  /// Draws the body whose id has these lower 31 bits a little brighter; empty: none.
  void setHovered(std::optional<std::uint64_t> low_id);
  /// Does not draw the bodies of these names.
  void setHidden(const std::set<std::string>& names);
  /// The names of the bodies, other than planes, whose centres are drawn inside a rectangle of pixels of a
  /// viewport, hidden or not. See-through static bodies, as walls are, only where there are no others.
  std::vector<std::string> namesIn(const QRect& pixels, const Ogre::Viewport& viewport) const;

 protected:
  void onInitialize() override;
  void onEnable() override;
  void onDisable() override;

 private Q_SLOTS:
  void subscribe();
  void followOptions();
  void explainColors();

 private:
  /// What is drawn; there is none where the graphics driver cannot do it.
  struct Visuals {
    Visuals(rviz::DisplayContext& context, Ogre::SceneNode& node)
        : bodies(context, node), shadows(node), guides(node), trails(node), contacts(node), names(node) {}
    void clear();

    BodiesVisual bodies;
    ShadowVisual shadows;
    GuidesVisual guides;
    TrailsVisual trails;
    ContactsVisual contacts;
    NamesVisual names;
  };

  void addOptions();
  template <class Message>
  ros::Subscriber listen(const std::string& topic);
  void askAgain();
  void unsubscribe();
  void takeIn(BodyInbox::Content content);
  void readContacts();
  void readDetails();
  void receiveSelection(const rigid_body_sim::BodyNames& selection);
  void leaveOutHidden();
  void showCounts();
  bool place();
  void draw();
  void drawContacts(const Eye& eye);
  void showLegend();
  void showColors();
  Coloring coloring() const;
  GuidesVisual::Shown shownGuides() const;
  ContactsVisual::Shown shownContacts() const;

  rviz::RosTopicProperty* topic_;
  rviz::BoolProperty *interpolates_, *shadows_, *trails_, *names_, *axes_, *centres_, *bounds_, *points_,
      *forces_, *cones_;
  rviz::EnumProperty* color_by_;
  rviz::FloatProperty *fastest_, *largest_error_, *trail_seconds_, *force_scale_;
  std::vector<rviz::Property*> legend_;  ///< lines below color_by_, which owns them
  ColorBy legend_of_ = ColorBy::Material;
  std::shared_ptr<BodyInbox> inbox_;  ///< shared with the callbacks, which may still run
  ros::Subscriber descriptions_, states_, contacts_topic_, details_topic_, status_topic_, selection_topic_;
  std::unique_ptr<ServiceWorker> worker_;  ///< null: nothing is asked
  BodyPlayback playback_;
  std::string known_topic_;  ///< of what playback_ knows
  std::set<std::string> hidden_;
  std::shared_ptr<const BodyCatalog> known_;             ///< hidden bodies included
  std::shared_ptr<const BodyCatalog> drawn_;             ///< that the visuals know
  std::vector<std::size_t> shown_;                       ///< place in known_ of each body of drawn_
  std::vector<BodyPlace> places_;                        ///< of drawn_
  rigid_body_sim::ContactsConstPtr contacts_message_;    ///< the newest; null: none
  std::vector<DrawnContact> contacts_;                   ///< of that message
  rigid_body_sim::BodyDetailsConstPtr details_message_;  ///< the newest; null: none
  std::vector<BodyDetail> details_;                      ///< of that message, by body of drawn_
  float error_range_ = 0.0f;                             ///< of those details, m; 0: none yet
  double step_ = 0.0;                                    ///< length of a step, s; 0: not known
  std::unique_ptr<Visuals> visuals_;
  std::size_t descriptions_count_ = 0, states_count_ = 0;  ///< messages since the subscription
  std::size_t states_shown_ = 0;                           ///< states_count_ when it was last reported
  QElapsedTimer reported_;                                 ///< since the status reported the counts
};

}  // namespace rbs
