// SPDX-License-Identifier: BSD-3-Clause
// Where the points of the pairs stand in the lanes, and how they get there and back.
#include "solver/contact_lanes.h"

#include "solver/lanes.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace rbs {

using namespace lanes;

namespace {

constexpr std::size_t kBundlesOfAPart = 64;  // that a thread takes at a time

}  // namespace

// Orders the pairs by region and level, within a level by friction and number of points, and cuts levels into bundles.
void ContactLanes::schedule() {
  constexpr int kSizes = 8;  // pairs with more points than that stand with those that have as many
  const std::vector<SolverBlock>& blocks = contacts_.blocks;
  auto& [places, bundles, starts, axes, normal, friction, sums, regions, level_of_body, level, key, first,
         ordered, before, last_of_body] = stores_;
  level_of_body.assign(contacts_.bodies.size(), 0);
  level.assign(blocks.size(), kNone);
  Index levels = 0;
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    const SolverBlock& block = blocks[k];
    if (block.size == 0) continue;
    level[k] = std::max(level_of_body[block.i], level_of_body[block.j]);
    for (const Index body : {block.i, block.j})
      if (contacts_.bodies[body].inv_mass > 0.0) level_of_body[body] = level[k] + 1;
    levels = std::max(levels, level[k] + 1);
  }
  regions.split(contacts_, level, workers_.count());
  key.assign(blocks.size(), kNone);
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    if (level[k] == kNone) continue;
    const auto region = static_cast<Index>(regions.of(contacts_, blocks[k]));
    key[k] = (2 * (region * levels + level[k]) + (blocks[k].has_friction ? 0 : 1)) * kSizes +
             static_cast<Index>(kSizes - std::min(blocks[k].size, kSizes));
  }
  first.assign(2 * kSizes * levels * regions.count() + 1, 0);
  for (const Index one : key)
    if (one != kNone) ++first[one + 1];
  for (std::size_t k = 1; k < first.size(); ++k) first[k] += first[k - 1];
  ordered.resize(first.back());
  for (std::size_t k = 0; k < blocks.size(); ++k)
    if (key[k] != kNone) ordered[first[key[k]]++] = static_cast<Index>(k);

  bundles.clear();
  starts.clear();
  axes.clear();
  normal.clear();
  friction.clear();
  sums.clear();
  places.assign(blocks.size(), {});
  for (std::size_t k = 0; k < ordered.size();) {
    const Index group = key[ordered[k]] / kSizes;
    const std::size_t bundle = bundles.size();
    for (int lane = 0; lane < kLanes && k < ordered.size() && key[ordered[k]] / kSizes == group; ++lane, ++k)
      append(bundle, ordered[k], group / (2 * levels));
  }
  sinks_.resize(regions.count());
  if (regions.count() > 1) connectRegions();
}

// Which bundles wait for bundles of other regions.
void ContactLanes::connectRegions() {
  std::vector<std::array<Index, 2>>& before = stores_.before;
  std::vector<Index>& last_of_body = stores_.last_of_body;
  before.assign(contacts_.blocks.size(), {kNone, kNone});
  last_of_body.assign(contacts_.bodies.size(), kNone);
  for (Index k = 0; k < contacts_.blocks.size(); ++k) {
    const SolverBlock& block = contacts_.blocks[k];
    if (block.size == 0) continue;
    for (const int side : {0, 1}) {
      const Index body = side == 0 ? block.i : block.j;
      if (contacts_.bodies[body].inv_mass > 0.0) before[k][side] = std::exchange(last_of_body[body], k);
    }
  }
  std::vector<std::size_t> first(regions_.count() + 1, bundles_.size());
  for (std::size_t b = bundles_.size(); b-- > 0;) first[bundles_[b].region] = b;
  for (std::size_t r = regions_.count(); r-- > 0;) first[r] = std::min(first[r], first[r + 1]);
  regions_.setBundles(first);
  for (std::size_t b = 0; b < bundles_.size(); ++b)
    for (const Index block : bundles_[b].block)
      if (block != kNone)
        for (const Index one : before[block])
          if (one != kNone) regions_.need(b, places_[one].bundle);
  regions_.finish();
}

