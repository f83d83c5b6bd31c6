// SPDX-License-Identifier: BSD-3-Clause
// The central path followed by its arc length, through the places where it turns back.
//
// Coulomb's problem is not monotone: t may have a least value from which the path leads on to larger ones
// before it falls to 0. There the direction z of change with log t grows without bound and changes sign, and
// methods that ask for a smaller t get stuck. Its arc goes on smoothly (Keller 1977; Allgower and Georg,
// "Introduction to Numerical Continuation Methods", 2003, chapter 7). So each step takes, with the same
// factors, Newton's correction c at the t it is at and the tangent (z, 1) of (place, log t), and goes
//   c + (beta_0 + beta) (z, 1),   log t by beta_0 + beta:
// beta_0 takes from the correction what it has along the arc, so that it exists where z does not, and beta is
// the length of the step ahead, in the direction that agrees with the last one. Directions are measured with
// each pair as a fraction of where it is.
//
// Steps are taken back, and shorter ones tried, where Newton's method leaves the cones or does not come
// near, or where the tangent has turned by so much that the arc may have been left for another.
#include "coulomb/central_path.h"
#include "coulomb/coulomb_solvers.h"

#include <algorithm>
#include <cmath>
#include <deque>

namespace rbs::coulomb {

namespace {

constexpr double kNearPath = 0.3;     // a distance from the path from which to go ahead
constexpr double kRoom = 1.4;         // a step leaves this many times its length to the boundary
constexpr double kLeastCosine = 0.5;  // the least cosine of two tangents,
constexpr double kShort = 0.1;        // and for steps as short as this
constexpr double kLeastShortCosine = 0.02;
constexpr double kShortest = 1e-4;
constexpr int kCorrections = 3;  // without a step ahead

constexpr std::size_t kMarks = 16;  // places to go back to
constexpr int kFurtherBack = 3;

}  // namespace

Answer followPath(const System& system, BodyBlocks& matrix, double tolerance, int cap) {
  CentralPath path(system, matrix);
  if (!(path.meanProduct() > 0.0))
    return interiorPoint(system, matrix, tolerance, cap);  // without a bound there is no path
  CentralPath::Place tangent, correction;
  Answer best;
  best.r = system.noImpulses();
  best.residuals = system.residuals(best.r);

  struct Mark {
    CentralPath::Place place;
    double log_t;
    Eigen::VectorXd direction;
  };
  const double first_log_t = std::log(path.meanProduct());
  Mark now{path.place, first_log_t, {}};
  std::deque<Mark> marks;
  double length = 1.0;
  int ahead_since = kFurtherBack;  // steps ahead since one was taken back
  for (int corrections = 0; best.iterations < cap && !system.isBudgetSpent();) {
    ++best.iterations;
    const double t = std::exp(now.log_t), share = std::exp(now.log_t - first_log_t);
    if (!path.linearise() || !path.tangent(t, share, tangent) || !path.step(t, share, nullptr, correction))
      break;
    const auto withTime = [&](const CentralPath::Place& direction, double log_t) {
      Eigen::VectorXd v = path.relative(direction);
      v.conservativeResize(v.size() + 1);
      v[v.size() - 1] = log_t;
      return v;
    };
    Eigen::VectorXd direction = withTime(tangent, 1.0);
    const double size = direction.norm();
    direction /= size;
    if (now.direction.size() == 0) now.direction = -direction;
    const double cosine = now.direction.dot(direction);
    const double beta_0 = -now.direction.dot(withTime(correction, 0.0)) / (cosine * size);
    const auto room = [&](double beta) {
      CentralPath::Place all = correction;
      return path.room(all.add(beta, tangent));
    };
    const double distance = path.distance(t, share);
    const double least_cosine = length < kShort ? kLeastShortCosine : kLeastCosine;
    double beta = beta_0;
    if (room(beta_0) < kRoom || std::abs(cosine) < least_cosine ||
        (distance > kNearPath && corrections == kCorrections)) {
      if (marks.empty()) break;
      // Where it came no further than the last time, further back.
      for (int back = ahead_since == 1 ? kFurtherBack : 1; back > 0 && !marks.empty(); --back) {
        now = marks.back();
        marks.pop_back();
      }
      ahead_since = 0;
      path.place = now.place;
      length *= 0.3;
      corrections = 0;
      if (length < kShortest) break;
      continue;
    }
    if (distance <= kNearPath) {
      marks.push_back(now);
      ++ahead_since;
      if (marks.size() > kMarks) marks.pop_front();
      if (corrections == 0 && distance < 0.5 * kNearPath) length *= 1.5;
      corrections = 0;
      const auto ahead = [&] { return beta_0 + std::copysign(length / size, cosine); };
      while (room(ahead()) < kRoom && length > kShortest) length *= 0.5;
      beta = ahead();
    } else {
      ++corrections;
    }
    path.place.add(1.0, correction).add(beta, tangent);
    now = {path.place, now.log_t + beta, std::copysign(1.0, cosine) * direction};
    const Impulses r = path.impulses();
    const Residuals residuals = system.residuals(r, system.relativeVelocitiesAbout(r));
    if (residuals.beyond_rounding < best.residuals.beyond_rounding) best.r = r, best.residuals = residuals;
    if (best.within(tolerance)) break;
  }
  best.residuals = system.residuals(best.r);
  return best;
}

}  // namespace rbs::coulomb
