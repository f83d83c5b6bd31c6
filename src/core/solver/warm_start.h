// SPDX-License-Identifier: BSD-3-Clause
// How much of the impulses of the last sub-step the next one begins with.
//
// All of them, as a rule: a stack at rest needs the same ones again, and where the warm start is wrong the passes over the
// contacts mend it. They mend little where heavy bodies squeeze a light one: a rod between a slab and a heavy body bears a
// large force in one step and none in the next; or it turns, and the same forces meet other levers. What a pass leaves of
// such a warm start goes into the rod, each sub-step begins with more, and the energy of the rod grows without end.
//
// Without friction, the impulses l of rigid contacts are those that make
//   f(l) = l.u + l.A l / 2
// least among l_n >= 0; u are the relative velocities without them, and A u's response to impulses. f is the energy that
// the impulses add, as those see it who move with the kinematic bodies. Among the multiples s l_0 of a warm start the least is at
//   s = -l_0.u / (l_0.A l_0).
// One that adds no more energy than some falls over the sub-step is taken whole: passes leave as much in a pile, and it would
// sag without its warm start. Of another one s is taken, at least 0, and it adds none. A pass that solves one row after the other
// makes f smaller with each row, so a sub-step as a whole adds no energy but by parting overlaps. With friction the
// rows are nearly such.
//
// With v_0 the velocity of a body without its warm start, dv what that changes, and the same for spins,
//   l_0.A l_0 = sum m dv.dv,   l_0.u = sum m dv.v_0 + sum p.v_k,
// where the last sum goes over the impulses p that kinematic bodies are given, and their velocities v_k there.
//
// Forces that an exact step has found may be more than soft contacts can bear. Rigid bodies that friction jams have forces of
// any size that balance each other (1e6 N on a needle of 1 kg). They add nothing as a guess; but each soft contact gives up the share c
// of its impulse l, one after the other, and the light body leaves with c l/m. A soft contact at rest bears what its bias
// b s <= V asks for (soft_step.h):
//   a m b s = c l,   so   l <= (a/c) m V,
// with V the speed at which overlaps part. The impulses of an island are begun with as that share of them which no point is
// above its own bound with: of what is in balance a multiple is.
#pragma once

#include "solver/contact_lanes.h"

namespace rbs::warm_start {

/// The energy that a warm start may add, of what the bodies gain when they fall over a sub-step from rest. A pyramid of 20 rows
/// stands at 9 and slides at 0; bodies that are squeezed get far more.
inline constexpr double kFalls = 100.0;

/// Limits the warm start, in each island by itself, when it has been given to the bodies in a sub-step of h s. Costs a few ns a
/// body where none becomes faster by more than what its load does; else up to 30 ns a body and, beside kinematic bodies
/// that move, a point.
void limit(const Context& context, SolverContacts& contacts, ContactLanes& lanes, double h);

/// Of the forces of an exact step, leaves what soft contacts can bear, before the first sub-step.
void leaveBearable(const Context& context, SolverContacts& contacts, ContactLanes& lanes,
                   const Softness& soft);

}  // namespace rbs::warm_start
