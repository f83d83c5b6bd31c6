// SPDX-License-Identifier: BSD-3-Clause
// Soft step: sequential impulses with sub-steps, soft contacts and a relaxing pass.
//
// The interval [t0, t1] is cut into n sub-steps of length h, which the setting says; into more of them where
// bodies turn or travel further in one than contact points found at its start can follow, up to 256. Where
// even these are too few, no sub-step may add energy (energy_limit.h).
// The narrow phase runs at the start, and again for a pair that has since moved by more than a small share of
// its size, or in which something round rolls (SolverContacts::rolls); in between the gap s of a contact point follows the motion
// of its bodies. A sub-step
//   1. adds the loads to the velocities, and last sub-step's impulses, less where they would add much energy
//      (warm_start.h);
//   2. solves each contact once with a soft constraint that also closes the position error;
//   3. moves the bodies, and finds anew how those respond to impulses whose axes have turned: a pass with masses
//      that are more than twice too large diverges;
//   4. solves each contact once more without the position error (relax), which takes away the speed that
//      only served to separate the bodies, so that pushing bodies apart adds no kinetic energy. It solves the
//      friction of sliding points again after the normals: they slide on with mu times the force they have then.
//
// Soft contact. A contact of effective mass m that is open by s with speed u gets a spring and damper of
// frequency w and damping ratio z, integrated implicitly, which an impulse solver writes as
//   dl = -a m (u + b s) - c l,   b = w/(2z + h w),   x = h w (2z + h w),   a = x/(1 + x),   c = 1/(1 + x),
// with l the accumulated impulse (Catto, "Soft constraints", GDC 2011; "Solver2D", 2024). w is a fixed
// fraction of the sub-step rate, so that it has no unit of its own (and that of a whole sub-step also in one
// that an impact cuts short, or a sliver of time would push as fast as it can); the steady error under a
// force F is F/(m w²). b s is capped at sqrt(g L): an overlap is pushed out no faster than a body falls its
// own length, g being what presses the pair together where that is more than gravity.
//
// A point that is still open (s > 0) asks only that it does not close faster than it can: u >= -s/h. The
// relaxing pass leaves out the points without an impulse: by then they have moved, and what they ask for is
// the next sub-step's matter, or that of an impact there.
//
// Friction is a vector in the contact plane, |l_T| <= mu l_n, on the circular cone. A sticking point is
// solved as a 2 x 2 block. A sliding one steps by rho = 1/(largest eigenvalue of its 2 x 2 response) and is
// projected back: l_T <- P(l_T - rho u_T). The fixed point of that is u_T against l_T, the direction of
// maximum dissipation, which the block step alone would miss when the response is not isotropic.
//
// A body that no impulse pushed in a sub-step has moved under its load alone and takes the exact parabola. A
// push takes that away by degrees, so that none, however small, makes a jump; one of a hundredth of the load
// does so in full.
#pragma once

#include "base/algebra.h"
#include "dynamics/integrate.h"
#include "effects_built.h"
#include "solver/contact_lanes.h"
#include "solver/energy_limit.h"
#include "solver/inner_step.h"
#include "solver/restitution.h"
#include "solver/rolling_energy.h"
#include "solver/warm_start.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace rbs::soft_step {

/// Share of its load that a body must be pushed with to take the straight path of a contact.
inline constexpr double kPushedShare = 0.01;
/// A turn in one sub-step below which a body's gyroscopic torque changes its spin by less than this share.
inline constexpr double kSteadyTurn = 1e-6;

/// A turn, rad, from which on the response of a body to impulses is found anew. That of a rod across its axis, of length l
/// and radius r, is then off by (l kAxesTurn / r)^2 / 6: by a sixth where r is a thousandth of l.
inline constexpr double kAxesTurn = 1e-3;
/// Most sub-steps of a step.
inline constexpr double kMostSubSteps = 256.0;

/// The memory of the soft step, kept from solve to solve.
struct Stores {
  SolverContacts::Stores contacts;
  ContactLanes::Stores lanes;
};

/// The softness of a contact over a sub-step of length h, in a step whose own sub-steps are h_full long.
Softness softness(double h, double h_full);

