// SPDX-License-Identifier: BSD-3-Clause
// Where an island touches at one instant: its contact points as the exact step sees them.
#pragma once

#include "coulomb/coulomb_problem.h"
#include "solver/methods.h"

#include <vector>

namespace rbs {

/// A point where a pair touches or may touch within a step.
struct TouchingPoint {
  Index contact;          ///< in scene.contacts.active
  std::uint32_t feature;  ///< the same for the same corners and edges of the pair
  double gap;             ///< m; negative is overlap
  double length;          ///< the smaller one of the pair, m
  double push;            ///< speed at which overlap may be taken away, m/s
  /// Closing speed from which on the pair will rebound, m/s: it has restitution and has not touched yet. Else infinite.
  double rebounds_from;
  Vec3 p_W;
  Vec3 force_W{0.0, 0.0, 0.0};    ///< on j, N: what is expected of it next
  Vec3 impulse_W{0.0, 0.0, 0.0};  ///< on j, N s: what it has done so far
};

/// What a pair that touches resists turning with.
struct TouchingTorque {
  Index contact;         ///< in scene.contacts.active
  TorqueConstraint law;  ///< without impulse, and driven by kinematic sides alone
  Vec3 force_W{0.0, 0.0,
               0.0};  ///< the torque over the length of the constraint, on j, N: what is expected of it next
};

/// A point with its normal and its impulse, and without its force.
SolvedPoint solvedPoint(const TouchingPoint& point, const Vec3& n_W);
/// The same of a point that is not there any more. Its separation is at least 0: what was taken back from the end of a segment may have
/// been behind the other body along a normal of later, and never overlapped. Where the two do overlap, the points that are there tell it.
SolvedPoint openedPoint(const TouchingPoint& point, const Vec3& n_W);

struct TouchingPoints {
  std::vector<TouchingPoint> points;  ///< by contact
  std::vector<CoulombPoint>
      law;  ///< of the same points, without impulse, and driven by kinematic sides alone
  std::vector<TouchingTorque> torques;  ///< by contact

  /// The point of the same contact and feature as this one of another instant; kNone when there is none.
  Index matching(const TouchingPoint& other) const;
  bool has(Index contact) const { return firstOf(contact) != points.size(); }  ///< a point of it
  std::size_t firstOf(Index contact) const;  ///< its first point; points.size() when it has none
  /// The torque constraint of the same contact; kNone when there is none.
  Index matching(const TouchingTorque& other) const;
  /// Adds a point, after those of its contact.
  void add(const TouchingPoint& point, const CoulombPoint& its_law);
  /// These points but for some, which are given in rising order.
  TouchingPoints without(const std::vector<Index>& left_out) const;
  /// Takes over forces and impulses of another instant. Points of that which are not here any more join the
  /// opened ones.
  void inherit(const TouchingPoints& other, PointsOfContacts& opened);
};

/// The normals along which contacts have just borne a force: those of points and the impulses that a kick
/// found for them.
struct LastNormals {
  const TouchingPoints* touching = nullptr;        ///< null: nothing has been solved yet in this step
  const std::vector<CoulombPoint>* law = nullptr;  ///< of these points, with impulses
  double seconds = 0.0;                            ///< in which the impulses were given

  /// Of a contact; where it is not among the points, of the last step. Forces count that are larger than `least`, N.
  LastNormal of(Index k, const Contact& contact, double least) const;
};

/// Finds the points of an island's contacts at a time to which its bodies have been advanced. Points are kept
/// when they can close within a span, s, at `reach` times the speeds that they have now. `slots` are
/// the places of bodies in the Coulomb problem; those that forces do not move have none.
TouchingPoints findTouching(const Context& context, const std::vector<Index>& active, const Slots& slots,
                            double time, double span, double reach, const LastNormals& last);

/// Takes the forces of the last step for what is expected.
void expectLastForces(const Contacts& contacts, TouchingPoints& touching);

/// Leaves the points and their forces in these contacts, and the impulses of points that have opened.
void storeTouching(const TouchingPoints& touching, const PointsOfContacts& opened,
                   const std::vector<Index>& active, Contacts& contacts);

}  // namespace rbs
