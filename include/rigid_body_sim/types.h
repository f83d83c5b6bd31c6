// SPDX-License-Identifier: BSD-3-Clause
// Vectors, poses, handles and errors: the types that every other header uses.
//
// Units are SI (m, kg, s, rad) and numbers are double. Names carry frames: p_WB is the position of
// body frame B in world frame W, R_WB or q_WB rotates vectors from B to W, v_WB and w_WB are the
// linear and angular velocity of B seen from W and written in W. W is right-handed with z up
// (REP-103). A body's frame B sits at its centre of mass, along its principal axes of inertia.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

/// Rigid-body dynamics: worlds, shapes, contact solvers, scene files and queries. Nothing in it needs ROS.
///
/// Units are SI (m, kg, s, rad). Names carry frames. p_WB is the position of body frame B in world frame W.
/// q_WB and R_WB rotate vectors from B to W. v_WB and w_WB are the linear and angular velocity of B relative
/// to W, expressed in W. W is right-handed with z up (REP-103). A body's frame B has its origin at the centre
/// of mass and its axes along the principal axes of inertia.
namespace rbs {

/// A vector. The suffix of a variable names the frame that it is expressed in.
using Vec3 = Eigen::Vector3d;
/// A 3 x 3 matrix, such as the rotation matrix R_WB.
using Mat3 = Eigen::Matrix3d;
/// A quaternion. It is unaligned, so that public structs keep one layout whatever the compiler flags.
using Quat = Eigen::Quaternion<double, Eigen::DontAlign>;

/// Position and orientation of a body frame B in the world frame W.
struct Pose {
  Vec3 p_WB = Vec3::Zero();      ///< position of the origin of B in W, m
  Quat q_WB = Quat::Identity();  ///< unit quaternion that rotates vectors from B to W
};

/// Velocity of a body frame B relative to W, expressed in W, at the origin of B.
struct Twist {
  Vec3 v_WB = Vec3::Zero();  ///< linear velocity, m/s
  Vec3 w_WB = Vec3::Zero();  ///< angular velocity, rad/s
};

/// Axis-aligned bounding box: all x with lo <= x <= hi. Its user chooses the frame.
struct Aabb {
  Vec3 lo,  ///< smallest coordinate along each axis, m; not initialised
      hi;   ///< largest coordinate along each axis, m; not initialised

  /// Whether the two boxes share a point. Boxes that only touch do.
  bool overlaps(const Aabb& o) const {
    return (lo.array() <= o.hi.array()).all() && (o.lo.array() <= hi.array()).all();
  }
  /// Whether every point of `o` is in this box, which includes its surface.
  bool contains(const Aabb& o) const {
    return (lo.array() <= o.lo.array()).all() && (o.hi.array() <= hi.array()).all();
  }
};

/// Handle of a body. A world never uses a number again, so it recognises the handle of a removed body. The
/// order of the numbers is the order of creation, which is the canonical order of bodies. A new world, also
/// one of Simulator::load() or Simulator::reset(), counts from 1 again.
struct BodyId {
  std::uint64_t serial = 0;  ///< creation number in the world, from 1; 0 names no body
  /// Whether the handle names a body. It stays true when that body is removed.
  explicit operator bool() const { return serial != 0; }
  /// Whether both name the same body of one world.
  friend bool operator==(BodyId a, BodyId b) { return a.serial == b.serial; }
  /// Whether they name different bodies of one world.
  friend bool operator!=(BodyId a, BodyId b) { return a.serial != b.serial; }
  /// Whether a was created before b: the canonical order.
  friend bool operator<(BodyId a, BodyId b) { return a.serial < b.serial; }
};

/// One thing wrong with an input.
struct Problem {
  std::string path;     ///< where: "bodies[3].material.friction", or "scene.yaml:12: bodies[3].mass"
  std::string value;    ///< what was found there; may be empty
  std::string allowed;  ///< what is allowed instead
};

/// Thrown for bad input, before anything is changed. It holds every problem that was found.
class InvalidInput : public std::invalid_argument {
 public:
  /// Paths and values are cut at 512 bytes, and control characters and invalid UTF-8 in them are escaped.
  /// what() has one line per problem for the first 20, then the number of the others.
  explicit InvalidInput(std::vector<Problem> problems);
  /// All problems, in the order in which they were found.
  const std::vector<Problem>& problems() const { return problems_; }

 private:
  InvalidInput(std::vector<Problem> problems, int);

  std::vector<Problem> problems_;
};

}  // namespace rbs
