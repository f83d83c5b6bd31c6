// SPDX-License-Identifier: BSD-3-Clause
// Interior point method: Mehrotra's predictor and corrector (1992) along the central path.
//
// The predictor aims at products of 0. How far it gets within the cones, a, tells what to aim at: products of
// (1 - a)^3 of the mean, with the predictor's second order. Where steps shrink to nothing the path turns
// back, and the rest is for others.
#include "coulomb/central_path.h"
#include "coulomb/coulomb_solvers.h"

#include <algorithm>

namespace rbs::coulomb {

namespace {

constexpr double kMostOfRoom = 0.99;
constexpr double kLeastCentring = 1e-8;
constexpr double kShortStep = 0.05;
constexpr int kShortSteps = 6;  // in a row, until it is stuck

}  // namespace

Answer interiorPoint(const System& system, BodyBlocks& matrix, double tolerance, int cap) {
  CentralPath path(system, matrix);
  CentralPath::Place predictor, corrector;
  Answer best;
  best.r = Impulses::Zero(3, system.columns());
  best.residuals = system.residuals(best.r);
  for (int short_steps = 0; best.iterations < cap && short_steps < kShortSteps && !system.isBudgetSpent();) {
    ++best.iterations;
    if (!path.linearise() || !path.step(0.0, 0.0, nullptr, predictor)) break;
    const double left = 1.0 - std::min(1.0, path.room(predictor));
    const double t = std::max(left * left * left, kLeastCentring) * path.meanProduct();
    if (!path.step(t, 0.0, &predictor, corrector)) break;
    const double part = std::min(1.0, kMostOfRoom * path.room(corrector));
    path.place.add(part, corrector);
    short_steps = part < kShortStep ? short_steps + 1 : 0;
    const Impulses r = path.impulses();
    const Residuals residuals = system.residuals(r);
    if (residuals.beyond_rounding < best.residuals.beyond_rounding) best.r = r, best.residuals = residuals;
    if (best.within(tolerance)) break;
  }
  return best;
}

}  // namespace rbs::coulomb
