// SPDX-License-Identifier: BSD-3-Clause
#include "step/contact_states.h"

#include "base/tolerances.h"
#include "narrowphase/collide.h"
#include "solver/contact_preparation.h"
#include "step/constraints.h"

#include <vector>

namespace rbs::contact_states {

namespace {

// Two that rest may come together this many times as fast as they move when the step begins.
constexpr double kSurprise = 4.0;
// Pairs that a thread takes at a time.
constexpr std::size_t kPairsOfAPart = 256;

bool isMoved(const Context& context, Index i) {
  return context.scene.bodies.traits[i].moved_by_forces();
}

// What is left of the load of a body when contacts carry its weight, m/s^2.
Vec3 loadBesideWeight(const Context& context, Index i) {
  if (!isMoved(context, i)) return Vec3::Zero();
  return context.step.load[i].a_W - context.scene.gravity_W;
}

// Whether contacts carry a body that hardly moves, or forces do not move it.
bool rests(const Context& context, Index i) {
  if (!isMoved(context, i)) return true;
  return context.step.supported[i] &&
         context.scene.bodies.mostSpeed(i) <= context.step.h() * orEarths(context.scene.gravity_W.norm());
}

// Whether two that rest stay apart in this step, if what carries them goes on to do so. Where it does not, the search after
// the step finds them in each other (missed_contacts.h). What another body may drag along does not count as at rest.
bool stayApart(const Context& context, const Contact& contact, const std::vector<char>& tied) {
  const Bodies& bodies = context.scene.bodies;
  const Index i = contact.i, j = contact.j;
  if (!rests(context, i) || !rests(context, j)) return false;
  if (!tied.empty() && (tied[i] || tied[j])) return false;
  const Traits &a = bodies.traits[i], &b = bodies.traits[j];
  const Pose &X_i = bodies.pose[i], &X_j = bodies.pose[j];
  const double h = context.step.h();
  const Vec3 p_W = X_j.p_WB - X_i.p_WB, u_W = bodies.twist[j].v_WB - bodies.twist[i].v_WB;
  const double near = approach(h, u_W, reachOf(a, b, p_W, u_W, h) * bodies.twist[i].w_WB.norm(),
                               reachOf(b, a, p_W, u_W, h) * bodies.twist[j].w_WB.norm(),
                               loadBesideWeight(context, j) - loadBesideWeight(context, i));
  return !areWithin(a.shape, X_i, b.shape, X_j, kSurprise * near + kTouch * smallerLength(bodies, i, j),
                    contact.axis);
}

}  // namespace

void classify(Context& context) {
  std::vector<Contact>& contacts = context.scene.contacts.active;
  for (Contact& contact : contacts) {
    if (contact.state.isDepenetrating() || !contact.bears()) continue;
    if (!isMoved(context, contact.i) && !isMoved(context, contact.j)) continue;
    contact.state.touch();
    for (const Index i : {contact.i, contact.j}) context.step.supported[i] = isMoved(context, i);
  }
  for (const Edge& edge : constraints::otherEdges(context.scene))
    for (const Index i : edge.bodies)
      if (i != kNone) context.step.supported[i] = isMoved(context, i);
  separateResting(context, [](const Contact&) { return true; });
}

void separateResting(Context& context, const std::function<bool(const Contact&)>& of) {
  if (context.step.solver.exact) return;
  std::vector<char> tied;  // by body, by constraints of other kinds; empty: none is
  for (const Edge& edge : constraints::otherEdges(context.scene)) {
    tied.resize(context.scene.bodies.size(), 0);
    for (const Index i : edge.bodies)
      if (i != kNone) tied[i] = isMoved(context, i);
  }
  std::vector<Contact>& contacts = context.scene.contacts.active;
  context.step.workers->share(contacts.size(), kPairsOfAPart, [&](auto, auto begin, auto end) {
    for (std::size_t k = begin; k < end; ++k) {
      PairState& state = contacts[k].state;
      if (state.isCandidate() && of(contacts[k]) && stayApart(context, contacts[k], tied)) state.separate();
    }
  });
}

}  // namespace rbs::contact_states
