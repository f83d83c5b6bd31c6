// SPDX-License-Identifier: BSD-3-Clause
// The passes of the soft step over its pairs, four at a time.
#include "effects_built.h"
#include "solver/contact_lanes.h"
#include "solver/lanes.h"

#include <algorithm>
#include <cmath>

namespace rbs {

using namespace lanes;

void ContactLanes::warmStart() {
  inOrder([this](std::size_t begin, std::size_t end) { warmStart(begin, end); });
}

RBS_WIDE void ContactLanes::warmStart(std::size_t begin, std::size_t end) {
  for (std::size_t b = begin; b < end; ++b) {
    const Bundle& bundle = bundles_[b];
    Lanes w[6];
    gather(bundle.i, &SolverBody::w, w);
    gather(bundle.j, &SolverBody::w, w + 3);
    Lanes along_n{}, along_t1{}, along_t2{};
    for (int k = 0; k < bundle.size; ++k) {
      const NormalRow& row = normal_[bundle.normal + k];
      along_n += row.impulse;
      for (int c = 0; c < 6; ++c) w[c] += row.impulse * row.turning.inv_inertia_jacobian[c];
      if (!built::friction || !bundle.has_friction) continue;
      const FrictionRow& friction = friction_[bundle.friction + k];
      along_t1 += friction.impulse1;
      along_t2 += friction.impulse2;
      for (int c = 0; c < 6; ++c)
        w[c] += friction.impulse1 * friction.turning1.inv_inertia_jacobian[c] +
                friction.impulse2 * friction.turning2.inv_inertia_jacobian[c];
    }
    Lanes v[6];
    gather(bundle.i, &SolverBody::v, v);
    gather(bundle.j, &SolverBody::v, v + 3);
    for (int c = 0; c < 3; ++c) {
      const Lanes impulse = along_n * bundle.n[c] + along_t1 * bundle.t1[c] + along_t2 * bundle.t2[c];
      v[c] -= bundle.inv_mass_i * impulse;
      v[3 + c] += bundle.inv_mass_j * impulse;
    }
    scatter(v, &SolverBody::v, bundle.to_i);
    scatter(v + 3, &SolverBody::v, bundle.to_j);
    scatter(w, &SolverBody::w, bundle.to_i);
    scatter(w + 3, &SolverBody::w, bundle.to_j);
  }
}

// Along the normal and the tangents the linear velocities of a pair change by (1/m_i + 1/m_j) times the
// impulses, for all of its points: within a bundle it is enough to keep what they are against each other in
// that frame.
template <ContactLanes::Pass kPass, bool kFriction>
RBS_WIDE void ContactLanes::solveBundles(std::size_t begin, std::size_t end, const Softness& soft, double h) {
  Lanes zero, per_second, bias, soft_mass, soft_impulse;
  fill(zero, 0.0);
  fill(per_second, 1.0 / h);
  fill(bias, soft.bias);
  fill(soft_mass, soft.mass);
  fill(soft_impulse, soft.impulse);
  for (std::size_t b = begin; b < end; ++b) {
    const Bundle& bundle = bundles_[b];
    Lanes v[6], w[6];
    gather(bundle.i, &SolverBody::v, v);
    gather(bundle.j, &SolverBody::v, v + 3);
    gather(bundle.i, &SolverBody::w, w);
    gather(bundle.j, &SolverBody::w, w + 3);
    const Lanes apart[3] = {v[3] - v[0], v[4] - v[1], v[5] - v[2]};
    const Lanes inv_mass = bundle.inv_mass_i + bundle.inv_mass_j;
    Lanes total[3] = {zero, zero, zero};

    // Of all points, or again of those that slide.
    const auto solveFriction = [&](bool again) __attribute__((always_inline)) {
      Lanes now[3], u1, u2, along1 = zero, along2 = zero;
      for (int c = 0; c < 3; ++c) now[c] = apart[c] + inv_mass * total[c];
      dot(bundle.t1, now, u1);
      dot(bundle.t2, now, u2);
      for (int k = 0; k < bundle.size; ++k) {
        FrictionRow& row = friction_[bundle.friction + k];
        const Lanes limit = bundle.mu * normal_[bundle.normal + k].impulse;
        const LaneMask pushes = limit > zero || row.impulse1 != zero || row.impulse2 != zero;
        if (again && !any(row.slides & pushes)) continue;
        Lanes slip1, slip2;
        add6(u1, row.turning1.jacobian, w, slip1);
        add6(u2, row.turning2.jacobian, w, slip2);
        Lanes l1 = row.impulse1 - (row.mass11 * slip1 + row.mass12 * slip2);
        Lanes l2 = row.impulse2 - (row.mass12 * slip1 + row.mass22 * slip2);
        const LaneMask slides = l1 * l1 + l2 * l2 > limit * limit;
        if (any(slides)) {
          const Lanes r1 = row.impulse1 - row.rho * slip1, r2 = row.impulse2 - row.rho * slip2;
          const Lanes square = r1 * r1 + r2 * r2;
          Lanes length;
          for (int lane = 0; lane < kLanes; ++lane) length[lane] = std::sqrt(square[lane]);
          const Lanes share = length > limit ? limit / length : zero + 1.0;
          l1 = slides ? share * r1 : l1;
          l2 = slides ? share * r2 : l2;
        }
        if (again) {
          l1 = row.slides ? l1 : row.impulse1;
          l2 = row.slides ? l2 : row.impulse2;
        }
        row.slides = slides;
        const Lanes change1 = l1 - row.impulse1, change2 = l2 - row.impulse2;
        row.impulse1 = l1;
        row.impulse2 = l2;
        u1 += inv_mass * change1;
        u2 += inv_mass * change2;
        along1 += change1;
        along2 += change2;
        for (int c = 0; c < 6; ++c)
          w[c] +=
              change1 * row.turning1.inv_inertia_jacobian[c] + change2 * row.turning2.inv_inertia_jacobian[c];
      }
      for (int c = 0; c < 3; ++c) total[c] += along1 * bundle.t1[c] + along2 * bundle.t2[c];
    };
    if (kFriction && bundle.has_friction) solveFriction(false);

    Lanes u_n, along_n = zero;
    dot(bundle.n, apart, u_n);
    for (int k = 0; k < bundle.size; ++k) {
      NormalRow& row = normal_[bundle.normal + k];
      const auto open = row.open > zero;
      Lanes at_rest, mass, speed;  // the impulse that a point at rest would get, what speed takes of it
      if (kPass == Pass::Soft) {
        const Lanes closing = bias * row.open, capped = closing > -bundle.push ? closing : -bundle.push;
        const Lanes target = open ? per_second * row.open : capped;
        const Lanes kept = open ? row.impulse : row.impulse - soft_impulse * row.impulse;
        mass = open ? row.mass : soft_mass * row.mass;
        at_rest = kept - mass * target;
      } else {
        // Points without an impulse stay so.
        mass = row.impulse == zero ? zero : row.mass;
        at_rest = row.impulse - mass * (open ? per_second * row.open : zero);
      }
      add6(u_n, row.turning.jacobian, w, speed);
      Lanes l_n = at_rest - mass * speed;
      l_n = l_n > zero ? l_n : zero;
      const Lanes change = l_n - row.impulse;
      row.impulse = l_n;
      u_n += inv_mass * change;
      along_n += change;
      for (int c = 0; c < 6; ++c) w[c] += change * row.turning.inv_inertia_jacobian[c];
    }
    for (int c = 0; c < 3; ++c) total[c] += along_n * bundle.n[c];
    if (kPass == Pass::Relax && kFriction && bundle.has_friction) solveFriction(true);
    for (int c = 0; c < 3; ++c) {
      v[c] -= bundle.inv_mass_i * total[c];
      v[3 + c] += bundle.inv_mass_j * total[c];
    }
    scatter(v, &SolverBody::v, bundle.to_i);
    scatter(v + 3, &SolverBody::v, bundle.to_j);
    scatter(w, &SolverBody::w, bundle.to_i);
    scatter(w + 3, &SolverBody::w, bundle.to_j);
  }
}

// Without friction not a test of it is left in the loop.
void ContactLanes::solve(Pass pass, const Softness& soft, double h) {
  const bool has_friction = built::friction && !friction_.empty();
  inOrder([&](std::size_t begin, std::size_t end) {
    if (pass == Pass::Soft)
      has_friction ? solveBundles<Pass::Soft, built::friction>(begin, end, soft, h)
                   : solveBundles<Pass::Soft, false>(begin, end, soft, h);
    else
      has_friction ? solveBundles<Pass::Relax, built::friction>(begin, end, soft, h)
                   : solveBundles<Pass::Relax, false>(begin, end, soft, h);
  });
}

void ContactLanes::addUp() {
  forBundles([this](std::size_t begin, std::size_t end) { addUp(begin, end); });
}

RBS_WIDE void ContactLanes::addUp(std::size_t begin, std::size_t end) {
  if (begin == end) return;
  const auto rowsUpTo = [&](std::size_t b, std::size_t Bundle::*first, std::size_t all) {
    return b < bundles_.size() ? bundles_[b].*first : all;
  };
  for (std::size_t k = bundles_[begin].normal; k < rowsUpTo(end, &Bundle::normal, normal_.size()); ++k)
    normal_[k].sum += normal_[k].impulse;
  for (std::size_t k = bundles_[begin].friction; k < rowsUpTo(end, &Bundle::friction, friction_.size());
       ++k) {
    FrictionRow& row = friction_[k];
    row.sum1 += row.impulse1, row.sum2 += row.impulse2;
  }
}

void ContactLanes::follow() {
  forBundles([this](std::size_t begin, std::size_t end) { follow(begin, end); });
}

RBS_WIDE void ContactLanes::follow(std::size_t begin, std::size_t end) {
  for (std::size_t b = begin; b < end; ++b) {
    const Bundle& bundle = bundles_[b];
    std::array<bool, kLanes> turned;
    for (int lane = 0; lane < kLanes; ++lane)
      turned[lane] = bundle.i[lane]->turned_axes || bundle.j[lane]->turned_axes;
    if (std::any_of(turned.begin(), turned.end(), [](bool one) { return one; })) {
      findTurns(bundle);
      findMasses(bundle, turned);
    }
    // c, with n . (theta x r + theta x (theta x r)/2) = c . r
    const auto turning = [&](const std::array<SolverBody*, kLanes>& bodies, const Lanes* then, Lanes* c) {
      Lanes theta[3];
      gather(bodies, &SolverBody::surface_turned, theta);
      for (int k = 0; k < 3; ++k) theta[k] -= then[k];
      Lanes along, square;
      dot(theta, bundle.n, along);
      dot(theta, theta, square);
      cross(bundle.n, theta, c);
      for (int k = 0; k < 3; ++k) c[k] += 0.5 * (along * theta[k] - square * bundle.n[k]);
    };
    Lanes c_i[3], c_j[3], moved_i[3], moved_j[3];
    turning(bundle.i, bundle.turned_i, c_i);
    turning(bundle.j, bundle.turned_j, c_j);
    gather(bundle.i, &SolverBody::moved, moved_i);
    gather(bundle.j, &SolverBody::moved, moved_j);
    const Lanes moved[3] = {moved_j[0] - moved_i[0], moved_j[1] - moved_i[1], moved_j[2] - moved_i[2]};
    Lanes shift;
    dot(bundle.n, moved, shift);
    shift -= bundle.shift;
    for (int k = 0; k < bundle.size; ++k) {
      NormalRow& row = normal_[bundle.normal + k];
      Lanes by_i, by_j;
      dot(c_i, row.arm_i, by_i);
      dot(c_j, row.arm_j, by_j);
      row.open = row.gap + shift + by_j - by_i;
    }
  }
}

}  // namespace rbs
