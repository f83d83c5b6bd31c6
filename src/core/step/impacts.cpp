// SPDX-License-Identifier: BSD-3-Clause
#include "step/impacts.h"

#include "base/text.h"
#include "base/tolerances.h"
#include "narrowphase/collide.h"
#include "narrowphase/time_of_impact.h"
#include "solver/contact_preparation.h"
#include "solver/impact_law.h"
#include "solver/rolling.h"
#include "step/contact_states.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace rbs::impacts {

namespace {

// Points of a manifold that take part in an impact: within this share of the smaller length of touching. The
// wide margin is for bodies in contact, whose trajectory was predicted without the forces of that contact.
constexpr double kTight = 1e-9, kWide = 1e-3;
// An overlap deeper than this share of the smaller length is more than rounding leaves of an impact.
constexpr double kSunk = 1e-6;

// Of an elastic pair, at any setting: the closing speed below which an impact is left to the contact solver,
// as a fraction of what gravity adds in a step, and the gap too small to matter, as one of the smaller
// length.
constexpr double kElasticSpeed = 0.02, kElasticGap = 1e-12;

// Whether no contact pushes a body now. Others of its island may be pushed: they have not met it.
bool isAlone(const Context& context, Index i) {
  if (!context.scene.bodies.traits[i].moved_by_forces()) return true;
  return !context.step.supported[i] && !context.step.touched[i];
}

double marginOf(const Context& context, Index i, Index j) {
  const bool exact = (isAlone(context, i) && isAlone(context, j)) || context.step.solver.exact;
  return (exact ? kTight : kWide) * smallerLength(context.scene.bodies, i, j);
}

ImpactSide sideOf(const Bodies& bodies, Index i, const Motion& trajectory, double time) {
  ImpactSide side;
  Pose pose;
  std::tie(pose, side.twist) = trajectory.stateAt(time);
  side.p_WB = pose.p_WB;
  side.inv_mass = bodies.inertia[i].inv_mass;
  side.inv_inertia_W = bodies.inertia[i].inverseW(pose.q_WB.toRotationMatrix());
  const Traits& traits = bodies.traits[i];
  if (traits.revolved && !traits.round) side.axis_W = pose.q_WB * Vec3::UnitZ();
  return side;
}

// The two bodies at a time, with their manifold.
struct ImpactContact {
  ImpactContact(const Context& context, Index i, Index j, double time, SeparatingAxis& axis) {
    const Bodies& bodies = context.scene.bodies;
    const Motion trajectory_i = trajectoryOf(context, i), trajectory_j = trajectoryOf(context, j);
    a = sideOf(bodies, i, trajectory_i, time);
    b = sideOf(bodies, j, trajectory_j, time);
    const PairConstants pair = pairConstants(context, i, j);
    const StepStore& step = context.step;
    const LastingLimits limits = step.solver.exact ? exactLimits(step, pair)
                                                   : softLimits(step, pair, step.h() / step.solver.sub_steps);
    const double margin = marginOf(context, i, j);
    manifold = contactManifold(bodies, i, trajectory_i, j, trajectory_j, time, time + step.h(), 2.0 * margin,
                               limits, {}, axis);
    // What is within the margin of the nearest point strikes with it. Where that one is open by nearly the margin, rounding would
    // leave out others of the same face.
    const double least = leastSeparation(manifold);
    if (least > margin) manifold.size = 0;
    keepWithin(std::max(least, 0.0) + margin, manifold);
  }
  ImpactSide a, b;
  Manifold manifold;
};

// The largest acceleration that the turn of body i gives to a point of it, m/s².
double turningAcceleration(const Context& context, Index i, const Motion& trajectory) {
  const Traits& traits = context.scene.bodies.traits[i];
  if (traits.round || traits.unbounded) return 0.0;
  const SpinBounds spin = trajectory.spinBounds();
  return traits.bounding_radius * (spin.w * spin.w + spin.change);
}

// The speed below which a rebound along n is not worth an impact of its own: it would be over within the step,
// because gravity, or whatever else drives the pair together along n, adds twice as much in one (a far smaller share
// of it at the exact settings, and for an elastic pair, which would go on to rebound for ever; balls that meet on a floor
// count as driven by a little of it); or it would
// open a gap too small to matter. At a speed u a gap is at most u h after a step, and at most u²/(2 a) where
// an acceleration a closes it again. The first bound makes an end of sequences between three bodies that
// shrink forever, which only pairs that lose energy have. The second makes an end of those that shrink no
// more because time of impact is as exact as that gap.
double slowest(const Context& context, Index i, Index j, const Vec3& n_W) {
  const StepStore& step = context.step;
  const Motion trajectory_i = trajectoryOf(context, i), trajectory_j = trajectoryOf(context, j);
  const Vec3 apart_W = trajectory_i.a_W - trajectory_j.a_W;
  // What does not rebound stays together, however it is driven.
  const bool rebounds = context.scene.restitutionOf(i, j) > 0.0;
  double a = apart_W.norm(), along = rebounds ? std::abs(n_W.dot(apart_W)) : a;
  if (step.supported[i] || step.supported[j]) {
    a = std::max(a, context.scene.gravity_W.norm());
    along = rebounds ? std::max(along, std::abs(n_W.dot(context.scene.gravity_W))) : a;
  }
  const bool lossy = losesEnergy(context.scene, i, j);
  const double gap =
      (lossy ? step.solver.smallest_gap : kElasticGap) * smallerLength(context.scene.bodies, i, j);
  const double most_a =
      a + turningAcceleration(context, i, trajectory_i) + turningAcceleration(context, j, trajectory_j);
  const double unseen = std::max(lossy ? gap / step.h() : 0.0, std::sqrt(2.0 * gap * most_a));
  const double share =
      lossy ? step.solver.slowest_impact : std::min(step.solver.slowest_impact, kElasticSpeed);
  return std::max(share * step.h() * std::max(along, kAcross * a), unseen);
}

// A body on its trajectory: where it is at a time.
struct OnTrajectory {
  OnTrajectory(const Context& context, Index i, double time)
      : traits(context.scene.bodies.traits[i]), trajectory(trajectoryOf(context, i)) {
    std::tie(pose, twist) = trajectory.stateAt(time);
  }
  const Traits& traits;
  const Motion trajectory;
  Pose pose;
  Twist twist;
};

// How far two trajectories bring the surfaces together in `left` s at most, m, where a_W is the acceleration of the one against the
// other, m/s².
double approachOf(const OnTrajectory& a, const OnTrajectory& b, double left, const Vec3& a_W) {
  const Vec3 p_W = a.pose.p_WB - b.pose.p_WB, u_W = a.twist.v_WB - b.twist.v_WB;
  return approach(left, u_W, reachOf(a.traits, b.traits, p_W, u_W, left) * a.trajectory.spinBounds().w,
                  reachOf(b.traits, a.traits, p_W, u_W, left) * b.trajectory.spinBounds().w, a_W);
}

}  // namespace

