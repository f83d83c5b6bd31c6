// SPDX-License-Identifier: BSD-3-Clause
// A soft contact sinks in by F/(m w²), with w a fixed fraction of the rate of the sub-steps, and one pass a sub-step carries
// an impulse one contact further. So the soft step does badly on
//   towers         a tower of n bodies sags by about n²/2 times the sag of one
//   mass ratios    a body on one r times lighter sinks in r times as deep
//   slender bodies on end: their contacts are hardly independent
//   arches         thrust, which friction holds only while the bodies stand as they were put
//   weight near an edge, and bodies that lie on a free one by a point or a line: what sinks in also tilts
//   crushed bodies a light one that a heavy one presses on sinks in until it is squirted out
//   what has lost its support: its warm start is that of forces which are gone
//   what slides, tips over or rolls alone: the solve of one body takes not much longer than its sub-steps.
// A direct solve minds none of them. It is cheap where the forces of the last step still hold, and expensive where bodies
// tumble; there the errors of the soft step do not show. So only islands are promoted that are small and calm: nothing moves
// faster than what gravity adds in a step or two, as seen from something that carries them, or from their centre of mass. What
// stands in a train, or on a sled, stands like that on the ground. Crushed bodies are promoted whatever their speed.
#include "step/solver_choice.h"

#include "solver/solver_contacts.h"

#include "step/depenetration.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace rbs {

