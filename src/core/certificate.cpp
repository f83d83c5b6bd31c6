// SPDX-License-Identifier: BSD-3-Clause
#include "certificate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

namespace rbs {

bool withinLimits(const Pose& pose, const Twist& twist) {
  const auto within = [](const Vec3& v, double limit) {
    return v.allFinite() && v.cwiseAbs().maxCoeff() <= limit;
  };
  return within(pose.p_WB, Limits::max_position) && pose.q_WB.coeffs().allFinite() &&
         within(twist.v_WB, Limits::max_speed) && within(twist.w_WB, Limits::max_spin);
}

void freeze(Context& context, Index i, const Pose& before, const Twist& twist_before) {
  Bodies& bodies = context.scene.bodies;
  bodies.pose[i] = before;
  bodies.twist[i] = twist_before;
  bodies.bringAttitude(i, context.step.t0);
  bodies.twist[i] = {};
  bodies.traits[i].frozen = true;
  bodies.refresh(i);
  context.step.report.warnings.push_back(
      {"non_finite",
       "body '" + bodies.name[i] +
           "' left all bounds and is frozen where it last was; delete it, or make it dynamic again "
           "with less speed, or shorten the step"});
}

namespace certificate {

namespace {

// Kinetic and potential energy of a body.
double energyOf(const Context& context, Index i, const Pose& pose, const Twist& twist) {
  const Bodies& bodies = context.scene.bodies;
  const Vec3 w_B = pose.q_WB.conjugate() * twist.w_WB;
  return 0.5 * (bodies.traits[i].mass * twist.v_WB.squaredNorm() +
                w_B.dot(bodies.inertia[i].moments.cwiseProduct(w_B))) -
         bodies.traits[i].mass * context.scene.gravity_W.dot(pose.p_WB);
}

// From the most expensive to the cheapest.
int rank(std::string_view method) {
  constexpr std::array<std::string_view, 7> methods{"admm",      "interior_point", "newton", "gauss_seidel",
                                                    "soft_step", "guess",          ""};
  return static_cast<int>(std::find(methods.begin(), methods.end(), method) - methods.begin());
}

void certifyIslands(Context& context) {
  const Bodies& bodies = context.scene.bodies;
  StepStore& step = context.step;
  for (Island& island : step.islands) {
    IslandCertificate& certificate = island.certificate;
    if (*certificate.method == 0) continue;
    for (const Index k : island.pairs) {
      const ContactPair& pair = step.contacts.pairs[k];
      if (pair.first < step.inherited) continue;
      certificate.contacts += pair.size;
      for (Index t = pair.first; t < pair.first + pair.size; ++t)
        certificate.deepest_penetration =
            std::max(certificate.deepest_penetration, -step.contacts.touches[t].separation);
    }
    if (certificate.contacts == 0) continue;
    certificate.bodies = static_cast<std::uint32_t>(island.bodies.size());
    for (const Index i : island.bodies) {
      certificate.energy_change += energyOf(context, i, bodies.pose[i], bodies.twist[i]) -
                                   energyOf(context, i, step.before[i], step.twist_before[i]);
      certificate.turn = std::max(certificate.turn, step.h() * bodies.twist[i].w_WB.norm());
    }
    step.report.certificates.push_back(std::move(certificate));
  }
}

}  // namespace

void add(IslandCertificate& certificate, const IslandCertificate& solve) {
  if (rank(solve.method) < rank(certificate.method)) certificate.method = solve.method;
  certificate.iterations += solve.iterations;
  certificate.signorini = std::max(certificate.signorini, solve.signorini);
  certificate.coulomb = std::max(certificate.coulomb, solve.coulomb);
  certificate.dissipation = std::max(certificate.dissipation, solve.dissipation);
  certificate.converged = certificate.converged && solve.converged;
}

Need need(const Census& c) {
  if (c.moved_by_forces == c.ballistic && c.led == 0) return {false, "no body can leave its parabola"};
  return {true, "the solver residuals of every island are checked in every step"};
}

void run(Context& context) {
  const Bodies& bodies = context.scene.bodies;
  StepStore& step = context.step;
  for (const std::vector<Index>* roster : {&context.scene.rosters.movers, &context.scene.rosters.led})
    for (const Index i : *roster)
      if (!withinLimits(bodies.pose[i], bodies.twist[i]))
        freeze(context, i, step.before[i], step.twist_before[i]);

  for (const ContactPair& pair : step.contacts.pairs) {
    if (pair.first < step.inherited) continue;
    step.report.contacts += pair.size;
    for (Index t = pair.first; t < pair.first + pair.size; ++t)
      step.report.deepest_penetration =
          std::max(step.report.deepest_penetration, -step.contacts.touches[t].separation);
  }
  certifyIslands(context);
}

}  // namespace certificate
}  // namespace rbs
