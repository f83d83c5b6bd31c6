// SPDX-License-Identifier: BSD-3-Clause
#include "solver/solver_contacts.h"

#include "base/algebra.h"
#include "base/tolerances.h"
#include "solver/residuals.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace rbs {

namespace {

// A pair that has moved by this share of the smaller length since its points were found looks for them anew.
constexpr double kDriftLimit = 0.05;

// From where on a pair rolls, and travels: the turn of one surface against the other in a step, rad, and the way along it, share
// of the smaller length. And the most pairs of an island in which that is followed.
constexpr double kRoll = 1e-9, kTravel = 1e-3;
constexpr std::size_t kFollowedPairs = 30;

bool isCurved(const Traits& t) {
  return t.round || t.revolved;
}

// Blocks that a thread takes at a time.
constexpr std::size_t kBlocksOfAPart = 128;

}  // namespace

SolverContacts::SolverContacts(Context& context, const Subgraph& batch, Stores& stores)
    : bodies(stores.bodies),
      blocks(stores.blocks),
      points(stores.points),
      context_(context),
      batch_(batch),
      slots_(context.step.slot),
      opened_(stores.opened),
      points_of_parts_(stores.points_of_parts),
      last_(stores.last),
      drifted_(stores.drifted),
      has_drifted_(stores.has_drifted) {
  bodies.clear();
  blocks.clear();
  points.clear();
  opened_.clear();
  bodies.reserve(batch.bodies.size() + 8);
  for (const Index i : batch.bodies) addBody(i);
  for (const Edge& edge : batch.edges)
    for (const Index i : edge.bodies)
      if (i != kNone) addBody(i);
}

Vec3 surfaceSpin(const Bodies& bodies, Index i, const Vec3& w_WB) {
  const Traits& traits = bodies.traits[i];
  if (traits.round) return Vec3::Zero();
  const Vec3 axis_W = bodies.axis_W(i);
  return w_WB - axis_W.dot(w_WB) * axis_W;
}

SolverBody SolverContacts::makeBody(Index i) const {
  const Bodies& store = context_.scene.bodies;
  SolverBody s;
  s.v = withoutNegativeZeros(store.twist[i].v_WB);
  s.w = withoutNegativeZeros(store.twist[i].w_WB);
  s.v_free = s.v, s.w_free = s.w;
  s.moved.setZero();
  s.turned.setZero(), s.surface_turned.setZero();
  s.turned_axes_at.setZero();
  s.inv_mass = store.inertia[i].inv_mass;
  s.inv_inertia_W = store.inertia[i].isotropic ? Mat3(store.inertia[i].inv_moments.asDiagonal())
                                               : store.inertia[i].inverseW(store.R_WB(i));
  s.axis_W = store.axis_W(i);
  s.turned_axes = false;
  s.still = s.inv_mass == 0.0 && s.v.isZero(0.0) && s.w.isZero(0.0);
  s.body = i;
  return s;
}

Index SolverContacts::addBody(Index i) {
  if (slots_[i] == kNone) {
    slots_.set(i, static_cast<Index>(bodies.size()));
    bodies.push_back(makeBody(i));
  }
  return slots_[i];
}

