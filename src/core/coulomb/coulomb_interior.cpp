// SPDX-License-Identifier: BSD-3-Clause
// Interior point method: Mehrotra's predictor and corrector (1992) along the central path.
//
// The predictor aims at products of 0. How far it gets within the cones, a, tells what to aim at: products of
// (1 - a)^3 of the mean, with the predictor's second order. Where products no longer fall the path turns
// back, and the rest is for others.
//
// It starts near the best impulses known: they are on the boundary of the cones or beyond, so the start is a part of the way
// from there to the start without them, kAway times their residual (Skajaa, Andersen and Ye, "Warmstarting the
// homogeneous and self-dual interior point method", Math. Prog. Comp. 5, 2013). Where they are nearly right that spares a third
// to a half of the iterations. Where another set of points pushes, a start so near the boundary may get stuck, and one from
// afar is tried.
//
// Its tolerance is coarse (Case::rough), so double is enough for the residuals of its steps.
#include "coulomb/central_path.h"
#include "coulomb/coulomb_solvers.h"

#include <algorithm>

namespace rbs::coulomb {

namespace {

constexpr double kAway = 0.03;  // per residual
constexpr double kLeastAway = 1e-4;
constexpr double kMostOfRoom = 0.99;
constexpr double kLeastCentring = 1e-8;
constexpr double kHeadway = 0.5;  // what so many steps leave of the mean product at most, or it is stuck
constexpr int kStepsOfHeadway = 8;

// The best of the path, and not of the guess: from that Newton's method has been tried.
Answer follow(const System& system, CentralPath& path, double tolerance, int cap) {
  CentralPath::Place predictor, corrector;
  Answer best;
  best.r = system.noImpulses();
  best.residuals = system.residuals(best.r);
  double reached = path.meanProduct();
  for (int since = 0; best.iterations < cap && since < kStepsOfHeadway && !system.isBudgetSpent();) {
    ++best.iterations;
    if (!path.linearise() || !path.step(0.0, 0.0, nullptr, predictor)) break;
    const double left = 1.0 - std::min(1.0, path.room(predictor));
    const double t = std::max(left * left * left, kLeastCentring) * path.meanProduct();
    if (!path.step(t, 0.0, &predictor, corrector)) break;
    const double part = std::min(1.0, kMostOfRoom * path.room(corrector));
    path.place.add(part, corrector);
    ++since;
    if (path.meanProduct() <= kHeadway * reached) reached = path.meanProduct(), since = 0;
    const Impulses r = path.impulses();
    const Residuals residuals = system.residuals(r, system.relativeVelocitiesAbout(r));
    if (residuals.beyond_rounding < best.residuals.beyond_rounding) best.r = r, best.residuals = residuals;
    if (best.within(tolerance)) break;
  }
  best.residuals = system.residuals(best.r);
  return best;
}

}  // namespace

Answer interiorPoint(const System& system, BodyBlocks& matrix, double tolerance, int cap) {
  CentralPath path(system, matrix);
  return follow(system, path, tolerance, cap);
}

Answer interiorPoint(const System& system, BodyBlocks& matrix, const Answer& guess, double tolerance,
                     int cap) {
  CentralPath path(system, matrix);
  path.startNear(guess.r, std::clamp(kAway * guess.residuals.beyond_rounding, kLeastAway, 1.0));
  return follow(system, path, tolerance, cap);
}

}  // namespace rbs::coulomb
