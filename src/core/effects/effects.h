// SPDX-License-Identifier: BSD-3-Clause
// The effects: when a scene needs each, and those that are stages of their own.
//
// To add one: a row in Effect and in the table of effects.cpp, its file here with need() and run(), a row in
// the table of stages (pipeline.cpp), its data in scene.h, and its name in the list of CMakeLists.txt.
#pragma once

#include "context.h"

#include <optional>

namespace rbs {

/// Of a centre of mass.
struct Course {
  Vec3 p_WB, v_WB;  ///< m, m/s
};
namespace effects {
/// Whether an effect is simulated, as detected or as forced, and why.
Need need(Effect effect, const Census& census);
/// Whether it is forced off, or left out of this build.
bool isNeglected(Effect effect, const Census& census);
}  // namespace effects

namespace gravity {
Need need(const Census& census);
void run(Context& context);
}  // namespace gravity

/// The weight of the fluid that bodies displace.
namespace buoyancy {
Need need(const Census& census);
void run(Context& context);
}  // namespace buoyancy

/// Quadratic drag towards the velocity of the air, or of a fluid.
namespace drag {
Need need(const Census& census);
void run(Context& context);
/// Where body i of this step is and how fast, `seconds` on from (p_WB, v_WB), when nothing touches it. Empty
/// for bodies that the air turns (boxes) or lets be, and where it stops them at once: there the mean
/// acceleration in step.load says it.
std::optional<Course> fly(const Context& context, Index i, const Vec3& p_WB, const Vec3& v_WB,
                          double seconds);
}  // namespace drag

/// Forces and couples that were asked for until a given time.
namespace wrenches {
Need need(const Census& census);
void run(Context& context);
}  // namespace wrenches

/// User forces: springs that pull bodies to the mouse.
namespace grabs {
Need need(const Census& census);
void run(Context& context);
}  // namespace grabs

/// Bodies that follow a drag, as if kinematic: their twist is set so that they reach their target.
namespace holds {
Need need(const Census& census);
void run(Context& context);
}  // namespace holds

/// The velocity of the air at a time, gust included, m/s in W.
Vec3 airVelocity(const SceneDef& settings, double time);

}  // namespace rbs
