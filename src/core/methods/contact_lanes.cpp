// SPDX-License-Identifier: BSD-3-Clause
#include "methods/contact_lanes.h"

#include "effects_built.h"

#include <algorithm>
#include <cmath>

// GCC 12 takes a vector that is made of four numbers for one that is read before it is made.
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"

namespace rbs {

namespace {

// All of these are part of the loops that call them: vectors are not passed about.
#define RBS_INLINE [[gnu::always_inline]] inline
// Compiled twice, for processors with AVX2 and without; which to take is found out when the program starts.
// Both give the same bits: they differ in how many lanes an instruction has. Clang, which fuzzing uses, wants
// such functions declared before they are called; it compiles them once.
#if defined(__x86_64__) && !defined(__clang__)
#define RBS_WIDE [[gnu::target_clones("avx2", "default")]]
#else
#define RBS_WIDE
#endif

RBS_INLINE void fill(Lanes& to, double value) {
  to = Lanes{value, value, value, value};
}

RBS_INLINE void set(Lanes* to, int lane, const Vec3& from) {
  for (int c = 0; c < 3; ++c) to[c][lane] = from[c];
}

RBS_INLINE void gather(const std::array<SolverBody*, kLanes>& from, Vec3 SolverBody::*what, Lanes* to) {
  const Vec3 &a = from[0]->*what, &b = from[1]->*what, &c = from[2]->*what, &d = from[3]->*what;
  to[0] = Lanes{a.x(), b.x(), c.x(), d.x()};
  to[1] = Lanes{a.y(), b.y(), c.y(), d.y()};
  to[2] = Lanes{a.z(), b.z(), c.z(), d.z()};
}

RBS_INLINE void scatter(const Lanes* from, Vec3 SolverBody::*what,
                        const std::array<SolverBody*, kLanes>& to) {
  for (int k = 0; k < kLanes; ++k)
    for (int c = 0; c < 3; ++c) (to[k]->*what)[c] = from[c][k];
}

RBS_INLINE void dot(const Lanes* a, const Lanes* b, Lanes& result) {
  result = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// c + a . b in as few sums one after another as can be: passes wait for it.
RBS_INLINE void add6(const Lanes& c, const Lanes* a, const Lanes* b, Lanes& result) {
  result = ((a[0] * b[0] + a[1] * b[1]) + (a[2] * b[2] + a[3] * b[3])) + ((a[4] * b[4] + a[5] * b[5]) + c);
}

RBS_INLINE void cross(const Lanes* a, const Lanes* b, Lanes* result) {
  result[0] = a[1] * b[2] - a[2] * b[1];
  result[1] = a[2] * b[0] - a[0] * b[2];
  result[2] = a[0] * b[1] - a[1] * b[0];
}

template <class Mask>
RBS_INLINE bool any(const Mask& mask) {
  return ((mask[0] | mask[1]) | (mask[2] | mask[3])) != 0;
}

}  // namespace

// --- between the contacts and the lanes

// Orders the pairs by level, within a level by friction and number of points, and cuts levels into bundles.
void ContactLanes::schedule() {
  constexpr int kSizes = 8;  // pairs with more points than that stand with those that have as many
  const std::vector<SolverBlock>& blocks = contacts_.blocks;
  std::vector<Index> level_of_body(contacts_.bodies.size(), 0), key(blocks.size(), kNone);
  Index levels = 0;
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    const SolverBlock& block = blocks[k];
    if (block.size == 0) continue;
    const Index level = std::max(level_of_body[block.i], level_of_body[block.j]);
    for (const Index body : {block.i, block.j})
      if (contacts_.bodies[body].inv_mass > 0.0) level_of_body[body] = level + 1;
    levels = std::max(levels, level + 1);
    key[k] = (2 * level + (block.rough ? 0 : 1)) * kSizes +
             static_cast<Index>(kSizes - std::min(block.size, kSizes));
  }
  std::vector<Index> first(2 * kSizes * levels + 1, 0), ordered;
  for (const Index one : key)
    if (one != kNone) ++first[one + 1];
  for (std::size_t k = 1; k < first.size(); ++k) first[k] += first[k - 1];
  ordered.resize(first.back());
  for (std::size_t k = 0; k < blocks.size(); ++k)
    if (key[k] != kNone) ordered[first[key[k]]++] = static_cast<Index>(k);