/// The longest sub-step in which contacts can follow their bodies, s.
double longestOfContacts(const Context& context, const Subgraph& batch);

/// The method, with the kinds of constraints that it solves beside contacts (constraint_kinds.h). Islands that no kind takes
/// are solved without any, as if there were none: not a test of it is left in the loops.
template <class... Kinds>
class SoftStep : public InnerRows {
 public:
  static double longestSubStep(const Context& context, const Subgraph& batch) {
    return std::min({longestOfContacts(context, batch), Kinds::longestSubStep(context, batch)...});
  }
  SoftStep(Context& context, const Subgraph& batch, double t0, double t1)
      : context_(context),
        batch_(batch),
        contacts_(context, batch, context.step.soft_stores->contacts),
        lanes_(contacts_, context.step.soft_stores->lanes, *context.step.workers),
        t0_(t0),
        dt_(t1 - t0) {
    const double longest = longestSubStep(context, batch), shortest = context.step.h() / kMostSubSteps;
    const double of_setting = context.step.h() / context.step.solver.sub_steps;
    too_fast_ = longest < std::min(of_setting, shortest);
    h_full_ = std::min(of_setting, std::max(longest, shortest));
    sub_steps_ = std::max(1, static_cast<int>(std::ceil(dt_ / h_full_ - 1e-9)));
    h_ = dt_ / sub_steps_;
    soft_ = softness(h_, h_full_);
  }

  void collide() { contacts_.find(t0_, dt_, h_); }
  void prepare() {
    lanes_.take();
    warm_start::leaveBearable(context_, contacts_, lanes_, soft_);
    forKinds([&](auto& kind) { kind.prepare(context_, batch_, contacts_, h_); });
    energy_.find(context_, contacts_, too_fast_);
    rolling_.find(context_, contacts_);
    if constexpr (built::restitution)
      if (context_.scene.effects[Effect::Restitution]) restitution_.begin(context_, contacts_);
  }
  bool beginSubStep() {
    if (done_ == sub_steps_) return false;
    if (done_++ > 0) lanes_.refresh(t0_ + (done_ - 1) * h_, dt_ - (done_ - 1) * h_);
    return true;
  }
  // Inlined whatever their size, which depends on the effects that this build has: what it lacks is to save
  // no more than its own instructions.
  [[gnu::always_inline]] void addLoads();
  [[gnu::always_inline]] void integrate();
  void warmStart() {
    lanes_.warmStart();
    warm_start::limit(context_, contacts_, lanes_, h_);
    forKinds([&](auto& kind) { kind.warmStart(contacts_); });
  }
  void solve() {
    solveKinds(Pass::Soft);
    lanes_.solve(Pass::Soft, soft_, h_);
  }
  // Twice with other kinds, whose bounds are the normal forces as they are then: whether or not they have rows, so that what an
  // island does depends on no other.
  void relax() {
    if constexpr (sizeof...(Kinds) > 0) {
      lanes_.solve(Pass::Relax, soft_, h_);
      solveKinds(Pass::Last);
    }
    lanes_.solve(Pass::Last, soft_, h_);
    if (too_fast_) energy_.apply(context_, done_ * h_, contacts_);
  }
  void rebound() {
    if (restitution_.empty() && energy_.empty() && rolling_.empty()) return;
    lanes_.writePoints();
    are_written_ = true;
    if constexpr (built::restitution) restitution_.apply(context_, dt_, contacts_);
    energy_.apply(context_, dt_, contacts_);
    rolling_.apply(context_, dt_, contacts_);
  }
  // Where points are given back one block at a time, they come from memory once.
  void store() {
    lanes_.measure(context_.step.h() * orEarths(context_.scene.gravity_W.norm()));
    contacts_.store(h_, h_full_, [this](Index block) {
      if (!are_written_) lanes_.writePoints(block);
    });
    forKinds([&](auto& kind) { kind.store(context_); });
  }

