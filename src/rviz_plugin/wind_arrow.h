// SPDX-License-Identifier: BSD-3-Clause
// WindArrow: a display that shows the wind as an arrow.
#pragma once

#include <rigid_body_sim/Wind.h>
#include <rviz/message_filter_display.h>
#include <rviz/ogre_helpers/arrow.h>
#include <rviz/properties/color_property.h>
#include <rviz/properties/float_property.h>
#include <rviz/properties/vector_property.h>

#include <memory>

namespace rbs {

/// It points to where the air moves now, gusts included, and its length is the speed times a scale. Without
/// wind there is none.
class WindArrow : public rviz::MessageFilterDisplay<rigid_body_sim::Wind> {
  Q_OBJECT
 public:
  WindArrow();
  ~WindArrow() override;

  void reset() override;

 protected:
  void onInitialize() override;
  void processMessage(const rigid_body_sim::WindConstPtr& wind) override;

 private:
  void draw();

  std::unique_ptr<rviz::Arrow> arrow_;
  rigid_body_sim::WindConstPtr wind_;  ///< null: none has come
  rviz::VectorProperty* position_;
  rviz::FloatProperty* scale_;
  rviz::ColorProperty* color_;
};

}  // namespace rbs
