// SPDX-License-Identifier: BSD-3-Clause
// What a stage sees: the stores of the scene and of the step.
//
// SceneStore is what the scene holds: it lives from edit to edit and is what a saved state saves.
// StepStore is what one step holds: every stage may rely on what earlier stages of the same step put
// there. Only the memory of the solvers, of restarts and of the workers is kept for the next step, and stores that each step
// writes before it reads them.
#pragma once

#include "base/solve_budget.h"
#include "base/workers.h"
#include "rigid_body_sim/snapshot.h"
#include "rigid_body_sim/world.h"
#include "state/bodies.h"
#include "state/contact.h"
#include "state/fidelity.h"
#include "state/island.h"
#include "state/scene_analysis.h"

#include <array>
#include <chrono>
#include <memory>
#include <optional>
#include <vector>

namespace rbs {

/// A force at a point of a body, and a torque, that act until a given time.
struct TimedWrench {
  BodyId body;
  Vec3 force_W, torque_W;  ///< N, and N m beside that of the force
  Vec3 point_B;            ///< m
  double until;            ///< physics time, s
  bool commanded = false;  ///< the next command takes its place
};

struct BodyGrab {
  BodyId body;
  Grab grab;
};

struct BodyHold {
  BodyId body;
  Pose target;
};

/// Dense lists of bodies, one for each kind of work; remade by analyseScene().
struct BodyLists {
  std::vector<Index> ballistic;   ///< moved by forces, that feel gravity alone and can meet nobody
  std::vector<Index> tumbling;    ///< ballistic, with an orientation that is integrated
  std::vector<Index> in_islands;  ///< awake dynamic bodies that are not ballistic
  std::vector<Index> kinematic;   ///< of kind kinematic, or dragged
  std::vector<Index> collidable;  ///< that may meet another, planes left out
  std::vector<Index> planes;      ///< that may meet another
  /// By effect, of forces with a list of their own (effects.h): awake dynamic bodies that feel it.
  std::array<std::vector<Index>, kEffects.size()> feeling;

  const std::vector<Index>& feelingOf(Effect effect) const {
    return feeling[static_cast<std::size_t>(effect)];
  }
};

/// Which effects a scene simulates.
class ActiveEffects {
 public:
  bool operator[](Effect effect) const { return on_[static_cast<std::size_t>(effect)]; }
  void set(Effect effect, bool on) { on_[static_cast<std::size_t>(effect)] = on; }

 private:
  std::array<bool, kEffects.size()> on_{};
};

/// How the broad phase searches. What it finds does not depend on it, only how fast.
struct PairSearch {
  std::vector<Index> order;       ///< lists.collidable, as sorted in the last step; new ones at its end
  int axis = 3;                   ///< of Bounds: the one along which a sweep takes the fewest tests
  bool by_tree = false;           ///< a tree of bounds is taken in place of the sweep
  std::uint64_t sweep_tests = 0;  ///< that the sweep took, or would have taken, when this was chosen
  std::uint64_t tests = 0;        ///< that the search took then
  Index changed = 0;              ///< bodies that have come or gone since then
  bool fresh = true;              ///< this has yet to be chosen
};

/// How long a body has been at rest, and which group it sleeps with.
struct Rest {
  std::uint32_t steps = 0, group = 0;
};

struct SceneStore {
  SceneDef settings;  ///< its `bodies` are empty: they live in the store below
  Bodies bodies;
  ActiveEffects effects;
  Vec3 gravity_W = Vec3::Zero();  ///< as simulated: zero when gravity is off, m/s²
  double ballistic_until = 0.0;   ///< no ballistic body leaves the limits before this time, s
  BodyLists lists;
  SceneCounts counts;
  std::vector<TimedWrench> wrenches;
  std::vector<BodyGrab> grabs;
  std::vector<BodyHold> holds;
  Contacts contacts;
  std::vector<Rest> rest;  ///< by body; empty unless some rest
  PairSearch pair_search;  ///< of the broad phase
  double time = 0.0;
  std::uint64_t steps = 0;
  bool just_edited = true;  ///< no step has been taken since the last edit

  /// Coulomb coefficient of a pair: the geometric mean, 1e4 at most; 0 when friction is off.
  double frictionOf(Index i, Index j) const;
  /// Newton's coefficient of a pair: the larger; 0 when restitution is off.
  double restitutionOf(Index i, Index j) const;
  /// Whether a contact is left out of the step because one of its bodies sleeps and nothing moves the other.
  bool isAsleep(const Contact& contact) const;
};

/// Where a body may be, as its intervals along x, y, z and d = (1, 1, 1)/sqrt(3), m.
struct Bounds {
  using Array4 = Eigen::Array<double, 4, 1, Eigen::DontAlign>;
  Array4 lo, hi;
  /// Without branches, which no processor could predict here.
  bool overlaps(const Bounds& o) const {
    int apart = 0;
    for (int k = 0; k < 4; ++k) apart |= int{lo[k] > o.hi[k]} | int{o.lo[k] > hi[k]};
    return apart == 0;
  }
  /// Whether `o` reaches out of it by no more than `slack`, m, >= 0.
  bool holds(const Bounds& o, double slack) const {
    return (o.lo >= lo - slack).all() && (o.hi <= hi + slack).all();
  }
  /// Of both together.
  Bounds with(const Bounds& o) const { return {lo.min(o.lo), hi.max(o.hi)}; }
};

/// What the effects add up, constant over the step.
struct Load {
  Vec3 a_W = Vec3::Zero();       ///< acceleration of the centre of mass, m/s²
  Vec3 torque_W = Vec3::Zero();  ///< about the centre of mass, N m
};

/// An impact that has been located but not yet reached.
struct PendingImpact {
  double time;
  Index i, j;                      ///< i < j
  std::uint32_t stamp_i, stamp_j;  ///< valid while both bodies still carry these stamps
  bool rebounds;                   ///< its rebound may last for longer than the step
};

/// Gives the bodies of a problem their places in it. The array that it fills goes by all bodies, is lent by
/// the step, and is given back as it was: so a problem costs what its own bodies cost.
class Slots {
 public:
  explicit Slots(std::vector<Index>& lent) : slot_(lent) {}
  Slots(const Slots&) = delete;
  Slots& operator=(const Slots&) = delete;
  ~Slots() {
    for (const Index i : filled_) slot_[i] = kNone;
  }
  /// The place of a body; kNone when it has none.
  Index operator[](Index i) const { return slot_[i]; }
  void set(Index i, Index slot) { slot_[i] = slot, filled_.push_back(i); }

