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
  auto& [places, bundles, normal, friction, regions, level_of_body, level, key, first, ordered, before,
         last_of_body] = stores_;
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
  normal.clear();
  friction.clear();
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
  }
  Bundle& last = bundles_.back();
  const auto lane = std::find(last.block.begin(), last.block.end(), kNone);
  *lane = which;
  places_[which] = {static_cast<Index>(bundle), static_cast<int>(lane - last.block.begin()), block.size};
  last.size = std::max(last.size, block.size);
  normal_.resize(last.normal + static_cast<std::size_t>(last.size));
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
  findRows(bundles_[bundle], {true, true, true, true});
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
    set(bundle.n, lane, block.n);
    set(bundle.t1, lane, block.t1);
    set(bundle.t2, lane, block.t2);
    set(bundle.turned_i, lane, block.turned_i);
    set(bundle.turned_j, lane, block.turned_j);
    bundle.shift[lane] = block.n.dot(block.moved_j - block.moved_i);
    bundle.mu[lane] = block.pair.mu;
    bundle.push[lane] = block.pair.push;
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
      if (!bundle.has_friction) continue;
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
    if (!bundle.has_friction) continue;
    FrictionRow& friction = friction_[bundle.friction + k];
    friction.impulse1[lane] = friction.impulse2[lane] = friction.sum1[lane] = friction.sum2[lane] = 0.0;
  }
}

void ContactLanes::refresh(double now, double left) {
  const auto takeAgain = [this](Place place) {
    takeBlock(place);
    std::array<bool, kLanes> changed{};
    changed[place.lane] = true;
    findRows(bundles_[place.bundle], changed);
  };
  for (Index k = 0; k < contacts_.blocks.size(); ++k) {
    if (!contacts_.blocks[k].on_arc || places_[k].bundle == kNone) continue;
    giveBackBlock(k);
    contacts_.followArc(k, now);
    takeAgain(places_[k]);
  }
  const std::size_t known = bundles_.size();
  for (const Index k : contacts_.drifted()) {
    giveBackBlock(k);
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

// The rows of a bundle from the places of its points, with the masses of these lanes: those of others stay as they are.
RBS_WIDE void ContactLanes::findRows(const Bundle& bundle, const std::array<bool, kLanes>& found) {
  const auto setLever = [](Turning& turning, const Lanes* d, const NormalRow& row) {
    cross(d, row.arm_i, turning.jacobian);
    cross(row.arm_j, d, turning.jacobian + 3);
  };
  for (int k = 0; k < bundle.size; ++k) {
    NormalRow& row = normal_[bundle.normal + k];
    setLever(row.turning, bundle.n, row);
    if (!bundle.has_friction) continue;
    setLever(friction_[bundle.friction + k].turning1, bundle.t1, row);
    setLever(friction_[bundle.friction + k].turning2, bundle.t2, row);
  }
  findTurns(bundle);
  findMasses(bundle, found);
}

// The normal of a surface of revolution goes through its axis. So a normal impulse has no moment about that axis, though the
// place of a point may be one of a while ago, or one of a few that stand for a rim.
RBS_WIDE void ContactLanes::leaveAxesOut(const Bundle& bundle) {
  Lanes axis_i[3], axis_j[3];
  gather(bundle.i, &SolverBody::axis_W, axis_i);
  gather(bundle.j, &SolverBody::axis_W, axis_j);
  const auto leaveOut = [](const Lanes* axis, Lanes* jacobian) {
    Lanes along;
    dot(axis, jacobian, along);
    for (int c = 0; c < 3; ++c) jacobian[c] -= along * axis[c];
  };
  for (int k = 0; k < bundle.size; ++k) {
    NormalRow& row = normal_[bundle.normal + k];
    cross(bundle.n, row.arm_i, row.turning.jacobian);
    cross(row.arm_j, bundle.n, row.turning.jacobian + 3);
    leaveOut(axis_i, row.turning.jacobian);
    leaveOut(axis_j, row.turning.jacobian + 3);
  }
}

// How the bodies of a bundle turn as they lie now.
RBS_WIDE void ContactLanes::findTurns(const Bundle& bundle) {
  const auto hasAxis = [](const SolverBody* body) { return !body->axis_W.isZero(0.0); };
  if (std::any_of(bundle.i.begin(), bundle.i.end(), hasAxis) ||
      std::any_of(bundle.j.begin(), bundle.j.end(), hasAxis))
    leaveAxesOut(bundle);
  Lanes inv_i[9], inv_j[9];
  for (int c = 0; c < 9; ++c) {
    const auto of = [c](const SolverBody* body) { return body->inv_inertia_W.data()[c]; };
    inv_i[c] = Lanes{of(bundle.i[0]), of(bundle.i[1]), of(bundle.i[2]), of(bundle.i[3])};
    inv_j[c] = Lanes{of(bundle.j[0]), of(bundle.j[1]), of(bundle.j[2]), of(bundle.j[3])};
  }
  const auto setTurn = [&](Turning& turning) {  // the matrices are symmetric
    for (int c = 0; c < 3; ++c) {
      dot(inv_i + 3 * c, turning.jacobian, turning.inv_inertia_jacobian[c]);
      dot(inv_j + 3 * c, turning.jacobian + 3, turning.inv_inertia_jacobian[3 + c]);
    }
  };
  for (int k = 0; k < bundle.size; ++k) {
    setTurn(normal_[bundle.normal + k].turning);
    if (!bundle.has_friction) continue;
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
    add6(inv_mass, row.turning.jacobian, row.turning.inv_inertia_jacobian, response);
    Lanes present;
    for (int lane = 0; lane < kLanes; ++lane)
      present[lane] =
          bundle.block[lane] != kNone && k < contacts_.blocks[bundle.block[lane]].size ? 1.0 : 0.0;
    const auto set = [&](Lanes& to, const Lanes& mass) {
      to = fresh != 0.0 ? (present != 0.0 ? mass : present) : to;
    };
    set(row.mass, 1.0 / response);
    if (!bundle.has_friction) continue;
    FrictionRow& friction = friction_[bundle.friction + k];
    Lanes s11, s12, s22;
    add6(inv_mass, friction.turning1.jacobian, friction.turning1.inv_inertia_jacobian, s11);
    add6(Lanes{}, friction.turning1.jacobian, friction.turning2.inv_inertia_jacobian, s12);
    add6(inv_mass, friction.turning2.jacobian, friction.turning2.inv_inertia_jacobian, s22);
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

void ContactLanes::giveBack() {
  workers_.share(places_.size(), kLanes * kBundlesOfAPart, [this](auto, auto begin, auto end) {
    for (std::size_t k = begin; k < end; ++k) giveBackBlock(static_cast<Index>(k));
  });
}

void ContactLanes::giveBackBlock(Index which) {
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
    point.sum_n = row.sum[lane];
    if (!bundle.has_friction) continue;
    const FrictionRow& friction = friction_[bundle.friction + k];
    point.mass_t << friction.mass11[lane], friction.mass12[lane], friction.mass12[lane],
        friction.mass22[lane];
    point.l_t << friction.impulse1[lane], friction.impulse2[lane];
    point.sum_t << friction.sum1[lane], friction.sum2[lane];
  }
}

}  // namespace rbs