// Contacts with what no impulse moves come last. The last contact of a pass keeps what it asks for, and an earlier one
// gives way to it: a body pressed against a wall by others is to stay before it, whatever that costs between the others.
void SolverContacts::find(double now, double left, double h) {
  h_ = h;
  const EffectOverrides& overrides = context_.scene.settings.effects;
  const auto forced = overrides.find(Effect::Friction);
  const bool friction_forced = forced != overrides.end() && forced->second;
  blocks.reserve(batch_.contacts.size());
  const auto add = [this](Index contact, Index i, Index j) {
    SolverBlock& block = blocks.emplace_back();
    block.i = i, block.j = j, block.contact = contact;
  };
  last_.clear();
  for (const Index k : batch_.contacts) {
    const Contact& contact = context_.scene.contacts.active[k];
    if (!contact.state.isForSolver()) continue;
    const Index i = addBody(contact.i), j = addBody(contact.j);
    if (bodies[i].inv_mass > 0.0 && bodies[j].inv_mass > 0.0) {
      add(k, i, j);
    } else {
      last_.push_back(k);
    }
  }
  for (const Index k : last_) {
    const Contact& contact = context_.scene.contacts.active[k];
    add(k, addBody(contact.i), addBody(contact.j));
  }
  Workers& workers = *context_.step.workers;
  const bool alone = workers.count() == 1;
  const std::size_t parts = Workers::parts(blocks.size(), kBlocksOfAPart);
  if (!alone && points_of_parts_.size() < parts) points_of_parts_.resize(parts);
  workers.share(blocks.size(), kBlocksOfAPart, [&](auto part, auto begin, auto end) {
    std::vector<SolverPoint>& to = alone ? points : points_of_parts_[part];
    if (!alone) to.clear();
    for (std::size_t k = begin; k < end; ++k) {
      SolverBlock& block = blocks[k];
      const Contact& contact = context_.scene.contacts.active[block.contact];
      block.pair = pairConstants(context_, contact.i, contact.j);
      block.has_friction = block.pair.mu > 0.0 || friction_forced;
      findPoints(block, now, left, contact.lastNormal(block.pair.bears), to);
      for (int p = block.first; p < block.first + block.size; ++p) warmFromLastStep(block, h, to[p]);
    }
  });
  if (alone) return;
  std::vector<std::size_t> first(parts + 1, 0);
  for (std::size_t part = 0; part < parts; ++part)
    first[part + 1] = first[part] + points_of_parts_[part].size();
  points.resize(first.back());
  workers.share(blocks.size(), kBlocksOfAPart, [&](auto part, auto begin, auto end) {
    for (std::size_t k = begin; k < end; ++k) blocks[k].first += static_cast<int>(first[part]);
    std::copy(points_of_parts_[part].begin(), points_of_parts_[part].end(),
              points.begin() + static_cast<std::ptrdiff_t>(first[part]));
  });
}

// The normal of a block whose points push or overlap.
LastNormal SolverContacts::lastNormal(const SolverBlock& block) const {
  LastNormal last;
  for (int k = block.first; k < block.first + block.size; ++k) {
    last.loaded = last.loaded || points[k].l_n > h_ * block.pair.bears;
    if (last.loaded || points[k].open < 0.0) last.n_W = block.n;
  }
  return last;
}

// Finds where the pair touches now. Without a point within the margin nothing can touch before the pair has
// moved that far. Points that no sub-step can close are good until the pair has come half as near.
void SolverContacts::findPoints(SolverBlock& block, double now, double left, const LastNormal& last,
                                std::vector<SolverPoint>& to) const {
  const Bodies& store = context_.scene.bodies;
  const SolverBody& i = bodies[block.i];
  const SolverBody& j = bodies[block.j];
  const Pose X_i = context_.step.poseAt(store, i.body, now), X_j = context_.step.poseAt(store, j.body, now);
  const Traits &a = store.traits[i.body], &b = store.traits[j.body];
  const Vec3 p_W = X_j.p_WB - X_i.p_WB, u_W = j.v - i.v;
  block.reach_i = reachOf(a, b, p_W, u_W, left);
  block.reach_j = reachOf(b, a, p_W, u_W, left);
  const double length = block.pair.length, room = kMargin * length;
  const Contact& contact = context_.scene.contacts.active[block.contact];
  const Vec3 a_W = context_.step.load[j.body].a_W - context_.step.load[i.body].a_W;
  const double turning_i = block.reach_i * i.w.norm(), turning_j = block.reach_j * j.w.norm();
  const auto approachIn = [&](double time) { return approach(time, u_W, turning_i, turning_j, a_W); };
  const double margin = searchMargin(contact, approachIn(left) + room), in_sub_step = approachIn(h_);
  Manifold manifold =
      contactManifold(store, i.body, {now, X_i, {i.v, i.w}}, j.body, {now, X_j, {j.v, j.w}}, now, now + left,
                      margin, softLimits(context_.step, block.pair, h_), last, contact.axis);
  if (!context_.step.solver.all_points && !contact.state.isMissed()) {
    keepWithin(std::max(in_sub_step + room + kDriftLimit * length, leastSeparation(manifold)), manifold);
    reduceToFour(manifold);
  }
  block.n = manifold.n_W;
  std::tie(block.t1, block.t2) = tangents(block.n);
  const double far = 0.5 * (leastSeparation(manifold) - in_sub_step);
  block.drift_limit = manifold.size > 0 ? std::max(kDriftLimit * length, far) : margin;
  block.moved_i = i.moved, block.turned_i = i.surface_turned;
  block.moved_j = j.moved, block.turned_j = j.surface_turned;
  block.first = static_cast<int>(to.size());
  block.size = manifold.size;
  to.resize(to.size() + block.size);
  for (int k = 0; k < block.size; ++k)
    preparePoint(block, manifold.points[k], X_i.p_WB, X_j.p_WB, to[block.first + k]);
  if (contact.isFresh() && meetsAtEnd(block, left, to)) to.resize(block.first), block.size = 0;
  const auto carries = [](const SolverBody& s) { return s.inv_mass == 0.0 && !s.still && !s.w.isZero(0.0); };
  block.on_arc = carries(i) || carries(j);
  block.on_plane = (a.unbounded || b.unbounded) && block.size > 0;
  if (block.on_arc) followArc(block, now, to);
  block.rolls = rolls(block, left);
  block.travels = travels(block, left);
}