namespace {

// What makes an island stiff, and how many pairs a direct solve may have; once for islands that the soft step
// has, once for those that the exact step has.
struct Stiffness {
  std::uint32_t height;
  double mass_ratio, slenderness;
  std::size_t pairs;
  double speed;  // of its bodies' surfaces, share of g h
  double jolt;   // of what carries it, share of g h
};
constexpr Stiffness kEnter{6, 10.0, 10.0, 120, 0.5, 1e-2}, kStay{4, 5.0, 10.0, 160, 2.0, 0.0};

// The most pairs of an island that is exact for the forces in it; and the speed up to which so small a tower is calm, share of
// g h: blocks that are let go a little above each other fall for a step, and the soft step makes them faster still.
constexpr std::size_t kFewPairs = 30;
constexpr double kFewCalm = 3.0;
// The most pairs of a body that is alone; and how fast the surface of one with a rim may turn, share of g h: its rim comes round,
// which asks for many segments of a step.
constexpr std::size_t kSimplePairs = 3;
constexpr double kSteady = 0.01;
// How far something round may go along a body in a step, share of its length, and not run along it.
constexpr double kRunsAlong = 1e-3;
// Two bodies lean on each other where friction is more than this share of the normal force; one of them may
// tip where one of their points has less than this share of the force of another; and it is crushed where the
// force is more than this many times its weight.
constexpr double kThrust = 0.1, kNearEdge = 0.2, kCrushed = 100.0;
// The forces of the last step do not hold an island any more where they push a body along its load by more than this share of gravity.
constexpr double kAlongLoad = 0.25;

// The most contacts on the shortest way from a body to something that forces do not move.
std::uint32_t heightOf(const Context& context, const std::vector<Index>& contacts) {
  const Bodies& bodies = context.scene.bodies;
  const auto& list = context.scene.contacts.active;
  std::map<Index, std::uint32_t> level;  // of bodies that are known to stand on something
  std::uint32_t height = 0;
  // Pairs are few (kStay.pairs) and levels fewer: relaxed until nothing changes.
  for (bool changed = true; changed;) {
    changed = false;
    for (const Index k : contacts) {
      for (const auto& [a, b] : {std::pair(list[k].i, list[k].j), std::pair(list[k].j, list[k].i)}) {
        if (!bodies.traits[b].moved_by_forces()) continue;
        const bool moves = bodies.traits[a].moved_by_forces();
        const auto known = level.find(a);
        if (moves && known == level.end()) continue;
        const std::uint32_t above = (moves ? known->second : 0) + 1;
        const auto [place, is_new] = level.try_emplace(b, above);
        if (!is_new && place->second <= above) continue;
        place->second = above;
        changed = true;
      }
    }
  }
  for (const auto& [body, level_of_one] : level) height = std::max(height, level_of_one);
  return height;
}

// What the forces of the last step say of an island.
struct Forces {
  bool known = false;    // some point has one
  bool leans = false;    // thrust, or weight near an edge
  bool crushes = false;  // a body carries many times its weight
  bool rolls = false;    // a body lies on another by a point or a line
};

Forces forcesOf(const Context& context, const std::vector<Index>& contacts) {
  const Bodies& bodies = context.scene.bodies;
  const double gravity = orEarths(context.scene.gravity_W.norm());
  Forces forces;
  for (const Index k : contacts) {
    const Contact& contact = context.scene.contacts.active[k];
    double least = std::numeric_limits<double>::infinity(), most = 0.0, normal = 0.0;
    Vec3 friction_W = Vec3::Zero();
    for (const SolvedPoint& point : contact.points) {
      least = std::min(least, point.normal), most = std::max(most, point.normal);
      normal += point.normal;
      friction_W += point.friction_W;
    }
    if (normal == 0.0) continue;
    forces.known = true;
    const Traits &a = bodies.traits[contact.i], &b = bodies.traits[contact.j];
    const bool both = a.moved_by_forces() && b.moved_by_forces();
    forces.leans = forces.leans || least < kNearEdge * most || (both && friction_W.norm() > kThrust * normal);
    forces.rolls = forces.rolls || (both && contact.points.size() <= 2);
    forces.crushes = forces.crushes || (both && normal > kCrushed * gravity * std::min(a.mass, b.mass));
  }
  return forces;
}

// The largest acceleration that the forces of the last step give a body along its load in this one, m/s²; of a body without a load the
// largest one. What is held is pushed against its load. So these forces do not hold any more: a support is gone, gravity has turned or
// ended, or a blow is over. The soft step would begin with them, and its passes mend one contact after the other.
double pushAlongLoad(const Context& context, const Island& island) {
  const Bodies& bodies = context.scene.bodies;
  std::vector<Vec3> force_W(island.bodies.size(), Vec3::Zero());  // by place in island.bodies, which rise
  const auto add = [&](Index i, const Vec3& f_W) {
    const auto known = std::lower_bound(island.bodies.begin(), island.bodies.end(), i);
    if (known != island.bodies.end() && *known == i) force_W[known - island.bodies.begin()] += f_W;
  };
  for (const Index k : island.contacts) {
    const Contact& contact = context.scene.contacts.active[k];
    for (const SolvedPoint& point : contact.points) {
      const Vec3 f_W = point.normal * point.n_W + point.friction_W;
      add(contact.i, -f_W);
      add(contact.j, f_W);
    }
  }
  double most = 0.0;
  for (std::size_t k = 0; k < force_W.size(); ++k) {
    const Vec3& load_W = context.step.load[island.bodies[k]].a_W;
    const double along = load_W.isZero(0.0) ? force_W[k].norm() : force_W[k].dot(load_W.normalized());
    most = std::max(most, along / bodies.traits[island.bodies[k]].mass);
  }
  return most;
}

// How fast the surface of a body moves at most as seen from what carries it, which turns on under it. kNone is the world.
double speedSeenFrom(const Bodies& bodies, Index carrier, Index i) {
  const bool moves = carrier != kNone && bodies.traits[carrier].is_kinematic();
  const Twist own = bodies.twist[i], base = moves ? bodies.twist[carrier] : Twist();
  const Vec3 arm_W = moves ? Vec3(bodies.pose[i].p_WB - bodies.pose[carrier].p_WB) : Vec3(Vec3::Zero());
  return (own.v_WB - base.v_WB - base.w_WB.cross(arm_W)).norm() +
         bodies.traits[i].bounding_radius * (own.w_WB - base.w_WB).norm();
}

// What forces do not move and constraints tie to an island, ascending.
std::vector<Index> carriersOf(const Context& context, const Island& island) {
  std::vector<Index> carriers;
  const auto add = [&](Index i) {
    if (i != kNone && !context.scene.bodies.traits[i].moved_by_forces()) carriers.push_back(i);
  };
  for (const Index k : island.contacts) {
    add(context.scene.contacts.active[k].i);
    add(context.scene.contacts.active[k].j);
  }
  for (const Edge& edge : island.edges)
    for (const Index i : edge.bodies) add(i);
  std::sort(carriers.begin(), carriers.end());
  carriers.erase(std::unique(carriers.begin(), carriers.end()), carriers.end());
  return carriers;
}

// Whether no body of an island moves faster than this as seen from one of its carriers: what forces do not move, and the world
// where there is none; or as seen by one that moves with all of them, as on a sled.
bool isCalm(const Context& context, const Island& island, double speed) {
  const Bodies& bodies = context.scene.bodies;
  const Vec3 common_W = bodies.meanVelocity(island.bodies);
  const auto isSlow = [&](Index i) { return bodies.mostSpeed(i, common_W) <= speed; };
  if (std::all_of(island.bodies.begin(), island.bodies.end(), isSlow)) return true;
  std::vector<Index> carriers = carriersOf(context, island);
  if (carriers.empty()) carriers.push_back(kNone);
  return std::any_of(carriers.begin(), carriers.end(), [&](Index carrier) {
    return std::all_of(island.bodies.begin(), island.bodies.end(),
                       [&](Index i) { return speedSeenFrom(bodies, carrier, i) <= speed; });
  });
}

// Whether a kinematic body carries an island and has been given another velocity, which its bodies do not have yet. That jump
// opens contacts, or closes them, and the soft step has only the order of its passes to tell which of them friction goes by.
// An exact island stays so on what moves: if it went back to the soft step, it would sag, and that would count as a jump.
bool isJolted(const Context& context, const Island& island, double least, double most) {
  const Bodies& bodies = context.scene.bodies;
  const auto jolts = [&](Index carrier) {
    if (!bodies.traits[carrier].is_kinematic()) return false;
    if (bodies.twist[carrier].v_WB.isZero(0.0) && bodies.twist[carrier].w_WB.isZero(0.0)) return false;
    double fastest = 0.0;
    for (const Index i : island.bodies) fastest = std::max(fastest, speedSeenFrom(bodies, carrier, i));
    return least <= fastest && fastest <= most;
  };
  const std::vector<Index> carriers = carriersOf(context, island);
  return std::any_of(carriers.begin(), carriers.end(), jolts);
}

// Whether an island is a body that slides, tips over, or rolls on a plane: a direct solve costs it little more than the sub-steps
// of the soft step. What is round and rolls along a body runs over an edge at its end, which the soft step finds in each of its
// sub-steps.
bool isSimple(const Context& context, const Island& island, double fall) {
  const Bodies& bodies = context.scene.bodies;
  if (island.bodies.size() > 1 || island.contacts.size() > kSimplePairs) return false;
  const Index i = island.bodies.front();
  const Traits& traits = bodies.traits[i];
  if (!traits.revolved) return true;
  if (traits.bounding_radius * surfaceSpin(bodies, i, bodies.twist[i].w_WB).norm() > kSteady * fall)
    return false;
  return std::none_of(island.contacts.begin(), island.contacts.end(), [&](Index k) {
    const Contact& contact = context.scene.contacts.active[k];
    const Index other = contact.i == i ? contact.j : contact.i;
    if (bodies.traits[other].unbounded) return false;
    const Vec3 u_W = bodies.twist[i].v_WB - bodies.twist[other].v_WB;
    const Vec3 n_W = contact.points.empty() ? Vec3(Vec3::Zero()) : contact.points.front().n_W;
    return context.step.h() * (u_W - n_W.dot(u_W) * n_W).norm() > kRunsAlong * traits.length;
  });
}

// On what terms an island is given to the exact step.
struct Promotion {
  // The most pairs that the islands with such a bound may have together in a step, this one included; 0: not promoted.
  std::size_t most_pairs;
  // Multiplications that its solves may cost (SolveBudget); then the soft step takes over.
  std::int64_t work_of_body;
};
// An island that moves takes 50 times the work of one at rest. Hundreds of small towers that land at the same time would hold a
// step for a second. A box that slides takes 10,000 multiplications. A box that lands on another edge takes 1 to 2 million. The
// solve of a body that is jammed between two others may not converge.
constexpr Promotion kNever{0, 0}, kAlways{~std::size_t{0}, kWorkPerBody}, kWhileSomeMove{300, kWorkPerBody},
    kWhileFew{30, kWorkPerBody}, kWhileFewMove{30, 2'000'000};

// Whether the soft step would do badly on an island of its form that a direct solve can afford. An island that was exact in the last
// step stays so until it is clearly no longer that kind (hysteresis).
Promotion promotionByForm(const Context& context, const Island& island) {
  const Bodies& bodies = context.scene.bodies;
  const auto& list = context.scene.contacts.active;
  std::vector<Index> touching;
  bool was_exact = false;
  for (const Index k : island.contacts) {
    was_exact = was_exact || list[k].exact;
    if (list[k].state.isTouching()) touching.push_back(k);
  }
  const Stiffness& bounds = was_exact ? kStay : kEnter;
  if (touching.empty())
    touching = island.contacts;  // nothing is known yet of what has just been put together
  if (island.contacts.size() > bounds.pairs) return kNever;
  const bool few = island.contacts.size() <= kFewPairs;
  const Forces forces = few ? forcesOf(context, island.contacts) : Forces{};
  if (forces.crushes) return kAlways;
  const double fall = context.scene.gravity_W.norm() * context.step.h();
  if (few && isJolted(context, island, bounds.jolt * fall, kStay.speed * fall)) return kAlways;
  const auto isTall = [&] {
    return touching.size() >= bounds.height && heightOf(context, touching) >= bounds.height;
  };
  const bool simple = isSimple(context, island, fall);
  if (!isCalm(context, island, bounds.speed * fall)) {
    if (few && isCalm(context, island, kFewCalm * fall) && isTall()) return kWhileSomeMove;
    return simple ? kWhileFewMove : kNever;
  }
  if (few && (!forces.known || forces.rolls || (was_exact && forces.leans))) return kAlways;

  double mass_ratio = 1.0, slenderness = 1.0;
  for (const Index k : island.contacts) {
    const Traits &a = bodies.traits[list[k].i], &b = bodies.traits[list[k].j];
    if (a.moved_by_forces() && b.moved_by_forces())
      mass_ratio = std::max(mass_ratio, std::max(a.mass / b.mass, b.mass / a.mass));
    for (const Traits* t : {&a, &b})
      if (t->moved_by_forces()) slenderness = std::max(slenderness, 2.0 * t->bounding_radius / t->length);
  }
  const bool stiff = mass_ratio >= bounds.mass_ratio || slenderness >= bounds.slenderness || isTall();
  return stiff ? kAlways : simple ? kWhileFew : kNever;
}

// Whether the forces of the last step push a few bodies along their loads, which may just have begun to move.
bool hasLostSupport(const Context& context, const Island& island) {
  if (island.contacts.size() > kFewPairs) return false;
  const double a = pushAlongLoad(context, island), g = orEarths(context.scene.gravity_W.norm());
  const double h = context.step.h();
  return a > kAlongLoad * g &&
         isCalm(context, island, std::min(kEnter.speed * std::max(g, a) * h, kFewCalm * g * h));
}

Promotion promotionOf(const Context& context, const Island& island) {
  const Promotion by_form = promotionByForm(context, island);
  const bool is_weaker = by_form.most_pairs < kWhileSomeMove.most_pairs;
  return is_weaker && hasLostSupport(context, island) ? kWhileSomeMove : by_form;
}

// Whether an exact solve could find the forces that move an island. It knows contacts alone.
bool isForExact(const Context& context, const Island& island) {
  return island.edges.empty() && !depenetration::rulesOver(context, island);
}

}  // namespace