void ContactLanes::forBundles(const std::function<void(std::size_t, std::size_t)>& body) {
  if (regions_.count() == 1)
    return workers_.share(bundles_.size(), kBundlesOfAPart,
                          [&](auto, auto begin, auto end) { body(begin, end); });
  regions_.each(workers_, [&](std::size_t region) { body(regions_.begin(region), regions_.end(region)); });
  body(regions_.end(regions_.count() - 1), bundles_.size());
}

void ContactLanes::inOrder(const PassRegions::Body& body) {
  if (regions_.count() == 1) return body(0, bundles_.size());
  regions_.inOrder(workers_, body);
  body(regions_.end(regions_.count() - 1), bundles_.size());
}

// Puts a block into the last bundle, or opens it.
void ContactLanes::append(std::size_t bundle, Index which, std::size_t region) {
  const SolverBlock& block = contacts_.blocks[which];
  if (bundle == bundles_.size()) {
    Bundle fresh{};
    fresh.block.fill(kNone);
    fresh.i.fill(&nobody_);
    fresh.j.fill(&nobody_);
    fresh.region = region;
    fresh.has_friction = block.has_friction;
    fresh.normal = normal_.size();
    fresh.friction = friction_.size();
    bundles_.push_back(fresh);
    starts_.emplace_back();
    axes_.emplace_back();
  }
  Bundle& last = bundles_.back();
  const auto lane = std::find(last.block.begin(), last.block.end(), kNone);
  *lane = which;
  places_[which] = {static_cast<Index>(bundle), static_cast<int>(lane - last.block.begin()), block.size};
  last.size = std::max(last.size, block.size);
  normal_.resize(last.normal + static_cast<std::size_t>(last.size));
  sums_.resize(normal_.size());
  if (last.has_friction) friction_.resize(last.friction + static_cast<std::size_t>(last.size));
}

// Whether a block may go beside those of a bundle: there is a lane, and no body that both would move.
bool ContactLanes::accepts(const Bundle& bundle, const SolverBlock& block) const {
  if (bundle.block.back() != kNone || bundle.has_friction != block.has_friction) return false;
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
  forBundles([this](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) takeBundle(b);
  });
}

void ContactLanes::takeBundle(std::size_t bundle) {
  for (int lane = 0; lane < kLanes; ++lane) takeBlock({static_cast<Index>(bundle), lane});
  findTurns(bundle);
  findMasses(bundle, {true, true, true, true});
}

// Where a lane has fewer points than its bundle has rows, the others are all zero.
void ContactLanes::takeBlock(Place place) {
  Bundle& bundle = bundles_[place.bundle];
  const int lane = place.lane;
  int size = 0;
  bundle.i[lane] = bundle.j[lane] = &nobody_;
  bundle.to_i[lane] = bundle.to_j[lane] = &sinks_[bundle.region];
  if (bundle.block[lane] != kNone) {
    const SolverBlock& block = contacts_.blocks[bundle.block[lane]];
    SolverBody &i = contacts_.bodies[block.i], &j = contacts_.bodies[block.j];
    size = block.size;
    bundle.i[lane] = &i;
    bundle.j[lane] = &j;
    if (i.inv_mass > 0.0) bundle.to_i[lane] = &i;
    if (j.inv_mass > 0.0) bundle.to_j[lane] = &j;
    const auto inFrame = [&](const Vec3& a) {
      return Vec3(block.n.dot(a), block.t1.dot(a), block.t2.dot(a));
    };
    set(bundle.frame[0], lane, block.n);
    set(bundle.frame[1], lane, block.t1);
    set(bundle.frame[2], lane, block.t2);
    Start& start = starts_[place.bundle];
    set(start.turned_i, lane, inFrame(block.turned_i));
    set(start.turned_j, lane, inFrame(block.turned_j));
    start.shift[lane] = block.n.dot(block.moved_j - block.moved_i);
    bundle.mu[lane] = block.pair.mu;
    bundle.push[lane] = block.pair.push;
    bundle.inv_mass_i[lane] = i.inv_mass;
    bundle.inv_mass_j[lane] = j.inv_mass;
    for (int k = 0; k < size; ++k) {
      const SolverPoint& point = contacts_.points[block.first + k];
      NormalRow& row = normal_[bundle.normal + k];
      set(row.arm_i, lane, inFrame(point.r_i));
      set(row.arm_j, lane, inFrame(point.r_j));
      row.open[lane] = point.open;
      row.impulse[lane] = point.l_n;
      SumRow& sum = sums_[bundle.normal + k];
      row.gap[lane] = point.gap;
      sum.n[lane] = point.sum_n;
      sum.t1[lane] = point.sum_t[0], sum.t2[lane] = point.sum_t[1];
      if (!bundle.has_friction) continue;
      FrictionRow& friction = friction_[bundle.friction + k];
      friction.impulse1[lane] = point.l_t[0], friction.impulse2[lane] = point.l_t[1];
    }
  }
  for (int k = size; k < bundle.size; ++k) {
    NormalRow& row = normal_[bundle.normal + k];
    set(row.arm_i, lane, Vec3::Zero());
    set(row.arm_j, lane, Vec3::Zero());
    row.gap[lane] = row.open[lane] = row.impulse[lane] = 0.0;
    SumRow& sum = sums_[bundle.normal + k];
    sum.n[lane] = sum.t1[lane] = sum.t2[lane] = 0.0;
    if (!bundle.has_friction) continue;
    FrictionRow& friction = friction_[bundle.friction + k];
    friction.impulse1[lane] = friction.impulse2[lane] = 0.0;
  }
}

