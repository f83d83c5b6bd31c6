// SPDX-License-Identifier: BSD-3-Clause
// Bodies that overlap deeply because an edit put them where others are.
//
// Two bodies that overlap part by their contact (solver/). In a crowd, where many bodies are in one place,
// contacts say nothing of use: the shortest ways out contradict each other, what each pair adds in speed adds
// up, and n bodies have n²/2 contacts. So the pairs of a crowd are taken out of the contact solve, and its
// bodies are moved apart, no faster than √(g L), until the crowd has dissolved. They move across gravity and
// keep their velocities: that gains no energy.
#pragma once

#include "state/context.h"

namespace rbs::depenetration {

/// Whether two bodies overlap so deeply that no contact has made it. By the points of the last step; bodies
/// whose centres nearly coincide are found without them.
bool isDeep(const Context& context, const Contact& contact);

Need need(const SceneAnalysis& analysis);

/// Finds the pairs of crowds (PairState::isDepenetrating).
void find(Context& context);

/// Whether overlaps decide how an island moves, and not forces that an exact solve could find: some of its
/// bodies are `crowded`, or many of its pairs overlap deeply.
bool rulesOver(const Context& context, const Island& island);

/// Moves the bodies of crowds apart, as far as they may go in a step, and hands their overlaps on to the next
/// step. Warns of deep overlaps in the first step after an edit.
void separate(Context& context);

}  // namespace rbs::depenetration
