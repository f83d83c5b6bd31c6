// SPDX-License-Identifier: BSD-3-Clause
// The contact points of the soft step: where the bodies of a batch of islands touch, what resists there, and what
// the last step and the next one know of it.
#pragma once

#include "base/algebra.h"
#include "narrowphase/manifold.h"
#include "solver/contact_preparation.h"
#include "solver/methods.h"

#include <functional>
#include <vector>

namespace rbs {

/// A body as the solver moves it.
/// Its velocities are in one line of the cache, and no other body is: threads work on bodies beside each other.
struct alignas(64) SolverBody {
  Vec3 v, w;            // m/s, rad/s
  Vec3 v_free, w_free;  // after this sub-step's load, before its impulses
  Vec3 moved, turned;   // since the start, m, rad
  Vec3 surface_turned;  // the same of its surface: see surfaceSpin()
  Mat3 inv_inertia_W;
  Vec3 axis_W;          // of a body of revolution, of length 1; zero: it is none
  Vec3 turned_axes_at;  // `turned` for which inv_inertia_W and axis_W hold
  double inv_mass;
  bool turned_axes;  // these two have changed in this sub-step
  bool still;        // nothing moves it: neither impulses nor a motion of its own
  Index body;
};

/// A pair with fewer points than its bundle has rows (contact_lanes.h) gets impulses of +0 or -0 in the others. They change
/// no number but -0, and a sum is -0 only where both of its terms are. So velocities that begin without -0 stay without, and
/// what a pair does depends on no pair beside it.
inline Vec3 withoutNegativeZeros(const Vec3& v) {
  return v + Vec3::Zero();
}

/// The spin of a body as far as it turns its surface: a body of revolution may turn about its axis, and a sphere about
/// any, and it stays where it was.
Vec3 surfaceSpin(const Bodies& bodies, Index i, const Vec3& w_WB);

/// A point where two bodies touch or may touch, with its impulses.
struct SolverPoint {
  SolverPoint() {}         // not "= default": a vector would clear what is about to be filled in
  Vec3 r_i, r_j;           // from the centres, m
  double gap;              // when it was found, m
  double u_0;              // normal velocity of j against i when it was found, m/s; 0 where nothing rebounds
  double mass_n;           // effective, along the normal, kg
  Eigen::Matrix2d mass_t;  // effective, in the contact plane, kg
  double l_n = 0.0;        // impulses of this sub-step, N s
  Eigen::Vector2d l_t{0.0, 0.0};
  double warm_n = 0.0;  // the forces it began with, N
  Vec3 warm_t_W{0.0, 0.0, 0.0};
  double earlier_n = 0.0;         // normal impulses until the points of the contact were found anew
  Vec3 earlier_W{0.0, 0.0, 0.0};  // all of its impulse until then, on j
  double sum_n = 0.0;             // over the sub-steps since
  Eigen::Vector2d sum_t{0.0, 0.0};
  double open;  // gap after the last sub-step, m
  std::uint32_t feature;
  Vec3 p_W;
};

/// How far the points of a contact are from its law, as the residuals of an island have it.
struct BlockResiduals {
  double signorini = 0.0, coulomb = 0.0, dissipation = 0.0;
};

/// The points of a contact.
struct SolverBlock {
  Index i, j;  // in SolverContacts::bodies
  Vec3 n, t1, t2;
  PairConstants pair;
  bool has_friction;             // its friction is solved for
  bool on_arc;                   // one of the two is kinematic, and turns
  double reach_i, reach_j;       // reachOf() its bodies, m
  Index contact;                 // in scene.contacts.active
  int first, size;               // in SolverContacts::points
  bool rolls;                    // a round surface turns on the other, or goes along a round one
  bool travels;                  // a round surface goes along one that has an end
  bool on_plane;                 // one of the two is a plane, the same wherever the other goes along it
  Vec3 opened_W{0.0, 0.0, 0.0};  // impulse of points that have opened since the start, on j, N s
  double drift_limit;            // how far the pair may move until its points are found anew, m
  Vec3 moved_i, moved_j, turned_i, turned_j;  // of the bodies and their surfaces when they were found
  BlockResiduals residuals;                   // after the last sub-step
};

class SolverContacts {
 public:
  /// Their memory, which the next solve takes over.
  struct Stores {
    std::vector<SolverBody> bodies;
    std::vector<SolverBlock> blocks;
    std::vector<SolverPoint> points;
    PointsOfContacts opened;
    std::vector<Index> last;
    std::vector<Index> drifted;
    std::vector<char> has_drifted;
    std::vector<std::vector<SolverPoint>> points_of_parts;  // as threads find them
  };