void ContactLanes::refresh(double now, double left) {
  const auto takeAgain = [this](Place place) {
    takeBlock(place);
    std::array<bool, kLanes> changed{};
    changed[place.lane] = true;
    findTurns(place.bundle);
    findMasses(place.bundle, changed);
  };
  for (Index k = 0; k < contacts_.blocks.size(); ++k) {
    if (!contacts_.blocks[k].on_arc || places_[k].bundle == kNone) continue;
    writePoints(k);
    contacts_.followArc(k, now);
    takeAgain(places_[k]);
  }
  const std::size_t known = bundles_.size();
  for (const Index k : contacts_.drifted()) {
    writePoints(k);
    contacts_.refresh(k, now, left);
    const SolverBlock& block = contacts_.blocks[k];
    if (const Place place = places_[k]; place.bundle != kNone) {
      Bundle& bundle = bundles_[place.bundle];
      const bool room = block.size <= place.room;
      if (!room) bundle.block[place.lane] = kNone, places_[k] = {};
      takeAgain(place);
      if (room) continue;
    }
    if (block.size == 0) continue;
    const bool beside = bundles_.size() > known && accepts(bundles_.back(), block);
    append(beside ? bundles_.size() - 1 : bundles_.size(), k, 0);
  }
  for (std::size_t b = known; b < bundles_.size(); ++b) takeBundle(b);
}

// How the bodies of a bundle turn as they lie now.
RBS_WIDE void ContactLanes::findTurns(std::size_t which) {
  Bundle& bundle = bundles_[which];
  const auto turnsOf = [&](const std::array<SolverBody*, kLanes>& bodies, Lanes* inv_inertia, Lanes* axis)
      __attribute__((always_inline)) {
    Lanes inv_W[3][3];  // its columns
    for (int c = 0; c < 9; ++c) {
      const auto of = [&](int lane) { return bodies[lane]->inv_inertia_W.data()[c]; };
      inv_W[c / 3][c % 3] = Lanes{of(0), of(1), of(2), of(3)};
    }
    for (int c = 0, at = 0; c < 3; ++c) {
      Lanes turn[3];
      toFrame(inv_W, bundle.frame[c], turn);  // the matrix is symmetric
      for (int d = c; d < 3; ++d) dot(bundle.frame[d], turn, inv_inertia[at++]);
    }
    Lanes axis_W[3];
    gather(bodies, &SolverBody::axis_W, axis_W);
    toFrame(bundle.frame, axis_W, axis);
  };
  Axes& axes = axes_[which];
  turnsOf(bundle.i, bundle.inv_inertia_i, axes.i);
  turnsOf(bundle.j, bundle.inv_inertia_j, axes.j);
  LaneMask found{};
  for (int c = 0; c < 3; ++c) found |= axes.i[c] != 0.0 || axes.j[c] != 0.0;
  bundle.has_axes = any(found);
}

