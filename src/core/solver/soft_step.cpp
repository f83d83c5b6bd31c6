// SPDX-License-Identifier: BSD-3-Clause
#include "solver/soft_step.h"

#include "effects_built.h"
#include "solver/constraint_kinds.h"

#include <limits>

namespace rbs::soft_step {

namespace {

constexpr double kDamping = 10.0;  // z: stiff contacts must not ring
// The most that the surface of a body may turn in a sub-step, rad, and that a pair may travel and fall
// against each other, share of their smaller length: farther, and a body is past a wall, or its far end on
// the other side of one, before a contact has stopped it. A load sinks in by about what it falls in one.
constexpr double kMostTurn = 0.5, kMostTravel = 0.5, kMostFall = 0.1;

template <class... Kinds>
SoftStep<Kinds...> methodWith(KindList<Kinds...>);
using WithOtherKinds = decltype(methodWith(OtherKinds()));

template <class... Kinds>
bool anyTakes(KindList<Kinds...>, const Context& context, const Subgraph& batch) {
  return (Kinds::takes(context, batch) || ...);
}

template <class Method>
void advanceBy(Context& context, const Subgraph& batch, double t0, double t1) {
  InnerClock clock(context.step.row_seconds);
  Method method(context, batch, t0, t1);
  runInnerStep(method, clock);
}

}  // namespace

Softness softness(double h, double h_full) {
  const double omega = kStiffness / h_full;
  const double x = h * omega * (2.0 * kDamping + h * omega);
  return {omega / (2.0 * kDamping + h * omega), x / (1.0 + x), 1.0 / (1.0 + x)};
}

double longestOfContacts(const Context& context, const Subgraph& batch) {
  const StepStore& step = context.step;
  const Bodies& bodies = context.scene.bodies;
  const double infinite = std::numeric_limits<double>::infinity();
  double travel = infinite, fall = infinite, spin = 0.0;  // s, s², and rad²/s²
  for (const Index k : batch.contacts) {
    const Contact& contact = context.scene.contacts.active[k];
    const Index i = contact.i, j = contact.j;
    const double length = smallerLength(bodies, i, j);
    const double load = (step.load[j].a_W - step.load[i].a_W).norm();
    const double speed = (bodies.twist[j].v_WB - bodies.twist[i].v_WB).norm() + step.h() * load;
    travel = std::min(travel, kMostTravel * length / speed);
    fall = std::min(fall, kMostFall * length / load);
    for (const Index one : {i, j})
      spin = std::max(spin, surfaceSpin(bodies, one, bodies.twist[one].w_WB).squaredNorm());
  }
  return std::min({travel, std::sqrt(fall), kMostTurn / std::sqrt(spin)});
}

double longestSubStep(const Context& context, const Subgraph& batch) {
  return WithOtherKinds::longestSubStep(context, batch);
}

bool hasOtherKinds(const Context& context, const Subgraph& batch) {
  return anyTakes(OtherKinds(), context, batch);
}

void advance(Context& context, const Subgraph& batch, double t0, double t1) {
  if (!(t1 > t0)) return;
  hasOtherKinds(context, batch) ? advanceBy<WithOtherKinds>(context, batch, t0, t1)
                                : advanceBy<SoftStep<>>(context, batch, t0, t1);
}

}  // namespace rbs::soft_step