  SolverContacts(Context& context, const Subgraph& batch, Stores& stores);

  /// Finds the points of all contacts at time `now`, with `left` s to go, and the impulses that the forces of
  /// the last step make of a sub-step of length h.
  void find(double now, double left, double h);
  /// The blocks that have drifted from where their points were found.
  const std::vector<Index>& drifted();
  /// Moves the points of a block on a kinematic body that turns to where they are at time `now`, when a sub-step begins.
  void followArc(Index block, double now);
  /// Finds the points of a block anew.
  void refresh(Index block, double now, double left);
  /// The impulse of a point on j since the start, N s.
  static Vec3 impulseOf(const SolverBlock& block, const SolverPoint& point) {
    return point.earlier_W + point.sum_n * block.n + inPlane(block, point.sum_t);
  }
  /// The moment of a unit of normal impulse on a body at r from its centre, m: none about an axis of revolution.
  static Vec3 normalMoment(const SolverBody& s, const Vec3& r, const Vec3& n_W) {
    return r.cross(n_W) - momentAbout(s.axis_W, r, n_W) * s.axis_W;
  }
  /// Velocity of j against i along the normal at a point, by these moments, m/s.
  double normalVelocityAt(const SolverBlock& block, const SolverPoint& point) const {
    const SolverBody &i = bodies[block.i], &j = bodies[block.j];
    double u_n = 0.0;
    if (!j.still) u_n = block.n.dot(j.v) + j.w.dot(normalMoment(j, point.r_j, block.n));
    if (!i.still) {
      u_n -= block.n.dot(i.v);
      u_n -= i.w.dot(normalMoment(i, point.r_i, block.n));
    }
    return u_n;
  }
  /// Place in `bodies` of a body that a contact or an edge of the batch ties.
  Index slotOf(Index i) const { return slots_[i]; }
  /// Centre of mass as the bodies are now, m.
  const Vec3& position(const SolverBody& s) const { return context_.scene.bodies.pose[s.body].p_WB; }
  /// The island of the dynamic bodies of a block.
  Index islandOf(const SolverBlock& block) const;
  /// Writes the velocities to the bodies, and the points to the contacts, with the residuals of the blocks to their islands. `h` is
  /// the length of a sub-step, `h_full` that of one that nothing cuts short. `finish` is called for each block before its points
  /// are read.
  void store(double h, double h_full, const std::function<void(Index block)>& finish);

  std::vector<SolverBody>& bodies;
  std::vector<SolverBlock>& blocks;
  std::vector<SolverPoint>& points;  ///< also some that no block has any more

 private:
  SolverBody makeBody(Index i) const;
  Index addBody(Index i);
  void findPoints(SolverBlock& block, double now, double left, const LastNormal& last,
                  std::vector<SolverPoint>& to) const;
  LastNormal lastNormal(const SolverBlock& block) const;
  bool meetsAtEnd(const SolverBlock& block, double left, const std::vector<SolverPoint>& of) const;
  bool rolls(const SolverBlock& block, double left) const;
  bool travels(const SolverBlock& block, double left) const;
  double slipOf(const SolverBlock& block) const;
  bool isOfFew(const SolverBlock& block) const;
  void preparePoint(const SolverBlock& block, const ManifoldPoint& found, const Vec3& centre_i,
                    const Vec3& centre_j, SolverPoint& point) const;
  void followArc(const SolverBlock& block, double now, std::vector<SolverPoint>& of) const;
  void warmFromLastStep(const SolverBlock& block, double h, SolverPoint& point) const;
  void warmFrom(const SolverBlock& block, const SolverBlock& old_block, SolverPoint& point) const;
  bool hasDrifted(const SolverBlock& block) const;
  static Vec3 inPlane(const SolverBlock& block, const Eigen::Vector2d& t);
  SolvedPoint solvedPoint(const SolverBlock& block, const SolverPoint& point) const;
  void storeBlock(const SolverBlock& block, double h, double rest) const;

  Context& context_;
  const Subgraph& batch_;
  double h_ = 0.0;            ///< of a sub-step, s
  Slots slots_;               ///< in `bodies`
  PointsOfContacts& opened_;  ///< points that are gone, with what they have given
  std::vector<std::vector<SolverPoint>>& points_of_parts_;
  std::vector<Index>& last_;        ///< contacts with what no impulse moves
  std::vector<Index>& drifted_;     ///< as last found
  std::vector<char>& has_drifted_;  ///< by block
};

}  // namespace rbs