void chooseSolver(Context& context, Island& island) {
  const SolverSettings& settings = context.step.solver;
  const bool can_be = isForExact(context, island);
  island.exact = settings.exact && can_be;
  if (settings.exact || !settings.promotes || island.flies() || !can_be) return;
  const Promotion promotion = promotionOf(context, island);
  const bool is_bounded = promotion.most_pairs != kAlways.most_pairs;
  const std::size_t pairs = island.contacts.size();
  island.exact = !is_bounded || context.step.moving_pairs + pairs <= promotion.most_pairs;
  if (!island.exact) return;
  if (is_bounded) context.step.moving_pairs += island.moving_pairs = pairs;
  island.work_left =
      std::min(island.work_left, promotion.work_of_body * static_cast<std::int64_t>(island.bodies.size()));
}

// One sweep a sub-step halves the speed of a heavy body on one r times lighter about r sub-steps later. On its way until
// then it goes through the light one where that is thinner.
bool isCrushing(const Context& context, const Island& island) {
  const SolverSettings& settings = context.step.solver;
  if (!settings.promotes || island.contacts.size() > kFewPairs || !isForExact(context, island)) return false;
  const Bodies& bodies = context.scene.bodies;
  const double h = context.step.h() / settings.sub_steps;
  // Or has given an impulse earlier in this step: what rattles touches as good as all the time.
  std::vector<const Contact*> touching;
  for (const Index k : island.contacts) {
    const Contact& contact = context.scene.contacts.active[k];
    if (contact.state.isTouching() || contact.state.isMissed() || !contact.earlier.empty())
      touching.push_back(&contact);
  }
  // Whether it is pressed on what else the light one touches.
  const auto crushes = [&](Index heavy, Index light) {
    const Traits &a = bodies.traits[heavy], &b = bodies.traits[light];
    if (!a.moved_by_forces() || !b.moved_by_forces() || a.mass < kEnter.mass_ratio * b.mass) return false;
    return std::any_of(touching.begin(), touching.end(), [&](const Contact* contact) {
      if (contact->i != light && contact->j != light) return false;
      const Index base = contact->i == light ? contact->j : contact->i;
      const double speed = (bodies.twist[heavy].v_WB - bodies.twist[base].v_WB).norm();
      return base != heavy && speed * h * a.mass / b.mass > 0.5 * b.length;
    });
  };
  return std::any_of(touching.begin(), touching.end(), [&](const Contact* contact) {
    return crushes(contact->i, contact->j) || crushes(contact->j, contact->i);
  });
}

// A body that flew joins the method of what it met; of two methods the one that any number of rows can
// afford.
bool isExactTogether(const Context& context, const Island& a, const Island& b) {
  if (context.step.solver.exact) return a.exact && b.exact;
  return (a.exact || a.flies()) && (b.exact || b.flies()) && (a.exact || b.exact);
}

}  // namespace rbs