// Most pairs are too far apart for what is left of the step. A pair that touches already impacts now. Where
// it does not close, it is left to the contact solver, but for a pair that rebounds and that nothing else
// touches: another corner may strike before the end of the step, and a contact would give that blow no
// rebound.
Prediction predict(const Context& context, Index i, Index j, double from, SeparatingAxis& axis) {
  const StepStore& step = context.step;
  const OnTrajectory a(context, i, from), b(context, j, from);
  const Shape &shape_a = a.traits.shape, &shape_b = b.traits.shape;
  const double left = step.t1 - from;
  const double near = approachOf(a, b, left, a.trajectory.a_W - b.trajectory.a_W) + marginOf(context, i, j);
  if (!areWithin(shape_a, a.pose, shape_b, b.pose, near, axis)) return {};
  Prediction prediction;
  const auto isSimple = [](const Traits& traits) { return traits.round || traits.unbounded; };
  const bool simple = isSimple(a.traits) && isSimple(b.traits);
  const auto contactAt = [&](double time) {
    prediction.queries += !simple;
    return ImpactContact(context, i, j, time, axis);
  };
  const auto touchAt = [&](const ImpactContact& at_impact, double time) {
    prediction.touches = true;
    const Vec3& n_W = at_impact.manifold.n_W;
    const double speed = closingSpeed(at_impact.a, at_impact.b, at_impact.manifold);
    if (speed <= slowest(context, i, j, n_W)) {
      const double closed = kTouch * smallerLength(context.scene.bodies, i, j);
      if (time == from && at_impact.manifold.size > 0 && leastSeparation(at_impact.manifold) <= closed)
        prediction.rest_W = n_W;
      return;
    }
    const auto [first, second] = std::minmax(i, j);
    const bool rebounds = context.scene.restitutionOf(i, j) * speed > slowestRebound(context, n_W);
    prediction.impact = PendingImpact{time, first, second, step.stamp[first], step.stamp[second], rebounds};
  };
  if (!simple) {
    const ImpactContact now = contactAt(from);
    const bool rebounds =
        context.scene.restitutionOf(i, j) > 0.0 && isAlone(context, i) && isAlone(context, j);
    if (now.manifold.size > 0) {
      touchAt(now, from);
      if (prediction.impact || !rebounds) return prediction;
      prediction.touches = false;
    }
  }
  if (const auto time =
          timeOfImpact(shape_a, a.trajectory, shape_b, b.trajectory, from, step.t1, &prediction.queries)) {
    touchAt(contactAt(*time), *time);
    return prediction;
  }
  // What overlaps touches, though nothing closes: contacts are to part it.
  prediction.touches =
      gap(shape_a, a.pose, shape_b, b.pose).distance < -kSunk * smallerLength(context.scene.bodies, i, j);
  return prediction;
}