// Whether a pair comes to touch when the step ends, and will rebound: the impact is found at the start of the next step. By a
// contact it would be stopped first. What soft contacts carry comes sooner or later than it was predicted to, by what it sinks in.
bool SolverContacts::meetsAtEnd(const SolverBlock& block, double left,
                                const std::vector<SolverPoint>& of) const {
  if (block.pair.e == 0.0) return false;
  double gap = std::numeric_limits<double>::infinity(), speed = 0.0;
  for (int k = block.first; k < block.first + block.size; ++k) {
    gap = std::min(gap, of[k].gap + left * of[k].u_0);
    speed = std::max(speed, -of[k].u_0);
  }
  return std::abs(gap) < kTouch * block.pair.length + sag(block.pair, h_) &&
         block.pair.e * speed > slowestRebound(context_, block.n);
}

// Where a round surface touches another body, the contact travels over that body as the two turn against each other,
// and takes the torque of its force along. With x what a plank has rocked by on a cylinder, v its rate, and k > 0 of the
// restoring torque, a contact found once in a step of length h with n sub-steps gives
//   v' = v - h k x,   x' = x + h v - (n + 1)/(2n) h² k x,   of determinant 1 + (n - 1)/(2n) k h² > 1:
// it gains energy for ever. Found in each sub-step (n = 1) the map keeps areas, and the energy stays about what it was
// (E. Hairer, C. Lubich and G. Wanner, "Geometric Numerical Integration", 2nd ed. 2006, IX.8). In a pile of many bodies
// nothing rocks freely, and to look so often costs half as much again as the whole step.
//
// Where both are round, the normal turns as one goes along the other, rolling or not. A contact found once a step lets a ball
// go straight on over a dome and leave it, and in the next step it falls back on it.
bool SolverContacts::rolls(const SolverBlock& block, double left) const {
  const Bodies& store = context_.scene.bodies;
  const SolverBody &i = bodies[block.i], &j = bodies[block.j];
  const Traits &a = store.traits[i.body], &b = store.traits[j.body];
  if (!isCurved(a) && !isCurved(b)) return false;
  const Vec3 spin_W = surfaceSpin(store, j.body, j.w) - surfaceSpin(store, i.body, i.w);
  const double turn = isCurved(a) && isCurved(b) ? slipOf(block) / block.pair.length : 0.0;
  return (spin_W.norm() + turn) * left > kRoll && isOfFew(block);
}

// What is round touches another body in one place, and comes to its end within a step. A plane has none.
bool SolverContacts::travels(const SolverBlock& block, double left) const {
  const Traits& a = context_.scene.bodies.traits[bodies[block.i].body];
  const Traits& b = context_.scene.bodies.traits[bodies[block.j].body];
  return (isCurved(a) || isCurved(b)) && !block.on_plane &&
         slipOf(block) * left > kTravel * block.pair.length && isOfFew(block);
}

// Speed of the centres along the contact, m/s.
double SolverContacts::slipOf(const SolverBlock& block) const {
  const Vec3 u_W = bodies[block.j].v - bodies[block.i].v;
  return (u_W - u_W.dot(block.n) * block.n).norm();
}

bool SolverContacts::isOfFew(const SolverBlock& block) const {
  return context_.step.islands[islandOf(block)].contacts.size() <= kFollowedPairs;
}

void SolverContacts::preparePoint(const SolverBlock& block, const ManifoldPoint& found, const Vec3& centre_i,
                                  const Vec3& centre_j, SolverPoint& point) const {
  point.p_W = found.p_W;
  point.r_i = found.p_W - centre_i;
  point.r_j = found.p_W - centre_j;
  point.gap = point.open = found.separation;
  point.feature = found.feature;
  point.u_0 = block.pair.e > 0.0 ? normalVelocityAt(block, point) : 0.0;
}

