// SPDX-License-Identifier: BSD-3-Clause
// Augmented Lagrangian with a semismooth Newton method in body space.
//
// Coulomb's law is, for any rho > 0 (Alart and Curnier 1991),
//   r_n = (r_n - rho u_n)_+,   r_T = P(r_T - rho u_T),
// P being the nearest point of the disc of radius mu r_n. Each round holds r on the right and looks for the
// velocities that the next impulses r + d, on the left, make. With u_r the velocity that r alone makes, x
// what the next impulses add to y,
//   F(x) = x - J^T d(x) = 0,   u = u_r + J x,
// by Newton's method,
//   (1 + J^T D J) dx = -F,   D = -d'(u), one of the derivatives where there are several,
// each step halved until |F| falls; that is the norm of kinetic energy. Then r becomes r + d: a step of the
// proximal point method, which needs no regularisation where points are redundant, and adds to r only what
// the velocities call for.
//
// rho is `stiffness` times the mass the point feels, 1/response. Rounds converge by a factor of about 1/(1 +
// stiffness w/response), w the smallest eigenvalue of J J^T that matters (1/n^2 in a stack of n): it grows
// where they are slow. Newton's steps want it small as long as points still change their state: a round that
// ends in steps cut short has asked for too much, and from then on it grows with more care.
//
// A torque constraint's bounds are on the sum N of its points' next normal impulses, r_n + d_n: D has, beside its own
// block, the column g of it by N, and N changes by -D_nn J_n of each of its points. The rows of a joint are
//   r = P(r - rho u),
// P being onto their bounds: D is rho within them, and 0 beyond.
//
// u_r is summed in long double. It is all that rho multiplies which is not itself as small as the error, so
// that rho may be as large as it likes without its rounding in the answer.
#include "coulomb/coulomb_solvers.h"

#include <algorithm>
#include <cmath>

namespace rbs::coulomb {

namespace {

constexpr double kMostStiffness = 1e10;
constexpr double kLeastStiffness = 1e-2;
constexpr double kMostGrowth = 10.0, kLeastGrowth = 2.0;  // of the stiffness from one round to the next
constexpr double kHardlyLess = 0.5;                       // of what the last round has left
// Over the best residual: a stiffness at which rho u is a small part of usual impulses, which make velocities of the order of 1, so
// that most points keep the state that the best impulses give them.
constexpr double kTrust = 0.03;
constexpr double kCutShort = 0.05;  // a part of a step at which its round ends
constexpr int kMostSteps = 4;       // of Newton in a round
constexpr int kMostHalvings = 8;    // of a step

class Round {
 public:
  Round(const System& system, const Impulses& r, const Impulses& u_r) : system_(system), r_(r), u_r_(u_r) {}

  struct State {
    Velocities x, F;
    Impulses d;
    std::vector<Mat3> D;  // by column
    std::vector<Vec3> g;  // by torque
    double norm;          // of F
  };

  State at(const Velocities& x, double stiffness) const {
    const std::vector<Point>& points = system_.points();
    const std::vector<TorqueRows>& torques = system_.torques();
    State state{
        x, x, Impulses(3, r_.cols()), std::vector<Mat3>(r_.cols()), std::vector<Vec3>(torques.size()), 0.0};
    for (std::size_t k = 0; k < points.size(); ++k) {
      Vec3 d;
      step(points[k], r_.col(k), System::changed(points[k], u_r_.col(k), x), stiffness / points[k].response,
           d, state.D[k]);
      state.d.col(k) = d;
      System::push(points[k], -d, state.F);
    }
    for (std::size_t c = 0; c < torques.size(); ++c) {
      const std::size_t k = points.size() + c;
      const double n = System::normalSum(torques[c], r_) + System::normalSum(torques[c], state.d);
      Vec3 d;
      step(torques[c], r_.col(k), System::changed(torques[c], u_r_.col(k), x), n,
           stiffness / torques[c].response, d, state.D[k], state.g[c]);
      state.d.col(k) = d;
      System::push(torques[c], -d, state.F);
    }
    for (std::size_t c = 0; c < system_.joints().size(); ++c) {
      const JointRows& joint = system_.joints()[c];
      const std::size_t k = system_.firstJoint() + c;
      const BoxSet::Step step =
          joint.box.step(r_.col(k), System::changed(joint, u_r_.col(k), x), stiffness / joint.response);
      state.d.col(k) = step.d;
      state.D[k] = step.by_u.asDiagonal();
      System::push(joint, -step.d, state.F);
    }
    state.norm = state.F.norm();
    return state;
  }