  bundles_.clear();
  normal_.clear();
  friction_.clear();
  places_.assign(blocks.size(), {});
  for (std::size_t k = 0; k < ordered.size();) {
    const Index group = key[ordered[k]] / kSizes;
    const std::size_t bundle = bundles_.size();
    for (int lane = 0; lane < kLanes && k < ordered.size() && key[ordered[k]] / kSizes == group; ++lane, ++k)
      append(bundle, ordered[k]);
  }
}

// Puts a block into the last bundle, or opens it.
void ContactLanes::append(std::size_t bundle, Index which) {
  const SolverBlock& block = contacts_.blocks[which];
  if (bundle == bundles_.size()) {
    Bundle fresh{};
    fresh.block.fill(kNone);
    fresh.i.fill(&nobody_);
    fresh.j.fill(&nobody_);
    fresh.rough = block.rough;
    fresh.normal = normal_.size();
    fresh.friction = friction_.size();
    bundles_.push_back(fresh);
  }
  Bundle& last = bundles_.back();
  const auto lane = std::find(last.block.begin(), last.block.end(), kNone);
  *lane = which;
  places_[which] = {static_cast<Index>(bundle), static_cast<int>(lane - last.block.begin())};
  last.size = std::max(last.size, block.size);
  normal_.resize(last.normal + static_cast<std::size_t>(last.size));
  if (last.rough) friction_.resize(last.friction + static_cast<std::size_t>(last.size));
}

// Whether a block may go beside those of a bundle: there is a lane, and no body that both would move.
bool ContactLanes::accepts(const Bundle& bundle, const SolverBlock& block) const {
  if (bundle.block.back() != kNone || bundle.rough != block.rough) return false;
  for (const Index body : {block.i, block.j}) {
    const SolverBody* s = &contacts_.bodies[body];
    if (s->inv_mass == 0.0) continue;
    for (const Index other : bundle.block)
      if (other != kNone && (contacts_.blocks[other].i == body || contacts_.blocks[other].j == body))
        return false;
  }
  return true;
}

void ContactLanes::take() {
  schedule();
  for (std::size_t b = 0; b < bundles_.size(); ++b) takeBundle(b);
}

void ContactLanes::takeBundle(std::size_t bundle) {
  for (int lane = 0; lane < kLanes; ++lane) takeBlock({static_cast<Index>(bundle), lane});
  findRows(bundles_[bundle], {true, true, true, true});
}

// Where a lane has fewer points than its bundle has rows, the others are all zero.
void ContactLanes::takeBlock(Place place) {
  Bundle& bundle = bundles_[place.bundle];
  const int lane = place.lane;
  int size = 0;
  bundle.i[lane] = bundle.j[lane] = &nobody_;
  if (bundle.block[lane] != kNone) {
    const SolverBlock& block = contacts_.blocks[bundle.block[lane]];
    SolverBody &i = contacts_.bodies[block.i], &j = contacts_.bodies[block.j];
    size = block.size;
    bundle.i[lane] = &i;
    bundle.j[lane] = &j;
    set(bundle.n, lane, block.n);
    set(bundle.t1, lane, block.t1);
    set(bundle.t2, lane, block.t2);
    set(bundle.turned_i, lane, block.turned_i);
    set(bundle.turned_j, lane, block.turned_j);
    bundle.turns_i[lane] = i.round ? 0.0 : 1.0;
    bundle.turns_j[lane] = j.round ? 0.0 : 1.0;
    bundle.shift[lane] = block.n.dot(block.moved_j - block.moved_i);
    bundle.mu[lane] = block.mu;
    bundle.push[lane] = block.push;
    bundle.inv_mass_i[lane] = i.inv_mass;
    bundle.inv_mass_j[lane] = j.inv_mass;
    for (int k = 0; k < size; ++k) {
      const SolverPoint& point = contacts_.points[block.first + k];
      NormalRow& row = normal_[bundle.normal + k];
      set(row.arm_i, lane, point.r_i);
      set(row.arm_j, lane, point.r_j);
      row.gap[lane] = point.gap;
      row.open[lane] = point.open;
      row.impulse[lane] = point.l_n;
      row.sum[lane] = point.sum_n;
      if (!bundle.rough) continue;
      FrictionRow& friction = friction_[bundle.friction + k];
      friction.impulse1[lane] = point.l_t[0], friction.impulse2[lane] = point.l_t[1];
      friction.sum1[lane] = point.sum_t[0], friction.sum2[lane] = point.sum_t[1];
    }
  }
  for (int k = size; k < bundle.size; ++k) {
    NormalRow& row = normal_[bundle.normal + k];
    set(row.arm_i, lane, Vec3::Zero());
    set(row.arm_j, lane, Vec3::Zero());
    row.gap[lane] = row.open[lane] = row.impulse[lane] = row.sum[lane] = 0.0;
    if (!bundle.rough) continue;
    FrictionRow& friction = friction_[bundle.friction + k];
    friction.impulse1[lane] = friction.impulse2[lane] = friction.sum1[lane] = friction.sum2[lane] = 0.0;
  }
}

void ContactLanes::refresh(double now, double left) {
  const std::size_t known = bundles_.size();
  for (const Index k : contacts_.drifted()) {
    giveBackBlock(k);
    contacts_.refresh(k, now, left);
    const SolverBlock& block = contacts_.blocks[k];
    if (const Place place = places_[k]; place.bundle != kNone) {
      Bundle& bundle = bundles_[place.bundle];
      const bool room = block.size <= bundle.size;
      if (!room) bundle.block[place.lane] = kNone, places_[k] = {};
      takeBlock(place);
      std::array<bool, kLanes> drifted{};
      drifted[place.lane] = true;
      findRows(bundle, drifted);
      if (room) continue;
    }
    if (block.size == 0) continue;
    const bool beside = bundles_.size() > known && accepts(bundles_.back(), block);
    append(beside ? bundles_.size() - 1 : bundles_.size(), k);
  }
  for (std::size_t b = known; b < bundles_.size(); ++b) takeBundle(b);
}

// The rows of a bundle from the places of its points, with the masses of these lanes: those of others stay
// what they were when their points were found, whoever stands beside them.
RBS_WIDE void ContactLanes::findRows(const Bundle& bundle, const std::array<bool, kLanes>& found) {
  const auto setLever = [](Turning& turning, const Lanes* d, const NormalRow& row) {
    cross(d, row.arm_i, turning.lever);
    cross(row.arm_j, d, turning.lever + 3);
  };
  for (int k = 0; k < bundle.size; ++k) {
    NormalRow& row = normal_[bundle.normal + k];
    setLever(row.turning, bundle.n, row);
    if (!bundle.rough) continue;
    setLever(friction_[bundle.friction + k].turning1, bundle.t1, row);
    setLever(friction_[bundle.friction + k].turning2, bundle.t2, row);
  }
  findTurns(bundle);
  findMasses(bundle, found);
}

RBS_WIDE void ContactLanes::findTurns(const Bundle& bundle) {
  Lanes inv_i[9], inv_j[9];
  for (int c = 0; c < 9; ++c) {
    const auto of = [c](const SolverBody* body) { return body->inv_inertia_W.data()[c]; };
    inv_i[c] = Lanes{of(bundle.i[0]), of(bundle.i[1]), of(bundle.i[2]), of(bundle.i[3])};
    inv_j[c] = Lanes{of(bundle.j[0]), of(bundle.j[1]), of(bundle.j[2]), of(bundle.j[3])};
  }
  const auto setTurn = [&](Turning& turning) {  // the matrices are symmetric
    for (int c = 0; c < 3; ++c) {
      dot(inv_i + 3 * c, turning.lever, turning.turn[c]);
      dot(inv_j + 3 * c, turning.lever + 3, turning.turn[3 + c]);
    }
  };
  for (int k = 0; k < bundle.size; ++k) {
    setTurn(normal_[bundle.normal + k].turning);
    if (!bundle.rough) continue;
    setTurn(friction_[bundle.friction + k].turning1);
    setTurn(friction_[bundle.friction + k].turning2);
  }
}

// The inverse of what an impulse at a point does to the velocity there; in the contact plane a 2 x 2 matrix
// S, and rho the inverse of its largest eigenvalue.
RBS_WIDE void ContactLanes::findMasses(const Bundle& bundle, const std::array<bool, kLanes>& found) {
  const Lanes inv_mass = bundle.inv_mass_i + bundle.inv_mass_j;
  const Lanes fresh = {found[0] ? 1.0 : 0.0, found[1] ? 1.0 : 0.0, found[2] ? 1.0 : 0.0,
                       found[3] ? 1.0 : 0.0};
  for (int k = 0; k < bundle.size; ++k) {
    NormalRow& row = normal_[bundle.normal + k];
    Lanes response;
    add6(inv_mass, row.turning.lever, row.turning.turn, response);
    Lanes present;
    for (int lane = 0; lane < kLanes; ++lane)
      present[lane] =
          bundle.block[lane] != kNone && k < contacts_.blocks[bundle.block[lane]].size ? 1.0 : 0.0;
    const auto set = [&](Lanes& to, const Lanes& mass) {
      to = fresh != 0.0 ? (present != 0.0 ? mass : present) : to;
    };
    set(row.mass, 1.0 / response);
    if (!bundle.rough) continue;
    FrictionRow& friction = friction_[bundle.friction + k];
    Lanes s11, s12, s22;
    add6(inv_mass, friction.turning1.lever, friction.turning1.turn, s11);
    add6(Lanes{}, friction.turning1.lever, friction.turning2.turn, s12);
    add6(inv_mass, friction.turning2.lever, friction.turning2.turn, s22);
    const Lanes determinant = s11 * s22 - s12 * s12, half_trace = 0.5 * (s11 + s22);
    Lanes root = half_trace * half_trace - determinant;
    for (int lane = 0; lane < kLanes; ++lane) root[lane] = std::sqrt(std::max(root[lane], 0.0));
    set(friction.mass11, s22 / determinant);
    set(friction.mass12, -s12 / determinant);
    set(friction.mass22, s11 / determinant);
    set(friction.rho, 1.0 / (half_trace + root));
  }
}

void ContactLanes::giveBack() {
  for (std::size_t k = 0; k < places_.size(); ++k) giveBackBlock(static_cast<Index>(k));
}

void ContactLanes::giveBackBlock(Index which) {
  const auto [place, lane] = places_[which];
  if (place == kNone) return;
  const Bundle& bundle = bundles_[place];
  const SolverBlock& block = contacts_.blocks[which];
  for (int k = 0; k < block.size; ++k) {
    SolverPoint& point = contacts_.points[block.first + k];
    const NormalRow& row = normal_[bundle.normal + k];
    point.mass_n = row.mass[lane];
    point.open = row.open[lane];
    point.l_n = row.impulse[lane];
    point.sum_n = row.sum[lane];
    if (!bundle.rough) continue;
    const FrictionRow& friction = friction_[bundle.friction + k];
    point.mass_t << friction.mass11[lane], friction.mass12[lane], friction.mass12[lane],
        friction.mass22[lane];
    point.l_t << friction.impulse1[lane], friction.impulse2[lane];
    point.sum_t << friction.sum1[lane], friction.sum2[lane];
  }
}

// --- passes over the pairs

RBS_WIDE void ContactLanes::warmStart() {
  for (const Bundle& bundle : bundles_) {
    Lanes w[6];
    gather(bundle.i, &SolverBody::w, w);
    gather(bundle.j, &SolverBody::w, w + 3);
    Lanes along_n{}, along_t1{}, along_t2{};
    for (int k = 0; k < bundle.size; ++k) {
      const NormalRow& row = normal_[bundle.normal + k];
      along_n += row.impulse;
      for (int c = 0; c < 6; ++c) w[c] += row.impulse * row.turning.turn[c];
      if (!built::friction || !bundle.rough) continue;
      const FrictionRow& friction = friction_[bundle.friction + k];
      along_t1 += friction.impulse1;
      along_t2 += friction.impulse2;
      for (int c = 0; c < 6; ++c)
        w[c] += friction.impulse1 * friction.turning1.turn[c] + friction.impulse2 * friction.turning2.turn[c];
    }
    Lanes v[6];
    gather(bundle.i, &SolverBody::v, v);
    gather(bundle.j, &SolverBody::v, v + 3);
    for (int c = 0; c < 3; ++c) {
      const Lanes impulse = along_n * bundle.n[c] + along_t1 * bundle.t1[c] + along_t2 * bundle.t2[c];
      v[c] -= bundle.inv_mass_i * impulse;
      v[3 + c] += bundle.inv_mass_j * impulse;
    }
    scatter(v, &SolverBody::v, bundle.i);
    scatter(v + 3, &SolverBody::v, bundle.j);
    scatter(w, &SolverBody::w, bundle.i);
    scatter(w + 3, &SolverBody::w, bundle.j);
  }
}

// Along the normal and the tangents the linear velocities of a pair change by (1/m_i + 1/m_j) times the
// impulses, for all of its points: within a bundle it is enough to keep what they are against each other in
// that frame.
template <ContactLanes::Pass kPass, bool kRough>
RBS_WIDE void ContactLanes::solveBundles(const Softness& soft, double h) {
  Lanes zero, per_second, bias, soft_mass, soft_impulse;
  fill(zero, 0.0);
  fill(per_second, 1.0 / h);
  fill(bias, soft.bias);
  fill(soft_mass, soft.mass);
  fill(soft_impulse, soft.impulse);
  for (const Bundle& bundle : bundles_) {
    Lanes v[6], w[6];
    gather(bundle.i, &SolverBody::v, v);
    gather(bundle.j, &SolverBody::v, v + 3);
    gather(bundle.i, &SolverBody::w, w);
    gather(bundle.j, &SolverBody::w, w + 3);
    const Lanes apart[3] = {v[3] - v[0], v[4] - v[1], v[5] - v[2]};
    const Lanes inv_mass = bundle.inv_mass_i + bundle.inv_mass_j;
    Lanes total[3] = {zero, zero, zero};

    if (kRough && bundle.rough) {
      Lanes u1, u2, along1 = zero, along2 = zero;
      dot(bundle.t1, apart, u1);
      dot(bundle.t2, apart, u2);
      for (int k = 0; k < bundle.size; ++k) {
        FrictionRow& row = friction_[bundle.friction + k];
        const Lanes limit = bundle.mu * normal_[bundle.normal + k].impulse;
        Lanes slip1, slip2;
        add6(u1, row.turning1.lever, w, slip1);
        add6(u2, row.turning2.lever, w, slip2);
        Lanes l1 = row.impulse1 - (row.mass11 * slip1 + row.mass12 * slip2);
        Lanes l2 = row.impulse2 - (row.mass12 * slip1 + row.mass22 * slip2);
        const auto slides = l1 * l1 + l2 * l2 > limit * limit;
        if (any(slides)) {
          const Lanes r1 = row.impulse1 - row.rho * slip1, r2 = row.impulse2 - row.rho * slip2;
          const Lanes square = r1 * r1 + r2 * r2;
          Lanes length;
          for (int lane = 0; lane < kLanes; ++lane) length[lane] = std::sqrt(square[lane]);
          const Lanes share = length > limit ? limit / length : zero + 1.0;
          l1 = slides ? share * r1 : l1;
          l2 = slides ? share * r2 : l2;
        }
        const Lanes change1 = l1 - row.impulse1, change2 = l2 - row.impulse2;
        row.impulse1 = l1;
        row.impulse2 = l2;
        u1 += inv_mass * change1;
        u2 += inv_mass * change2;
        along1 += change1;
        along2 += change2;
        for (int c = 0; c < 6; ++c) w[c] += change1 * row.turning1.turn[c] + change2 * row.turning2.turn[c];
      }
      for (int c = 0; c < 3; ++c) total[c] = along1 * bundle.t1[c] + along2 * bundle.t2[c];
    }

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
      add6(u_n, row.turning.lever, w, speed);
      Lanes l_n = at_rest - mass * speed;
      l_n = l_n > zero ? l_n : zero;
      const Lanes change = l_n - row.impulse;
      row.impulse = l_n;
      u_n += inv_mass * change;
      along_n += change;
      for (int c = 0; c < 6; ++c) w[c] += change * row.turning.turn[c];
    }
    for (int c = 0; c < 3; ++c) {
      total[c] += along_n * bundle.n[c];
      v[c] -= bundle.inv_mass_i * total[c];
      v[3 + c] += bundle.inv_mass_j * total[c];
    }
    scatter(v, &SolverBody::v, bundle.i);
    scatter(v + 3, &SolverBody::v, bundle.j);
    scatter(w, &SolverBody::w, bundle.i);
    scatter(w + 3, &SolverBody::w, bundle.j);
  }
}