 private:
  template <class Do>
  void forKinds(const Do& what) {
    std::apply([&](auto&... kind) { (what(kind), ...); }, kinds_);
  }
  bool hasKinds() const {
    return std::apply([](const auto&... kind) { return (!kind.empty() || ...); }, kinds_);
  }
  void solveKinds(Pass pass) {
    if (!hasKinds()) return;
    lanes_.writePoints();
    forKinds([&](auto& kind) { kind.solve(contacts_, pass, soft_, h_); });
  }

  Context& context_;
  const Subgraph& batch_;
  SolverContacts contacts_;
  ContactLanes lanes_;
  std::tuple<Kinds...> kinds_;
  EnergyLimit energy_;
  RollingEnergy rolling_;
  Restitution restitution_;
  double t0_, dt_;
  double h_full_, h_;  // a sub-step when no impact cuts the step, and now
  int sub_steps_, done_ = 0;
  bool are_written_ = false;  // the points have what the lanes had
  bool too_fast_;  // for the most sub-steps: no contact can be followed, and no energy may be gained
  Softness soft_;
};

template <class... Kinds>
inline void SoftStep<Kinds...>::addLoads() {
  lanes_.forBodies([this](SolverBody& s) {
    if (s.inv_mass == 0.0) return;
    const Load& load = context_.step.load[s.body];
    s.v += h_ * load.a_W;
    s.v_free = s.v;
    s.w += h_ * (s.inv_inertia_W * load.torque_W);
    s.w_free = s.w;
  });
}

template <class... Kinds>
inline void SoftStep<Kinds...>::integrate() {
  Bodies& bodies = context_.scene.bodies;
  lanes_.forBodies([&](SolverBody& s) {
    s.turned_axes = false;
    if (s.inv_mass == 0.0 && context_.step.island[s.body] == kNone) {
      s.moved += h_ * s.v;  // kinematic bodies move on their own clock; here only the gaps follow them
      s.turned += h_ * s.w;
      s.surface_turned += h_ * surfaceSpin(bodies, s.body, s.w);
      return;
    }
    const Inertia& inertia = bodies.inertia[s.body];
    Vec3 step = h_ * s.v;
    const Vec3 fall = h_ * context_.step.load[s.body].a_W;
    const double push = (s.v - s.v_free).norm(), enough = kPushedShare * fall.norm();
    if (push < enough) step -= 0.5 * h_ * (1.0 - push / enough) * fall;
    const Vec3& torque_W = context_.step.load[s.body].torque_W;
    Vec3 later = Vec3::Zero();  // what the spin at the end is beyond that in the middle
    if (!torque_W.isZero(0.0)) {
      const Vec3 gain = h_ * (s.inv_inertia_W * torque_W);
      const double pushed = (s.w - s.w_free).norm(), much = kPushedShare * gain.norm();
      if (pushed < much) later = 0.5 * (1.0 - pushed / much) * gain;
      s.w -= later;
    }
    s.moved += step;
    s.turned += h_ * s.w;
    s.surface_turned += h_ * surfaceSpin(bodies, s.body, s.w);
    bodies.pose[s.body].p_WB += step;
    Quat& q_WB = bodies.pose[s.body].q_WB;
    if (!inertia.lazy_orientation) {
      if ((inertia.isotropic && !inertia.gyroscopic) || s.w.norm() * h_ < kSteadyTurn) {
        q_WB = (rotationBy(h_ * s.w) * q_WB).normalized();
      } else {
        rotateFreely(q_WB, s.w, inertia, h_);
      }
    }
    s.w = withoutNegativeZeros(s.w + later);
    if (inertia.lazy_orientation) return;
    const bool has_axes = !inertia.isotropic || !s.axis_W.isZero(0.0);
    if (has_axes && (s.turned - s.turned_axes_at).squaredNorm() > kAxesTurn * kAxesTurn) {
      if (!inertia.isotropic) s.inv_inertia_W = inertia.inverseW(q_WB.toRotationMatrix());
      if (!s.axis_W.isZero(0.0)) s.axis_W = q_WB * Vec3::UnitZ();
      s.turned_axes_at = s.turned, s.turned_axes = true;
    }
  });
}

}  // namespace rbs::soft_step
