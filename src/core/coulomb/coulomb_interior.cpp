// SPDX-License-Identifier: BSD-3-Clause
// Interior point method: Mehrotra's predictor and corrector (1992) along the central path.
//
// The predictor aims at products of 0. How far it gets within the cones, a, tells what to aim at: products of
// (1 - a)^3 of the mean, with the predictor's second order. Where products no longer fall the path turns
// back, and the rest is for others.
//
// Its tolerance is coarse (Case::rough), so double is enough for the residuals of its steps.
#include "coulomb/central_path.h"
#include "coulomb/coulomb_solvers.h"

#include <algorithm>

namespace rbs::coulomb {

namespace {

constexpr double kMostOfRoom = 0.99;
constexpr double kLeastCentring = 1e-8;
constexpr double kHeadway = 0.5;  // what so many steps leave of the mean product at most, or it is stuck
constexpr int kStepsOfHeadway = 8;

}  // namespace

Answer interiorPoint(const System& system, BodyBlocks& matrix, double tolerance, int cap) {
  CentralPath path(system, matrix);
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

}  // namespace rbs::coulomb