Motion trajectoryOf(const Context& context, Index i) {
  const Bodies& bodies = context.scene.bodies;
  Motion trajectory;
  trajectory.t0 = context.step.timeOf(i);
  trajectory.pose = bodies.pose[i];
  trajectory.twist = bodies.twist[i];
  if (!bodies.traits[i].moved_by_forces() || context.step.supported[i]) return trajectory;
  trajectory.a_W = context.step.load[i].a_W;
  if (bodies.inertia[i].gyroscopic && !bodies.inertia[i].steady) trajectory.top = &bodies.inertia[i];
  return trajectory;
}

bool losesEnergy(const SceneStore& scene, Index i, Index j) {
  return scene.restitutionOf(i, j) < 1.0 || scene.frictionOf(i, j) > 0.0 || rolling::resists(scene, i, j);
}

bool isFree(const Context& context, Index i) {
  const Traits& traits = context.scene.bodies.traits[i];
  const StepStore& step = context.step;
  if (!traits.moved_by_forces()) return true;
  if (!isAlone(context, i) || (step.island[i] != kNone && step.islands[step.island[i]].touching))
    return false;
  const double turn = step.h() * step.h() * step.load[i].torque_W.norm() *
                      context.scene.bodies.inertia[i].inv_moments.maxCoeff();
  return turn * traits.bounding_radius <= (step.solver.exact ? kTight : kWide) * traits.length;
}

double turningSpeed(const Bodies& bodies, Index i) {
  const double w = bodies.traits[i].round ? 0.0 : bodies.twist[i].w_WB.norm();
  return w > 0.0 ? w * bodies.traits[i].bounding_radius : 0.0;  // that of a plane is infinite
}

bool isStoppedByContacts(const Context& context, const PendingImpact& impact, const Vec3& group_W) {
  constexpr double kStoppedTravel = 0.25;  // in that time, of the smaller length
  const StepStore& step = context.step;
  if (impact.rebounds) return false;
  if (!step.solver.exact && context.scene.restitutionOf(impact.i, impact.j) > 0.0) return false;
  const int parts = step.solver.exact ? 1 : step.solver.sub_steps;
  const Bodies& bodies = context.scene.bodies;
  const auto speedOf = [&](Index i) {
    return (bodies.twist[i].v_WB - group_W).norm() + step.h() * step.load[i].a_W.norm() +
           turningSpeed(bodies, i);
  };
  return (speedOf(impact.i) + speedOf(impact.j)) * step.h() / parts <=
         kStoppedTravel * smallerLength(bodies, impact.i, impact.j);
}