// A kinematic body that turns carries what touches it along an arc. Its velocity is taken at the point where
// the contact is in the middle of the sub-step: along the chord of the arc, and not along the tangent at its start,
// which leads outwards by (w h)²/2 of the radius. The contact moves with the surface of the other body.
void SolverContacts::followArc(const SolverBlock& block, double now, std::vector<SolverPoint>& of) const {
  const SolverBody &i = bodies[block.i], &j = bodies[block.j];
  const Bodies& store = context_.scene.bodies;
  const bool i_leads = i.inv_mass == 0.0;
  const SolverBody &kinematic = i_leads ? i : j, &other = i_leads ? j : i;
  const Vec3 apart_W = context_.step.poseAt(store, other.body, now).p_WB -
                       context_.step.poseAt(store, kinematic.body, now).p_WB +
                       0.5 * h_ * (other.v - kinematic.v);
  const Vec3 spin_W = surfaceSpin(store, other.body, other.w);
  for (int k = block.first; k < block.first + block.size; ++k) {
    SolverPoint& point = of[k];
    const Vec3& r = i_leads ? point.r_j : point.r_i;
    (i_leads ? point.r_i : point.r_j) = apart_W + r + 0.5 * h_ * spin_W.cross(r);
  }
}

void SolverContacts::followArc(Index block, double now) {
  followArc(blocks[block], now, points);
}

void SolverContacts::warmFromLastStep(const SolverBlock& block, double h, SolverPoint& point) const {
  const SolvedPoint* last = context_.scene.contacts.active[block.contact].pointOf(point.feature);
  if (last == nullptr) return;
  point.warm_n = last->normal;
  point.warm_t_W = last->friction_W;
  point.l_n = last->normal * h;
  if (block.pair.mu > 0.0)
    point.l_t = h * Eigen::Vector2d(block.t1.dot(last->friction_W), block.t2.dot(last->friction_W));
}

void SolverContacts::warmFrom(const SolverBlock& block, const SolverBlock& old_block,
                              SolverPoint& point) const {
  for (int k = old_block.first; k < old_block.first + old_block.size; ++k) {
    const SolverPoint& old = points[k];
    if (old.feature != point.feature) continue;
    const auto turned = [&](const Eigen::Vector2d& t) -> Eigen::Vector2d {
      const Vec3 t_W = inPlane(old_block, t);
      return {block.t1.dot(t_W), block.t2.dot(t_W)};
    };
    point.u_0 = old.u_0;
    point.warm_n = old.warm_n, point.warm_t_W = old.warm_t_W;
    point.l_n = old.l_n, point.l_t = turned(old.l_t);
    point.earlier_n = old.earlier_n + old.sum_n;
    point.earlier_W = old.earlier_W + old.sum_n * old_block.n + inPlane(old_block, old.sum_t);
    break;
  }
}

Vec3 SolverContacts::inPlane(const SolverBlock& block, const Eigen::Vector2d& t) {
  return t.x() * block.t1 + t.y() * block.t2;
}

bool SolverContacts::hasDrifted(const SolverBlock& block) const {
  if (block.rolls || block.travels) return true;
  const SolverBody& i = bodies[block.i];
  const SolverBody& j = bodies[block.j];
  const Vec3 way_W = (j.moved - block.moved_j) - (i.moved - block.moved_i);
  const double way_n = way_W.dot(block.n);
  const double travel = block.on_plane ? way_n * way_n : way_W.squaredNorm();
  const double turn_i = block.reach_i * block.reach_i * (i.surface_turned - block.turned_i).squaredNorm();
  const double turn_j = block.reach_j * block.reach_j * (j.surface_turned - block.turned_j).squaredNorm();
  // (a + b + c)^2 <= 3 (a^2 + b^2 + c^2): most pairs are decided without a root.
  if (3.0 * (travel + turn_i + turn_j) <= block.drift_limit * block.drift_limit) return false;
  return std::sqrt(travel) + std::sqrt(turn_i) + std::sqrt(turn_j) > block.drift_limit;
}

const std::vector<Index>& SolverContacts::drifted() {
  drifted_.clear();
  has_drifted_.resize(blocks.size());
  context_.step.workers->share(blocks.size(), 8 * kBlocksOfAPart, [&](auto, auto begin, auto end) {
    for (std::size_t k = begin; k < end; ++k) has_drifted_[k] = hasDrifted(blocks[k]);
  });
  for (std::size_t k = 0; k < blocks.size(); ++k)
    if (has_drifted_[k]) drifted_.push_back(static_cast<Index>(k));
  return drifted_;
}

