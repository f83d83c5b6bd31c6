// SPDX-License-Identifier: BSD-3-Clause
// How a contact takes part in a step. Every step begins with Candidate.
//
//   Candidate      --touch()-------> Touching        its points bore a force at the end of the last step, or an
//                                                    impact left the two together
//   Candidate      --awaitImpact()-> AwaitingImpact  the two will collide before the end of the step
//   Candidate      --separate()----> Separated       their predicted motions do not meet, or they rest apart
//   Candidate      --depenetrate()-> Depenetrating   they overlap in a crowd (depenetration.h), to the step's end
//   Touching       --awaitImpact()-> AwaitingImpact  they close, and rebound by their restitution
//   AwaitingImpact --touch()-------> Touching        they stay together after the impact, or it is left to contacts
//   AwaitingImpact --open()--------> Candidate       another impact came first: what comes is not known,
//   AwaitingImpact --separate()----> Separated       or it is known that they will not meet
//   Separated      --awaitImpact()-> AwaitingImpact  an impact has changed a motion, and they will collide
//   Separated      --open()--------> Candidate       they may touch: an impact has changed a motion, or contacts may push
//                                                    them, or have pushed them, into each other
//   Separated      --touch()-------> Touching        an impact left them together
//   any but Depenetrating --miss()-> Missed          contacts pushed the two together unforeseen, and the step has
//                                                    begun again (restart.h); to the step's end
//
// The contact solver takes candidates, what touches and what was missed.
#pragma once

#include <cassert>

namespace rbs {

class PairState {
 public:
  /// The contact solver looks at the pair: it touches, or may touch in this step.
  bool isForSolver() const { return at_ == At::Candidate || at_ == At::Touching || at_ == At::Missed; }
  /// It may touch in this step, and does not yet.
  bool isCandidate() const { return at_ == At::Candidate; }
  /// Its points bore a force when the step began, or an impact has left the bodies together since.
  bool isTouching() const { return at_ == At::Touching; }
  /// It is left out of the solve until an impact that has been predicted.
  bool awaitsImpact() const { return at_ == At::AwaitingImpact; }
  /// It is known not to touch in this step, unless an impact changes a trajectory.
  bool isSeparated() const { return at_ == At::Separated; }
  /// No prediction holds for it: the contact solver looks at it however far apart the two are, and keeps it where
  /// an impact is predicted as well.
  bool isMissed() const { return at_ == At::Missed; }
  /// It overlaps deeply in a crowd: its bodies are moved apart, without impacts and contact forces
  /// (depenetration.h).
  bool isDepenetrating() const { return at_ == At::Depenetrating; }

  void open() { go(At::Candidate); }
  void touch() { go(At::Touching); }
  void awaitImpact() { go(At::AwaitingImpact); }
  void separate() { go(At::Separated); }
  void depenetrate() { go(At::Depenetrating); }
  void miss() { go(At::Missed); }

 private:
  enum class At : char { Candidate, Touching, AwaitingImpact, Separated, Depenetrating, Missed };
  // The arrows of the diagram. A state may also stay as it is.
  static constexpr bool hasArrow(At from, At to) {
    switch (from) {
      case At::Candidate:
        return to != At::Candidate;
      case At::Touching:
        return to == At::AwaitingImpact || to == At::Missed;
      case At::AwaitingImpact:
        return to == At::Touching || to == At::Candidate || to == At::Separated || to == At::Missed;
      case At::Separated:
        return to == At::AwaitingImpact || to == At::Candidate || to == At::Touching || to == At::Missed;
      case At::Depenetrating:
      case At::Missed:
        break;
    }
    return false;
  }
  void go(At to) {
    if (at_ == At::Missed) return;
    assert(to == at_ || hasArrow(at_, to));
    at_ = to;
  }
  At at_ = At::Candidate;
};

}  // namespace rbs