// The inverse of what an impulse at a point does to the velocity there; in the contact plane a 2 x 2 matrix
// S, and rho the inverse of its largest eigenvalue.
RBS_WIDE void ContactLanes::findMasses(std::size_t which, const std::array<bool, kLanes>& found) {
  const Bundle& bundle = bundles_[which];
  const Axes& axes = axes_[which];
  const Lanes inv_mass = bundle.inv_mass_i + bundle.inv_mass_j;
  const Lanes fresh = {found[0] ? 1.0 : 0.0, found[1] ? 1.0 : 0.0, found[2] ? 1.0 : 0.0,
                       found[3] ? 1.0 : 0.0};
  for (int k = 0; k < bundle.size; ++k) {
    NormalRow& row = normal_[bundle.normal + k];
    Lanes present;
    for (int lane = 0; lane < kLanes; ++lane)
      present[lane] =
          bundle.block[lane] != kNone && k < contacts_.blocks[bundle.block[lane]].size ? 1.0 : 0.0;
    const auto set = [&](Lanes& to, const Lanes& mass) {
      to = fresh != 0.0 ? (present != 0.0 ? mass : present) : to;
    };
    Lanes response = inv_mass, s11 = inv_mass, s12{}, s22 = inv_mass;
    const auto addTurns = [&](const Lanes* arm, const Lanes* axis, const Lanes* inv_inertia) {
      const Lanes zero{};
      Lanes n[3] = {zero, arm[2], -arm[1]};
      const Lanes t1[3] = {-arm[2], zero, arm[0]}, t2[3] = {arm[1], -arm[0], zero};
      if (bundle.has_axes) leaveOut(axis, n);
      Lanes turns[3], part;
      turn(inv_inertia, n, turns);
      dot(n, turns, part);
      response += part;
      if (!bundle.has_friction) return;
      turn(inv_inertia, t1, turns);
      dot(t1, turns, part);
      s11 += part;
      dot(t2, turns, part);
      s12 += part;
      turn(inv_inertia, t2, turns);
      dot(t2, turns, part);
      s22 += part;
    };
    addTurns(row.arm_i, axes.i, bundle.inv_inertia_i);
    addTurns(row.arm_j, axes.j, bundle.inv_inertia_j);
    set(row.mass, 1.0 / response);
    if (!bundle.has_friction) continue;
    FrictionRow& friction = friction_[bundle.friction + k];
    const Lanes determinant = s11 * s22 - s12 * s12, half_trace = 0.5 * (s11 + s22);
    Lanes root = half_trace * half_trace - determinant;
    for (int lane = 0; lane < kLanes; ++lane) root[lane] = std::sqrt(std::max(root[lane], 0.0));
    set(friction.mass11, s22 / determinant);
    set(friction.mass12, -s12 / determinant);
    set(friction.mass22, s11 / determinant);
    set(friction.rho, 1.0 / (half_trace + root));
  }
}

void ContactLanes::scaleImpulses(const std::function<double(const SolverBlock&)>& share) {
  for (const Bundle& bundle : bundles_)
    for (int lane = 0; lane < kLanes; ++lane) {
      if (bundle.block[lane] == kNone) continue;
      const double factor = share(contacts_.blocks[bundle.block[lane]]);
      for (int k = 0; k < bundle.size; ++k) {
        normal_[bundle.normal + k].impulse[lane] *= factor;
        if (!bundle.has_friction) continue;
        friction_[bundle.friction + k].impulse1[lane] *= factor;
        friction_[bundle.friction + k].impulse2[lane] *= factor;
      }
    }
}

void ContactLanes::writePoints() {
  workers_.share(places_.size(), kLanes * kBundlesOfAPart, [this](auto, auto begin, auto end) {
    for (std::size_t k = begin; k < end; ++k) writePoints(static_cast<Index>(k));
  });
}

void ContactLanes::writePoints(Index which) {
  const auto [place, lane, room] = places_[which];
  if (place == kNone) return;
  const Bundle& bundle = bundles_[place];
  const SolverBlock& block = contacts_.blocks[which];
  for (int k = 0; k < block.size; ++k) {
    SolverPoint& point = contacts_.points[block.first + k];
    const NormalRow& row = normal_[bundle.normal + k];
    point.mass_n = row.mass[lane];
    point.open = row.open[lane];
    point.l_n = row.impulse[lane];
    const SumRow& sum = sums_[bundle.normal + k];
    point.sum_n = sum.n[lane];
    point.sum_t << sum.t1[lane], sum.t2[lane];
    if (!bundle.has_friction) continue;
    const FrictionRow& friction = friction_[bundle.friction + k];
    point.mass_t << friction.mass11[lane], friction.mass12[lane], friction.mass12[lane],
        friction.mass22[lane];
    point.l_t << friction.impulse1[lane], friction.impulse2[lane];
  }
}

}  // namespace rbs