void SolverContacts::refresh(Index which, double now, double left) {
  SolverBlock& block = blocks[which];
  const SolverBlock old = block;
  findPoints(block, now, left, lastNormal(old), points);
  for (int k = block.first; k < block.first + block.size; ++k) warmFrom(block, old, points[k]);
  for (int k = old.first; k < old.first + old.size; ++k) {
    const auto again = [&](const SolverPoint& point) { return point.feature == points[k].feature; };
    const auto first = points.begin() + block.first, last = first + block.size;
    if (std::any_of(first, last, again)) continue;
    opened_.emplace_back(old.contact, solvedPoint(old, points[k]));
    block.opened_W += impulseOf(old, points[k]);
  }
}

// The force of a point is its impulse over a whole sub-step. After a shorter one, which an impact has cut
// off, the warm start it began with stands in for the rest: an impulse divided by a sliver of time is no force.
void SolverContacts::store(double h, double h_full, const std::function<void(Index)>& finish) {
  const double rest = std::max(h_full - h, 0.0);
  for (const SolverBody& s : bodies) {
    if (context_.step.island[s.body] == kNone) continue;
    context_.scene.bodies.twist[s.body] = {s.v, s.w};
  }
  std::vector<Contact>& active = context_.scene.contacts.active;
  for (const Index k : batch_.contacts) active[k].beginSolve();
  for (const auto& [k, point] : opened_) active[k].addEarlier(point);
  // Of the blocks of a part: what the islands that they are of must know, in the order of the blocks. At the exact
  // settings the soft step stands in for solves that do not converge.
  using Residuals = std::vector<std::pair<Island*, IslandResiduals>>;
  std::vector<Residuals> parts(Workers::parts(blocks.size(), kBlocksOfAPart));
  context_.step.workers->share(blocks.size(), kBlocksOfAPart, [&](auto part, auto begin, auto end) {
    for (std::size_t k = begin; k < end; ++k) {
      finish(static_cast<Index>(k));
      storeBlock(blocks[k], h, rest);
      Island* const island = &context_.step.islands[islandOf(blocks[k])];
      if (parts[part].empty() || parts[part].back().first != island) {
        IslandResiduals& solved = parts[part].emplace_back(island, IslandResiduals()).second;
        solved.method = "soft_step";
        solved.converged = !context_.step.solver.exact;
      }
      IslandResiduals& solved = parts[part].back().second;
      const BlockResiduals& of_block = blocks[k].residuals;
      solved.signorini = std::max(solved.signorini, of_block.signorini);
      solved.coulomb = std::max(solved.coulomb, of_block.coulomb);
      solved.dissipation = std::max(solved.dissipation, of_block.dissipation);
    }
  });
  for (const Residuals& part : parts)
    for (const auto& [island, solved] : part) residuals::add(island->residuals, solved);
}

Index SolverContacts::islandOf(const SolverBlock& block) const {
  const SolverBody &i = bodies[block.i], &j = bodies[block.j];
  return context_.step.island[i.inv_mass > 0.0 ? i.body : j.body];
}

void SolverContacts::storeBlock(const SolverBlock& block, double h, double rest) const {
  Contact& contact = context_.scene.contacts.active[block.contact];
  contact.exact = false;
  for (int k = block.first; k < block.first + block.size; ++k) {
    const SolverPoint& point = points[k];
    SolvedPoint& solved = contact.points.emplace_back(solvedPoint(block, point));
    solved.normal = (point.l_n + rest * point.warm_n) / (h + rest);
    solved.friction_W =
        withoutNegativeZeros((inPlane(block, point.l_t) + rest * point.warm_t_W) / (h + rest));
  }
}

// A point with its impulses, and without its forces.
SolvedPoint SolverContacts::solvedPoint(const SolverBlock& block, const SolverPoint& point) const {
  SolvedPoint solved;
  solved.feature = point.feature;
  solved.p_W =
      point.p_W + 0.5 * (bodies[block.i].moved - block.moved_i + bodies[block.j].moved - block.moved_j);
  solved.n_W = block.n;
  solved.separation = point.open;
  solved.normal_impulse = point.earlier_n + point.sum_n;
  solved.friction_impulse_W = point.earlier_W - point.earlier_n * block.n + inPlane(block, point.sum_t);
  return solved;
}

}  // namespace rbs
