// SPDX-License-Identifier: BSD-3-Clause
// Vectors, poses, handles and errors: the words that every other header uses.
//
// Units are SI (m, kg, s, rad) and numbers are double. Names carry frames: p_WB is the position of
// body frame B in world frame W, R_WB or q_WB turns vectors of B into W, v_WB and w_WB are the
// linear and angular velocity of B seen from W and written in W. W is right-handed with z up
// (REP-103). A body's frame B sits at its centre of mass, along its principal axes of inertia.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

namespace rbs {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
/// Unaligned, so that public structs keep one layout whatever the compiler flags.
using Quat = Eigen::Quaternion<double, Eigen::DontAlign>;

/// Place and attitude of a body frame B in the world frame W.
struct Pose {
  Vec3 p_WB = Vec3::Zero();      ///< m
  Quat q_WB = Quat::Identity();  ///< unit quaternion
};

/// Velocity of a body frame B seen from W, written in W, at the origin of B.
struct Twist {
  Vec3 v_WB = Vec3::Zero();  ///< m/s
  Vec3 w_WB = Vec3::Zero();  ///< rad/s
};

/// Axis-aligned bounds: all x with lo <= x <= hi.
struct Aabb {
  Vec3 lo, hi;
  bool overlaps(const Aabb& o) const {
    return (lo.array() <= o.hi.array()).all() && (o.lo.array() <= hi.array()).all();
  }
  bool contains(const Aabb& o) const {
    return (lo.array() <= o.lo.array()).all() && (o.hi.array() <= hi.array()).all();
  }
};

/// Names a body for as long as it lives. Creation numbers grow and are never used again, so a stale
/// handle is recognised, and their order is the canonical order of bodies. 0 names no body.
struct BodyId {
  std::uint64_t serial = 0;
  explicit operator bool() const { return serial != 0; }
  friend bool operator==(BodyId a, BodyId b) { return a.serial == b.serial; }
  friend bool operator!=(BodyId a, BodyId b) { return a.serial != b.serial; }
  friend bool operator<(BodyId a, BodyId b) { return a.serial < b.serial; }
};

/// One thing wrong with an input.
struct Problem {
  std::string path;     ///< where: "bodies[3].material.friction", or "scene.yaml:12: bodies[3].mass"
  std::string value;    ///< what was found there; may be empty
  std::string allowed;  ///< what is allowed instead
};

/// Thrown for bad input, with every problem found, before anything is changed. Long paths and values are cut,
/// and what is no printable UTF-8 in them is escaped.
class InvalidInput : public std::invalid_argument {
 public:
  explicit InvalidInput(std::vector<Problem> problems);
  const std::vector<Problem>& problems() const { return problems_; }

 private:
  InvalidInput(std::vector<Problem> problems, int);

  std::vector<Problem> problems_;
};

}  // namespace rbs