namespace {

// Two that touch as the step begins, and do not collide.
struct Rest {
  Index i, j;
  Vec3 n_W;  // from i to j
};

// What is predicted of pairs, beside their states.
struct Predicted {
  std::vector<PendingImpact> impacts;
  std::vector<Rest> rests;
  IndexPairs
      holds;  // touch in this step, and are left to contacts, though no prediction of a body knows of it
  void add(const Predicted& other) {
    impacts.insert(impacts.end(), other.impacts.begin(), other.impacts.end());
    rests.insert(rests.end(), other.rests.begin(), other.rests.end());
    holds.insert(holds.end(), other.holds.begin(), other.holds.end());
  }
};

bool falls(const Context& context, Index i) {
  return context.scene.bodies.traits[i].moved_by_forces() && !context.step.supported[i];
}

// What comes of one contact. It changes nothing but that.
void predictOf(const Context& context, Contact& contact, Predicted& predicted) {
  const StepStore& step = context.step;
  const auto [i, j] = std::pair(contact.i, contact.j);
  // In a crowd bodies are no further from each other than contacts can tell: its impacts would be without number.
  if (contact.state.isDepenetrating() || (step.isCrowded(i) && step.isCrowded(j))) return;
  if (contact.state.isSeparated()) return;
  if (contact.state.isTouching() && context.scene.restitutionOf(i, j) == 0.0) return;
  const Prediction prediction = predict(context, i, j, step.t0, contact.axis);
  if (prediction.impact) {
    predicted.impacts.push_back(*prediction.impact);
    contact.state.awaitImpact();
  } else if (!prediction.touches && isFree(context, i) && isFree(context, j)) {
    contact.state.separate();
  }
  if (!falls(context, i) && !falls(context, j)) return;
  if (prediction.rest_W && !prediction.impact) predicted.rests.push_back({i, j, *prediction.rest_W});
  if (prediction.touches && !prediction.impact) predicted.holds.emplace_back(i, j);
}

// Those bodies, in rising order, that have been found to rest on what does not fall. They are supported now.
std::vector<Index> findSupported(Context& context, const std::vector<Rest>& rests) {
  StepStore& step = context.step;
  std::vector<Index> found;
  const auto support = [&](Index below, Index above, const Vec3& up_W) {
    if (falls(context, below) || !falls(context, above)) return false;
    if (!(step.load[above].a_W.dot(up_W) < 0.0)) return false;
    step.supported[above] = true;
    found.push_back(above);
    return true;
  };
  for (bool more = true; more;) {
    more = false;
    for (const Rest& rest : rests)
      if (support(rest.i, rest.j, rest.n_W) || support(rest.j, rest.i, -rest.n_W)) more = true;
  }
  std::sort(found.begin(), found.end());
  return found;
}

// What comes of the pairs of bodies that have been found to be supported is predicted again. Others may be found to rest on them.
void predictAgain(Context& context, Predicted& predicted) {
  std::vector<Contact>& contacts = context.scene.contacts.active;
  for (;;) {
    const std::vector<Index> found = findSupported(context, predicted.rests);
    if (found.empty()) return;
    const auto isFound = [&](Index i) { return std::binary_search(found.begin(), found.end(), i); };
    const auto isOld = [&](const PendingImpact& impact) { return isFound(impact.i) || isFound(impact.j); };
    auto& impacts = predicted.impacts;
    impacts.erase(std::remove_if(impacts.begin(), impacts.end(), isOld), impacts.end());
    const auto isOfFound = [&](const Contact& contact) { return isFound(contact.i) || isFound(contact.j); };
    for (Contact& contact : contacts)
      if (isOfFound(contact) && (contact.state.awaitsImpact() || contact.state.isSeparated()))
        contact.state.open();
    contact_states::separateResting(context, isOfFound);
    for (Contact& contact : contacts)
      if (isOfFound(contact)) predictOf(context, contact, predicted);
  }
}

// Whether two meet in this step where contacts hold those that are `held` from falling, all the time or some of it.
bool meetWhereHeld(const Context& context, const Contact& contact, const std::vector<char>& held) {
  const StepStore& step = context.step;
  const auto [i, j] = std::pair(contact.i, contact.j);
  const OnTrajectory a(context, i, step.t0), b(context, j, step.t0);
  SeparatingAxis axis = contact.axis;
  for (const auto& [stops_i, stops_j] : {std::pair(true, false), {false, true}, {true, true}}) {
    if ((stops_i && !held[i]) || (stops_j && !held[j])) continue;
    Motion way_i = a.trajectory, way_j = b.trajectory;
    if (stops_i) way_i.a_W = Vec3::Zero();
    if (stops_j) way_j.a_W = Vec3::Zero();
    const double near = approachOf(a, b, step.h(), way_i.a_W - way_j.a_W) + marginOf(context, i, j);
    if (areWithin(a.traits.shape, a.pose, b.traits.shape, b.pose, near, axis) &&
        timeOfImpact(a.traits.shape, way_i, b.traits.shape, way_j, step.t0, step.t1))
      return true;
  }
  return false;
}

// Two that were to fall alike stay apart only while nothing holds the one. Contacts do not tell how long they hold a body that is not
// known to be supported; what it may meet then is left to them too.
void openBesideHeld(Context& context, const IndexPairs& holds) {
  if (holds.empty()) return;
  std::vector<char> held(context.scene.bodies.size(), 0);
  const auto hold = [&](Index i) { held[i] = falls(context, i); };
  for (const auto& [i, j] : holds) hold(i), hold(j);
  for (bool more = true; more;) {
    more = false;
    for (Contact& contact : context.scene.contacts.active) {
      if (!contact.state.isSeparated() || !(held[contact.i] || held[contact.j])) continue;
      if (!meetWhereHeld(context, contact, held)) continue;
      contact.state.open();
      hold(contact.i), hold(contact.j);
      more = true;
    }
  }
}

}  // namespace