 private:
  // d and D of one point.
  static void step(const Point& point, const Vec3& r, const Vec3& u, double rho, Vec3& d, Mat3& D) {
    D.setZero();
    const double n = r[2] - rho * u[2];
    if (n <= 0.0) {
      d = -r;
      return;
    }
    const auto sliding = point.sliding.step(r.head<2>(), u.head<2>(), rho, n);
    d << sliding.d, -rho * u[2];
    D.topLeftCorner<2, 2>() = sliding.by_u;
    D.topRightCorner<2, 1>() = rho * point.sliding.factor * sliding.by_N;
    D(2, 2) = rho;
  }

  // d, D and g of one torque.
  static void step(const TorqueRows& torque, const Vec3& r, const Vec3& u, double n, double rho, Vec3& d,
                   Mat3& D, Vec3& g) {
    D.setZero();
    const auto rolling = torque.rolling.step(r.head<2>(), u.head<2>(), rho, n);
    const auto spinning = torque.spinning.step(r.tail<1>(), u.tail<1>(), rho, n);
    d << rolling.d, spinning.d;
    D.topLeftCorner<2, 2>() = rolling.by_u;
    D.bottomRightCorner<1, 1>() = spinning.by_u;
    g << torque.rolling.factor * rolling.by_N, torque.spinning.factor * spinning.by_N;
  }

  const System& system_;
  const Impulses &r_, &u_r_;
};

}  // namespace

Answer newton(const System& system, BodyBlocks& matrix, const Answer& start, double stiffness,
              double tolerance, int cap, double enough) {
  Answer best{start.r, start.residuals, 0};
  Impulses r = start.r, u = system.relativeVelocities(r);
  double last = best.residuals.beyond_rounding, growth = kMostGrowth;
  while (best.iterations < cap && stiffness >= kLeastStiffness && !system.isBudgetSpent()) {
    const Round round(system, r, u);
    Round::State state = round.at(Velocities::Zero(6, system.free().cols()), stiffness);
    bool found = false;
    for (int step = 0; step < kMostSteps && best.iterations < cap && !found && !system.isBudgetSpent();
         ++step) {
      ++best.iterations;
      if (!matrix.factor(state.D, state.g)) break;
      const Velocities dx = matrix.solve(state.F);
      double part = 1.0;
      Round::State trial = round.at(state.x - dx, stiffness);
      for (int k = 0; k < kMostHalvings && !(trial.norm < (1.0 - 1e-4 * part) * state.norm); ++k) {
        part *= 0.5;
        trial = round.at(state.x - part * dx, stiffness);
      }
      if (!std::isfinite(trial.norm)) break;
      std::swap(state, trial);
      found = state.norm <= 0.1 * (state.x - state.F).norm();
      if (part < kCutShort && enough > kEveryDigit) break;
    }
    const Impulses next = r + state.d;
    if (!next.allFinite()) break;
    const Impulses velocity = system.relativeVelocities(next);
    const Residuals residuals = system.residuals(next, velocity);
    const double now = residuals.beyond_rounding;
    if (now < best.residuals.beyond_rounding) {
      best.r = next;
      best.residuals = residuals;
      if (now <= tolerance || (now <= enough && now > kHardlyLess * last)) break;
    }
    if (!found) {
      stiffness = std::min(0.1 * stiffness, std::max(kTrust / best.residuals.beyond_rounding, 1.0));
      growth = std::max(std::sqrt(growth), kLeastGrowth);
      if (now >= last) continue;
    } else if (now > 0.1 * last) {
      stiffness = std::min(growth * stiffness, kMostStiffness);
    }
    r = next, u = velocity;
    last = now;
  }
  return best;
}

}  // namespace rbs::coulomb
