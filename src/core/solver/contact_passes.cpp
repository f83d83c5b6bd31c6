// SPDX-License-Identifier: BSD-3-Clause
// The passes of the soft step over its pairs, four at a time.
#include "effects_built.h"
#include "narrowphase/manifold.h"
#include "solver/contact_lanes.h"
#include "solver/lanes.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

namespace rbs {

using namespace lanes;

namespace {

// Share of its bound by which friction that sticks is below it.
constexpr double kAtBound = 1e-9;

}  // namespace

void ContactLanes::warmStart() {
  inOrder([this](std::size_t begin, std::size_t end) { warmStart(begin, end); });
}

// The moments of all points of a pair turn its bodies once.
RBS_WIDE void ContactLanes::warmStart(std::size_t begin, std::size_t end) {
  const Lanes zero{};
  for (std::size_t b = begin; b < end; ++b) {
    const Bundle& bundle = bundles_[b];
    Lanes total[3] = {zero, zero, zero};
    Lanes by_normal_i[3] = {zero, zero, zero}, by_normal_j[3] = {zero, zero, zero};  // moments
    Lanes moment_i[3] = {zero, zero, zero}, moment_j[3] = {zero, zero, zero};        // of friction
    for (int k = 0; k < bundle.size; ++k) {
      const NormalRow& row = normal_[bundle.normal + k];
      total[0] += row.impulse;
      const auto addNormal = [&](const Lanes* arm, Lanes* moment) __attribute__((always_inline)) {
        moment[1] += arm[2] * row.impulse;
        moment[2] -= arm[1] * row.impulse;
      };
      addNormal(row.arm_i, by_normal_i);
      addNormal(row.arm_j, by_normal_j);
      if (!built::friction || !bundle.has_friction) continue;
      const FrictionRow& friction = friction_[bundle.friction + k];
      total[1] += friction.impulse1;
      total[2] += friction.impulse2;
      const auto addFriction = [&](const Lanes* arm, Lanes* moment) __attribute__((always_inline)) {
        moment[0] += arm[1] * friction.impulse2 - arm[2] * friction.impulse1;
        moment[1] -= arm[0] * friction.impulse2;
        moment[2] += arm[0] * friction.impulse1;
      };
      addFriction(row.arm_i, moment_i);
      addFriction(row.arm_j, moment_j);
    }
    if (bundle.has_axes) leaveOut(axes_[b].i, by_normal_i), leaveOut(axes_[b].j, by_normal_j);
    for (int c = 0; c < 3; ++c) moment_i[c] += by_normal_i[c], moment_j[c] += by_normal_j[c];
    Lanes turn_i[3], turn_j[3], turn_W[6], impulse[3], v[6], w[6];
    turn(bundle.inv_inertia_i, moment_i, turn_i);
    turn(bundle.inv_inertia_j, moment_j, turn_j);
    fromFrame(bundle.frame, turn_i, turn_W);
    fromFrame(bundle.frame, turn_j, turn_W + 3);
    fromFrame(bundle.frame, total, impulse);
    gatherTwists(bundle.i, v, w);
    gatherTwists(bundle.j, v + 3, w + 3);
    for (int c = 0; c < 3; ++c) {
      v[c] -= bundle.inv_mass_i * impulse[c];
      v[3 + c] += bundle.inv_mass_j * impulse[c];
      w[c] -= turn_W[c];
      w[3 + c] += turn_W[3 + c];
    }
    scatterTwists(v, w, bundle.to_i);
    scatterTwists(v + 3, w + 3, bundle.to_j);
  }
}

// Measures the gaps where the bodies have moved since, and how bodies turn whose axes have turned, with the masses along the
// rows of their contacts. A pass does it for each bundle that it reads, so that the rows come from memory once.
//
// The bodies moved by x, and their surfaces turned by theta. A point of the surface at r has gone to
// x + exp([theta]) r, to second order x + theta x r + theta x (theta x r)/2.
RBS_WIDE void ContactLanes::follow(std::size_t b) {
  const Bundle& bundle = bundles_[b];
  std::array<bool, kLanes> turned;
  for (int lane = 0; lane < kLanes; ++lane)
    turned[lane] = bundle.i[lane]->turned_axes || bundle.j[lane]->turned_axes;
  if (std::any_of(turned.begin(), turned.end(), [](bool one) { return one; })) {
    findTurns(b);
    findMasses(b, turned);
  }
  // c, with n . (theta x r + theta x (theta x r)/2) = c . r, in the frame of the contact
  const auto turning = [&](const std::array<SolverBody*, kLanes>& bodies, const Lanes* then, Lanes* c) {
    Lanes theta_W[3], theta[3];
    gather(bodies, &SolverBody::surface_turned, theta_W);
    toFrame(bundle.frame, theta_W, theta);
    for (int k = 0; k < 3; ++k) theta[k] -= then[k];
    c[0] = -0.5 * (theta[1] * theta[1] + theta[2] * theta[2]);
    c[1] = 0.5 * theta[0] * theta[1] - theta[2];
    c[2] = 0.5 * theta[0] * theta[2] + theta[1];
  };
  Lanes c_i[3], c_j[3], moved_i[3], moved_j[3];
  turning(bundle.i, starts_[b].turned_i, c_i);
  turning(bundle.j, starts_[b].turned_j, c_j);
  gather(bundle.i, &SolverBody::moved, moved_i);
  gather(bundle.j, &SolverBody::moved, moved_j);
  const Lanes moved[3] = {moved_j[0] - moved_i[0], moved_j[1] - moved_i[1], moved_j[2] - moved_i[2]};
  Lanes shift;
  dot(bundle.frame[0], moved, shift);
  shift -= starts_[b].shift;
  for (int k = 0; k < bundle.size; ++k) {
    NormalRow& row = normal_[bundle.normal + k];
    Lanes by_i, by_j;
    dot(c_i, row.arm_i, by_i);
    dot(c_j, row.arm_j, by_j);
    row.open = row.gap + shift + by_j - by_i;
  }
}

// In the frame of the contact, n, t1, t2. There u is the velocity of the centre of j against that of i. Impulses p change it
// by (1/m_i + 1/m_j) p. At an arm (r_n, r_1, r_2) unit impulses along n, t1 and t2 have the moments
//   (0, r_2, -r_1),   (-r_2, 0, r_n),   (r_1, -r_n, 0).
RBS_INLINE void ContactLanes::read(const Bundle& bundle, InPass& pairs) const {
  gatherTwists(bundle.i, pairs.v, pairs.w_W);
  gatherTwists(bundle.j, pairs.v + 3, pairs.w_W + 3);
  Lanes apart[3];
  for (int c = 0; c < 3; ++c) apart[c] = pairs.v[3 + c] - pairs.v[c];
  toFrame(bundle.frame, apart, pairs.u);
  toFrame(bundle.frame, pairs.w_W, pairs.w_i);
  toFrame(bundle.frame, pairs.w_W + 3, pairs.w_j);
  for (int c = 0; c < 3; ++c) {
    pairs.first_i[c] = pairs.w_i[c], pairs.first_j[c] = pairs.w_j[c];
    fill(pairs.total[c], 0.0);
  }
  pairs.inv_mass = bundle.inv_mass_i + bundle.inv_mass_j;
}

RBS_INLINE void ContactLanes::write(const Bundle& bundle, InPass& pairs) const {
  Lanes impulse[3], turned_i[3], turned_j[3];
  for (int c = 0; c < 3; ++c) pairs.w_i[c] -= pairs.first_i[c], pairs.w_j[c] -= pairs.first_j[c];
  fromFrame(bundle.frame, pairs.total, impulse);
  fromFrame(bundle.frame, pairs.w_i, turned_i);
  fromFrame(bundle.frame, pairs.w_j, turned_j);
  for (int c = 0; c < 3; ++c) {
    pairs.v[c] -= bundle.inv_mass_i * impulse[c];
    pairs.v[3 + c] += bundle.inv_mass_j * impulse[c];
    pairs.w_W[c] += turned_i[c];
    pairs.w_W[3 + c] += turned_j[c];
  }
  scatterTwists(pairs.v, pairs.w_W, bundle.to_i);
  scatterTwists(pairs.v + 3, pairs.w_W + 3, bundle.to_j);
}

// Of all points, or again of those that slide, which the first time marks.
template <bool kMarks, bool kAgain>
RBS_INLINE void ContactLanes::solveFriction(const Bundle& bundle, InPass& pairs, LaneMask* slides) {
  Lanes zero;
  fill(zero, 0.0);
  Lanes *u = pairs.u, *w_i = pairs.w_i, *w_j = pairs.w_j;
  const Lanes *I = bundle.inv_inertia_i, *J = bundle.inv_inertia_j;
  for (int k = 0; k < bundle.size; ++k) {
    FrictionRow& row = friction_[bundle.friction + k];
    const NormalRow& normal = normal_[bundle.normal + k];
    const Lanes limit = bundle.mu * normal.impulse;
    const LaneMask pushes = limit > zero || row.impulse1 != zero || row.impulse2 != zero;
    if (kAgain && !any(slides[k] & pushes)) continue;
    const Lanes *r = normal.arm_i, *s = normal.arm_j;
    const Lanes slip1 = u[1] + ((w_j[2] * s[0] - w_j[0] * s[2]) - (w_i[2] * r[0] - w_i[0] * r[2]));
    const Lanes slip2 = u[2] + ((w_j[0] * s[1] - w_j[1] * s[0]) - (w_i[0] * r[1] - w_i[1] * r[0]));
    Lanes l1 = row.impulse1 - (row.mass11 * slip1 + row.mass12 * slip2);
    Lanes l2 = row.impulse2 - (row.mass12 * slip1 + row.mass22 * slip2);
    const LaneMask slide = l1 * l1 + l2 * l2 > limit * limit;
    if (any(slide)) {
      const Lanes r1 = row.impulse1 - row.rho * slip1, r2 = row.impulse2 - row.rho * slip2;
      const Lanes square = r1 * r1 + r2 * r2;
      Lanes length;
      for (int lane = 0; lane < kLanes; ++lane) length[lane] = std::sqrt(square[lane]);
      const Lanes share = length > limit ? limit / length : zero + 1.0;
      l1 = slide ? share * r1 : l1;
      l2 = slide ? share * r2 : l2;
    }
    if (kAgain) {
      l1 = slides[k] ? l1 : row.impulse1;
      l2 = slides[k] ? l2 : row.impulse2;
    }
    if (kMarks) slides[k] = slide;
    const Lanes change1 = l1 - row.impulse1, change2 = l2 - row.impulse2;
    row.impulse1 = l1;
    row.impulse2 = l2;
    u[1] += pairs.inv_mass * change1;
    u[2] += pairs.inv_mass * change2;
    pairs.total[1] += change1;
    pairs.total[2] += change2;
    w_i[0] -= change1 * (r[0] * I[2] - r[2] * I[0]) + change2 * (r[1] * I[0] - r[0] * I[1]);
    w_i[1] -= change1 * (r[0] * I[4] - r[2] * I[1]) + change2 * (r[1] * I[1] - r[0] * I[3]);
    w_i[2] -= change1 * (r[0] * I[5] - r[2] * I[2]) + change2 * (r[1] * I[2] - r[0] * I[4]);
    w_j[0] += change1 * (s[0] * J[2] - s[2] * J[0]) + change2 * (s[1] * J[0] - s[0] * J[1]);
    w_j[1] += change1 * (s[0] * J[4] - s[2] * J[1]) + change2 * (s[1] * J[1] - s[0] * J[3]);
    w_j[2] += change1 * (s[0] * J[5] - s[2] * J[2]) + change2 * (s[1] * J[2] - s[0] * J[4]);
  }
}

// A pass waits for what one point after the other does to the next. Along the normals it keeps three numbers for that:
// d_0, what the impulses p_k have changed of the normal velocity of j against i at the centre of i, and d_1 and d_2, what they
// have changed of the spins of j against i along t1 and t2. With r the arm on i, the speed at a point is
//   u_n = what it was + g.d,   g = (1, r_2, -r_1),   d = K sum g_k p_k,
//   K = diag(1/m_i + 1/m_j, 0, 0) + G_i^T I_i^-1 G_i + G_j^T I_j^-1 G_j.
// G g is the moment on a body: G_i g = (0, g_1, g_2), and G_j g = (0, g_1 + D_2, g_2 - D_1), where D = r_j - r_i, from the centre
// of j to that of i, is the same for all points. K g_k waits for no impulse. Where i does not move, the centre of j stands in
// for its, and D is zero: only one arm of a point on an arc (SolverContacts::followArc) is then asked for.
//
// The normal of a surface of revolution goes through its axis. So a normal impulse has no moment about that axis, though
// the place of a point may be one of a while ago, or one of a few that stand for a rim: along normals, spins and
// inertias are without their parts along it.
template <Pass kPass>
RBS_INLINE void ContactLanes::solveNormals(const Bundle& bundle, const Axes& axes, const SoftLanes& soft,
                                           InPass& pairs) {
  Lanes zero;
  fill(zero, 0.0);
  const Lanes *u = pairs.u, *I = bundle.inv_inertia_i, *J = bundle.inv_inertia_j;
  const LaneMask moves = bundle.inv_mass_i > zero;
  const NormalRow& front = normal_[bundle.normal];
  const Lanes D1 = moves ? front.arm_j[1] - front.arm_i[1] : zero;
  const Lanes D2 = moves ? front.arm_j[2] - front.arm_i[2] : zero;
  Lanes n_i[3], n_j[3], I_n[6], J_n[6];  // the spins and inertias, without axes of revolution
  for (int c = 0; c < 3; ++c) n_i[c] = pairs.w_i[c], n_j[c] = pairs.w_j[c];
  for (int c = 0; c < 6; ++c) I_n[c] = I[c], J_n[c] = J[c];
  if (bundle.has_axes) {
    leaveOut(axes.i, n_i);
    leaveOut(axes.j, n_j);
    leaveOutOfMatrix(axes.i, I_n);
    leaveOutOfMatrix(axes.j, J_n);
  }
  const Lanes K11 = I_n[3] + J_n[3], K12 = I_n[4] + J_n[4], K22 = I_n[5] + J_n[5];
  const Lanes K01 = J_n[3] * D2 - J_n[4] * D1, K02 = J_n[4] * D2 - J_n[5] * D1;
  const Lanes K00 = pairs.inv_mass + (K01 * D2 - K02 * D1);
  Lanes d0 = zero, d1 = zero, d2 = zero, moment1 = zero, moment2 = zero;
  for (int k = 0; k < bundle.size; ++k) {
    NormalRow& row = normal_[bundle.normal + k];
    const auto open = row.open > zero;
    Lanes at_rest, mass;  // the impulse that a point at rest would get
    if (kPass == Pass::Soft) {
      const Lanes closing = soft.bias * row.open, capped = closing > -bundle.push ? closing : -bundle.push;
      const Lanes target = open ? soft.per_second * row.open : capped;
      const Lanes kept = open ? row.impulse : row.impulse - soft.impulse * row.impulse;
      mass = open ? row.mass : soft.mass * row.mass;
      at_rest = kept - mass * target;
    } else {
      // Points without an impulse stay so.
      mass = row.impulse == zero ? zero : row.mass;
      at_rest = row.impulse - mass * (open ? soft.per_second * row.open : zero);
    }
    const Lanes *r = row.arm_i, *s = row.arm_j;
    const Lanes speed = u[0] + ((n_j[1] * s[2] - n_j[2] * s[1]) - (n_i[1] * r[2] - n_i[2] * r[1]));
    const Lanes arm1 = moves ? r[1] : s[1], arm2 = moves ? r[2] : s[2];
    const Lanes k0 = K00 + (arm2 * K01 - arm1 * K02), k1 = K01 + (arm2 * K11 - arm1 * K12),
                k2 = K02 + (arm2 * K12 - arm1 * K22);
    const Lanes by1 = mass * arm2, by2 = mass * arm1;
    Lanes l_n = ((at_rest - mass * speed) - mass * d0) - (d1 * by1 - d2 * by2);
    l_n = l_n > zero ? l_n : zero;
    const Lanes change = l_n - row.impulse;
    row.impulse = l_n;
    d0 += change * k0;
    d1 += change * k1;
    d2 += change * k2;
    pairs.total[0] += change;
    moment1 += change * arm2;
    moment2 -= change * arm1;
  }
  pairs.u[0] += pairs.inv_mass * pairs.total[0];
  const Lanes at_j1 = moment1 + D2 * pairs.total[0], at_j2 = moment2 - D1 * pairs.total[0];
  Lanes turn_i[3], turn_j[3];
  if (bundle.has_axes) {
    Lanes moment_i[3] = {zero, moment1, moment2}, moment_j[3] = {zero, at_j1, at_j2};
    leaveOut(axes.i, moment_i);
    leaveOut(axes.j, moment_j);
    turn(I, moment_i, turn_i);
    turn(J, moment_j, turn_j);
  } else {
    turnAcross(I, moment1, moment2, turn_i);
    turnAcross(J, at_j1, at_j2, turn_j);
  }
  for (int c = 0; c < 3; ++c) pairs.w_i[c] -= turn_i[c], pairs.w_j[c] += turn_j[c];
}

RBS_INLINE void ContactLanes::addToSums(const Bundle& bundle, bool has_friction) {
  for (int k = 0; k < bundle.size; ++k) {
    SumRow& sum = sums_[bundle.normal + k];
    sum.n += normal_[bundle.normal + k].impulse;
    if (!has_friction) continue;
    const FrictionRow& row = friction_[bundle.friction + k];
    sum.t1 += row.impulse1;
    sum.t2 += row.impulse2;
  }
}

template <Pass kPass, bool kFriction>
RBS_WIDE void ContactLanes::solveBundles(std::size_t begin, std::size_t end, const Softness& soft, double h) {
  SoftLanes of;
  fill(of.per_second, 1.0 / h);
  fill(of.bias, soft.bias);
  fill(of.mass, soft.mass);
  fill(of.impulse, soft.impulse);
  LaneMask slides[Manifold::kPoints];
  for (std::size_t b = begin; b < end; ++b) {
    if (kPass != Pass::Soft) follow(b);
    const Bundle& bundle = bundles_[b];
    const bool has_friction = kFriction && bundle.has_friction;
    InPass pairs;
    read(bundle, pairs);
    if (has_friction) solveFriction<kPass != Pass::Soft, false>(bundle, pairs, slides);
    solveNormals<kPass>(bundle, axes_[b], of, pairs);
    if (kPass != Pass::Soft && has_friction) solveFriction<false, true>(bundle, pairs, slides);
    if (kPass == Pass::Last) addToSums(bundle, has_friction);
    write(bundle, pairs);
  }
}

// Without friction not a test of it is left in the loop.
void ContactLanes::solve(Pass pass, const Softness& soft, double h) {
  const bool has_friction = built::friction && !friction_.empty();
  const auto solveAs = [&](auto of) {
    constexpr Pass kPass = decltype(of)::value;
    inOrder([&](std::size_t begin, std::size_t end) {
      has_friction ? solveBundles<kPass, built::friction>(begin, end, soft, h)
                   : solveBundles<kPass, false>(begin, end, soft, h);
    });
  };
  if (pass == Pass::Soft) solveAs(std::integral_constant<Pass, Pass::Soft>());
  if (pass == Pass::Relax) solveAs(std::integral_constant<Pass, Pass::Relax>());
  if (pass == Pass::Last) solveAs(std::integral_constant<Pass, Pass::Last>());
}

// A point with an impulse l is at rest along the normal, and one that touches without one does not close. Friction |l_T| <= mu l
// ends the slip u_T, or is at that bound and against it.
RBS_WIDE void ContactLanes::measure(std::size_t which, double unit) {
  const Bundle& bundle = bundles_[which];
  InPass pairs;
  read(bundle, pairs);
  Lanes zero, per_unit;
  fill(zero, 0.0);
  fill(per_unit, 1.0 / unit);
  Lanes n_i[3], n_j[3];  // the spins, without those about axes of revolution
  for (int c = 0; c < 3; ++c) n_i[c] = pairs.w_i[c], n_j[c] = pairs.w_j[c];
  if (bundle.has_axes) leaveOut(axes_[which].i, n_i), leaveOut(axes_[which].j, n_j);
  const auto raise = [](Lanes & most, const Lanes& by) __attribute__((always_inline)) {
    most = most > by ? most : by;
  };
  const auto findLength = [](const Lanes& x, const Lanes& y, Lanes& length) __attribute__((always_inline)) {
    const Lanes square = x * x + y * y;
    for (int lane = 0; lane < kLanes; ++lane) length[lane] = std::sqrt(square[lane]);
  };
  Lanes signorini = zero, coulomb = zero, dissipation = zero;
  for (int k = 0; k < bundle.size; ++k) {
    const NormalRow& row = normal_[bundle.normal + k];
    const Lanes *r = row.arm_i, *s = row.arm_j, *u = pairs.u, *w_i = pairs.w_i, *w_j = pairs.w_j;
    const LaneMask is_point = row.mass > zero, pushes = row.impulse != zero;
    const Lanes speed = u[0] + ((n_j[1] * s[2] - n_j[2] * s[1]) - (n_i[1] * r[2] - n_i[2] * r[1]));
    const Lanes closes = row.open <= zero ? -speed : zero;
    const Lanes off = pushes ? (speed > zero ? speed : -speed) : closes;
    raise(signorini, is_point ? off * per_unit : zero);
    if (!built::friction || !bundle.has_friction) continue;
    const FrictionRow& friction = friction_[bundle.friction + k];
    const Lanes slip1 = u[1] + ((w_j[2] * s[0] - w_j[0] * s[2]) - (w_i[2] * r[0] - w_i[0] * r[2]));
    const Lanes slip2 = u[2] + ((w_j[0] * s[1] - w_j[1] * s[0]) - (w_i[0] * r[1] - w_i[1] * r[0]));
    const Lanes limit = bundle.mu * row.impulse;
    Lanes slip, force, left;
    findLength(slip1, slip2, slip);
    findLength(friction.impulse1, friction.impulse2, force);
    const LaneMask sticks = force < limit * (1.0 - kAtBound), rubs = pushes && bundle.mu > zero;
    const Lanes share = sticks ? zero : slip / force;
    const Lanes left1 = slip1 + share * friction.impulse1, left2 = slip2 + share * friction.impulse2;
    findLength(left1, left2, left);
    raise(coulomb, rubs ? (force - limit) / row.mass * per_unit : zero);
    raise(dissipation, rubs ? left * per_unit : zero);
  }
  for (int lane = 0; lane < kLanes; ++lane)
    if (bundle.block[lane] != kNone)
      contacts_.blocks[bundle.block[lane]].residuals = {signorini[lane], coulomb[lane], dissipation[lane]};
}

void ContactLanes::measure(double unit) {
  forBundles([&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) measure(b, unit);
  });
}

}  // namespace rbs
