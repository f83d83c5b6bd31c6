// The optional effects: each adds its load to the bodies on its own list, and says when it is needed.
#pragma once

#include "context.h"

namespace rbs {

namespace gravity {
Need need(const Census& census);
void run(Context& context);
}  // namespace gravity

/// Forces and couples that were asked for until a given time.
namespace wrenches {
Need need(const Census& census);
void run(Context& context);
}  // namespace wrenches

/// Springs by which a hand pulls at a body.
namespace grabs {
Need need(const Census& census);
void run(Context& context);
}  // namespace grabs

/// Quadratic drag towards the velocity of the air.
namespace drag {
Need need(const Census& census);
void run(Context& context);
}  // namespace drag

/// Bodies led by a hand: their twist is set so that they reach their target.
namespace holds {
Need need(const Census& census);
void run(Context& context);
}  // namespace holds

/// The velocity of the air at a time, gust included, m/s in W.
Vec3 airVelocity(const SceneDef& settings, double time);

}  // namespace rbs