 private:
  std::vector<Index>& slot_;
  std::vector<Index> filled_;
};

/// What is kept from step to step, and not copied with them: a copy has its own, made when it is needed first.
template <class T>
class Kept {
 public:
  Kept() = default;
  Kept(const Kept&) {}
  Kept& operator=(const Kept&) {
    memory_.reset();
    return *this;
  }
  T& operator*() {
    if (!memory_) memory_ = std::make_shared<T>();
    return *memory_;
  }
  T* operator->() { return &**this; }

 private:
  std::shared_ptr<T> memory_;  ///< not shared; T need not be known where this is a member
};

namespace soft_step {
struct Stores;
}
struct RestartStores;

struct StepStore {
  double t0 = 0.0, t1 = 0.0;  ///< s
  SolverSettings solver;      ///< resolved from the scene's Setting
  std::vector<Load> load;     ///< by body; those of ballistic bodies are not filled in
  std::vector<Load>
      load_without_drag;          ///< by body that feels drag: its load without it; empty: there is none
  Vec3 air = Vec3::Zero();        ///< velocity of the air where there is drag, m/s
  std::vector<double> submerged;  ///< by body: share of its volume in the fluid; empty without a fluid
  std::vector<Bounds> bounds;     ///< by body: where it may be during the step
  std::vector<char>
      supported;  ///< by body: a contact carried it in the last step, or bears it from the start; or another kind of constraint ties it
  std::vector<char>
      touched;  ///< by body: an impact of this step, or a solve before one, has left it in contact
  std::vector<char> crowded;           ///< by body: some contact of it is depenetrating; empty: of none
  std::vector<PendingImpact> impacts;  ///< found at the start of the step
  std::vector<std::uint32_t> stamp;    ///< by body: how often an impact has changed its trajectory
  std::vector<std::pair<double, Pose>>
      last_impact;  ///< by body with a stamp: when that was, and where the body was
  /// Pairs of the impacts that have been resolved, also before the step began again, and what was `reached` then.
  IndexPairs impacted;
  /// Pairs of a body that began the step again and came, on a new trajectory, near one that had not.
  IndexPairs reached;
  /// Pairs that already overlapped when an impact brought them to the contact solver, because contacts had pushed
  /// them together unforeseen.
  IndexPairs overlapping;
  std::vector<Index> disturbed;  ///< sleepers in an impact that no prediction has woken
  std::vector<Island> islands;
  std::vector<Index> island;        ///< by body: its place in `islands`; kNone when it is in none
  std::size_t moving_pairs = 0;     ///< of small towers that are exact though they move (solver_choice.cpp)
  std::vector<double> row_seconds;  ///< by row of the inner step
  std::vector<Index> slot;          ///< by body: kNone; lent to Slots
  std::vector<Index> woken;         ///< bodies that must not sleep on
  std::vector<std::vector<Index>> falling_asleep;  ///< groups that sleep from the next step on
  std::vector<Pose> before;         ///< by body: pose at t0, for the body that must be put back
  std::vector<Twist> twist_before;  ///< by body, at t0
  /// What the exact solves of all islands may still cost, beyond what each island has for itself.
  SolveBudget solve_budget{kCommonWork};
  Kept<soft_step::Stores> soft_stores;
  Kept<RestartStores> restart_stores;
  Kept<Workers> workers;  ///< share the loops of the stages; those of a copy are one thread
  StepReport report;

  /// Empties the store for a step from t0 to t1. What is kept by body has room for the bodies of the scene,
  /// or for none when all that move are ballistic.
  void begin(const SceneStore& scene, double from, double to);
  double h() const { return t1 - t0; }
  bool isCrowded(Index i) const { return !crowded.empty() && crowded[i]; }
  /// Of two bodies of which forces move one at least: the first that they move.
  Index movedOf(Index i, Index j) const { return island[i] != kNone ? i : j; }
  /// How far body i has been advanced. A body in no island is wherever its motion from t0 puts it.
  double timeOf(Index i) const { return island[i] == kNone ? t0 : islands[island[i]].time; }
  /// Where body i is at time t: its island has left it there, or a kinematic body moves on from t0.
  Pose poseAt(const Bodies& bodies, Index i, double t) const;
};

struct Context {
  SceneStore& scene;
  StepStore& step;
  const SceneAnalysis& analysis;
};

/// Gravity as a unit of accelerations, m/s²: where there is none that of the Earth, so that it is never zero.
double orEarths(double gravity);

/// Speed scale of a body of length L: what it gains by falling its own length, m/s.
double fallSpeed(double gravity, double length);

}  // namespace rbs