// No force is known yet of what has just been put where it lies. It is not in free fall: it would meet the side of a tile that lies
// flush with the one that bears it, and what stands on it would fall into it. So what bears it supports it.
void predict(Context& context) {
  StepStore& step = context.step;
  std::vector<Contact>& contacts = context.scene.contacts.active;
  constexpr std::size_t kPairsOfAPart = 128;
  std::vector<Predicted> parts(Workers::parts(contacts.size(), kPairsOfAPart));
  step.workers->share(contacts.size(), kPairsOfAPart, [&](auto part, auto begin, auto end) {
    for (std::size_t k = begin; k < end; ++k) predictOf(context, contacts[k], parts[part]);
  });
  Predicted predicted;
  for (const Predicted& part : parts) predicted.add(part);
  predictAgain(context, predicted);
  openBesideHeld(context, predicted.holds);
  step.impacts.insert(step.impacts.end(), predicted.impacts.begin(), predicted.impacts.end());
}

namespace {

ImpactLaw lawOf(const SceneStore& scene, Index i, Index j, const Vec3& n_W) {
  const double friction = scene.frictionOf(i, j), restitution = scene.restitutionOf(i, j);
  if (!rolling::resists(scene, i, j)) return {friction, restitution};
  const auto [roll, spin] = rolling::coefficients(scene, i, j);
  return {friction, restitution, rolling::radius(scene.bodies, i, j, n_W), roll, spin};
}

}  // namespace

Outcome resolve(Context& context, Contact& contact, double time) {
  Bodies& bodies = context.scene.bodies;
  const Index i = contact.i, j = contact.j;
  ImpactContact at_impact(context, i, j, time, contact.axis);
  // What has an impact at its own time, before it comes there, has not been accelerated until then: that would add energy.
  if (context.step.island[i] != kNone) at_impact.a.twist = bodies.twist[i];
  if (context.step.island[j] != kNone) at_impact.b.twist = bodies.twist[j];
  const Twist before_a = at_impact.a.twist, before_b = at_impact.b.twist;
  const double speed = closingSpeed(at_impact.a, at_impact.b, at_impact.manifold);
  if (speed <= 0.0) return Outcome::Miss;
  const ImpactLaw law = lawOf(context.scene, i, j, at_impact.manifold.n_W);
  const auto impulses_W = collideBodies(at_impact.a, at_impact.b, at_impact.manifold, law);
  for (int k = 0; k < at_impact.manifold.size; ++k) {
    const ManifoldPoint& point = at_impact.manifold.points[k];
    SolvedPoint solved;
    solved.feature = point.feature;
    solved.p_W = point.p_W, solved.n_W = at_impact.manifold.n_W;
    solved.separation = point.separation;
    solved.setImpulse(impulses_W[k]);
    contact.addEarlier(solved);
  }
  bodies.twist[i].v_WB += at_impact.a.twist.v_WB - before_a.v_WB;
  bodies.twist[i].w_WB += at_impact.a.twist.w_WB - before_a.w_WB;
  bodies.twist[j].v_WB += at_impact.b.twist.v_WB - before_b.v_WB;
  bodies.twist[j].w_WB += at_impact.b.twist.w_WB - before_b.w_WB;
  return law.restitution * speed > slowest(context, i, j, at_impact.manifold.n_W) ? Outcome::Rebound
                                                                                  : Outcome::Stay;
}

}  // namespace rbs::impacts