// Without friction not a test of it is left in the loop.
void ContactLanes::solve(Pass pass, const Softness& soft, double h) {
  const bool rough = built::friction && !friction_.empty();
  if (pass == Pass::Soft)
    rough ? solveBundles<Pass::Soft, built::friction>(soft, h) : solveBundles<Pass::Soft, false>(soft, h);
  else
    rough ? solveBundles<Pass::Relax, built::friction>(soft, h) : solveBundles<Pass::Relax, false>(soft, h);
}

RBS_WIDE void ContactLanes::addUp() {
  for (NormalRow& row : normal_) row.sum += row.impulse;
  for (FrictionRow& row : friction_) row.sum1 += row.impulse1, row.sum2 += row.impulse2;
}

RBS_WIDE void ContactLanes::follow() {
  for (const Bundle& bundle : bundles_) {
    const auto turned = [](const SolverBody* body) { return body->turned_axes; };
    if (std::any_of(bundle.i.begin(), bundle.i.end(), turned) ||
        std::any_of(bundle.j.begin(), bundle.j.end(), turned))
      findTurns(bundle);
    // c, with n . (theta x r + theta x (theta x r)/2) = c . r
    const auto turning = [&](const std::array<SolverBody*, kLanes>& bodies, const Lanes* then,
                             const Lanes& turns, Lanes* c) {
      Lanes theta[3];
      gather(bodies, &SolverBody::turned, theta);
      for (int k = 0; k < 3; ++k) theta[k] = turns * (theta[k] - then[k]);
      Lanes along, square;
      dot(theta, bundle.n, along);
      dot(theta, theta, square);
      cross(bundle.n, theta, c);
      for (int k = 0; k < 3; ++k) c[k] += 0.5 * (along * theta[k] - square * bundle.n[k]);
    };
    Lanes c_i[3], c_j[3], moved_i[3], moved_j[3];
    turning(bundle.i, bundle.turned_i, bundle.turns_i, c_i);
    turning(bundle.j, bundle.turned_j, bundle.turns_j, c_j);
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
  for (SolverBody& body : contacts_.bodies) body.turned_axes = false;
}

#undef RBS_WIDE
#undef RBS_INLINE

}  // namespace rbs
