// SPDX-License-Identifier: BSD-3-Clause
#include "methods/central_path.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rbs::coulomb {

namespace {

using Mat2 = Eigen::Matrix2d;

constexpr double kSolved = 1e-3;  // what a solution of the linear equations may leave of their right side

// --- vectors of the cone |x_T| <= x_n, the axis last
double determinant(const Vec3& x) {
  const double length = x.head<2>().norm();
  return (x[2] - length) * (x[2] + length);
}

Vec3 product(const Vec3& a, const Vec3& b) {
  Vec3 c;
  c << a[2] * b.head<2>() + b[2] * a.head<2>(), a.dot(b);
  return c;
}

/// x of a o x = b.
Vec3 quotient(const Vec3& b, const Vec3& a) {
  Vec3 x;
  x[2] = (a[2] * b[2] - a.head<2>().dot(b.head<2>())) / determinant(a);
  x.head<2>() = (b.head<2>() - x[2] * a.head<2>()) / a[2];
  return x;
}

/// The largest t with x + t d in the cone.
double roomWithin(double x, double d) {
  return d < 0.0 ? -x / d : std::numeric_limits<double>::infinity();
}

double roomWithin(const Vec3& x, const Vec3& d) {
  // det(x + t d) = a t^2 + 2 b t + c; its least positive root.
  const double a = determinant(d), c = std::max(determinant(x), 0.0);
  const double b = x[2] * d[2] - x.head<2>().dot(d.head<2>());
  double t = roomWithin(x[2], d[2]);
  const double root = b * b - a * c;
  if (root < 0.0) return t;
  const double q = -(b + std::copysign(std::sqrt(root), b));
  if (q / a > 0.0) t = std::min(t, q / a);
  if (c / q > 0.0) t = std::min(t, c / q);
  return t;
}

Vec3 change(const Point& point, const Velocities& dy) {
  Vec3 du = Vec3::Zero();
  if (point.i != kNone) du.noalias() += point.J_i * dy.col(point.i);
  if (point.j != kNone) du.noalias() += point.J_j * dy.col(point.j);
  return du;
}

}  // namespace

CentralPath::Place& CentralPath::Place::add(double part, const Place& direction) {
  y += part * direction.y;
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    Pairs& mine = pairs[k];
    const Pairs& other = direction.pairs[k];
    mine.r_n += part * other.r_n;
    mine.u_n += part * other.u_n;
    mine.b += part * other.b;
    mine.h += part * other.h;
  }
  return *this;
}

// All products begin at the same t, in units of the whole island: so the lightest bodies' are the last to
// close, which jams of 1e4 : 1 in masses need. At the same t for their own mass, half of such jams get stuck.
CentralPath::CentralPath(const System& system, BodyBlocks& matrix) : system_(system), matrix_(matrix) {
  const std::size_t size = system.points().size();
  place.y = system.free();
  // The size of the start is that of the velocities of points that close, and of the unit at least. A point
  // that opens faster than that does so at the start too.
  std::vector<Vec3> free;
  double sum = 0.0;
  for (const Point& point : system.points()) {
    free.push_back(system.velocity(point, place.y));
    if (free.back()[2] < 0.0) sum += free.back().squaredNorm();
  }
  const double start = std::max(1.0, std::sqrt(sum / static_cast<double>(size)));
  for (std::size_t k = 0; k < size; ++k) {
    const double u_n = std::max(start, free[k][2]), r_n = start * start / u_n;
    Pairs pairs{r_n, u_n, Vec3::Zero(), Vec3::Zero()};
    count_ += isRound(k) ? 2 : 1;
    if (isRound(k)) {
      pairs.b[2] = system.points()[k].mu * r_n;
      pairs.h[2] = u_n / system.points()[k].mu;
    }
    place.pairs.push_back(pairs);
  }
  scaling_.resize(size);
  D_.resize(size);
  off_.resize(size);
}

Vec3 CentralPath::impulse(std::size_t k) const {
  const Point& point = system_.points()[k];
  const Pairs& pairs = place.pairs[k];
  if (isRound(k)) return {pairs.b[0], pairs.b[1], pairs.r_n};
  const double limit = point.mu * pairs.r_n;
  return {-limit * point.slide[0], -limit * point.slide[1], pairs.r_n};
}

Impulses CentralPath::impulses() const {
  Impulses r(3, place.pairs.size());
  for (std::size_t k = 0; k < place.pairs.size(); ++k) r.col(k) = impulse(k);
  return r;
}

double CentralPath::meanProduct() const {
  double sum = 0.0;
  for (const Pairs& pairs : place.pairs) sum += pairs.r_n * pairs.u_n + pairs.b.dot(pairs.h);
  return sum / count_;
}

void CentralPath::Scaling::set(const Vec3& b, const Vec3& h) {
  const double size_b = std::sqrt(determinant(b)), size_h = std::sqrt(determinant(h));
  const Vec3 mirror(-1.0, -1.0, 1.0);
  const Vec3 unit_b = b / size_b, unit_h = h / size_h;
  const Vec3 w = (unit_b + mirror.cwiseProduct(unit_h)) / std::sqrt(2.0 * (1.0 + unit_b.dot(unit_h)));
  const double ratio = size_b / size_h, root = std::sqrt(ratio);
  W.topLeftCorner<2, 2>() = Mat2::Identity() + w.head<2>() * w.head<2>().transpose() / (1.0 + w[2]);
  W.col(2) = w;
  W.row(2) = w.transpose();
  inverse = mirror.asDiagonal() * W * mirror.asDiagonal();
  W *= root;
  inverse /= root;
  square = ratio * (2.0 * w * w.transpose());
  square.diagonal() -= ratio * mirror;
  l = W * h;
}

bool CentralPath::linearise() {
  away_ = place.y - system_.free();
  for (std::size_t k = 0; k < place.pairs.size(); ++k) {
    const Point& point = system_.points()[k];
    const Pairs& pairs = place.pairs[k];
    System::push(point, -impulse(k), away_);
    off_[k] = Vec3(pairs.h[0], pairs.h[1], pairs.u_n) - system_.velocity(point, place.y);
    Mat3& D = D_[k];
    D.setZero();
    const double dr_n = pairs.r_n / pairs.u_n;
    D(2, 2) = dr_n;
    if (isRound(k)) {
      scaling_[k].set(pairs.b, pairs.h);
      const Mat3& square = scaling_[k].square;
      const Vec2 v = square.topRightCorner<2, 1>();
      D.topLeftCorner<2, 2>() = square.topLeftCorner<2, 2>() - v * v.transpose() / square(2, 2);
      D.topRightCorner<2, 1>() = point.mu * dr_n / square(2, 2) * v;
    } else {
      off_[k].head<2>().setZero();
      D.topRightCorner<2, 1>() = -point.mu * dr_n * point.slide;
    }
  }
  if (first_off_.empty()) first_off_ = off_, first_away_ = away_;
  return matrix_.factor(D_);
}

double CentralPath::distance(double t, double share) const {
  double worst = 0.0;
  for (std::size_t k = 0; k < place.pairs.size(); ++k) {
    const Pairs& pairs = place.pairs[k];
    worst = std::max(worst, std::abs(pairs.r_n * pairs.u_n / t - 1.0));
    worst = std::max(worst, (off_[k] - share * first_off_[k]).norm());
    if (!isRound(k)) continue;
    const Vec3& l = scaling_[k].l;
    worst = std::max(worst, (product(l, l) / t - Vec3::UnitZ()).norm());
  }
  return worst;
}

bool CentralPath::step(double t, double share, const Place* earlier, Place& direction) const {
  std::vector<Wanted> wanted(place.pairs.size());
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    const Pairs& pairs = place.pairs[k];
    const Scaling& scaling = scaling_[k];
    wanted[k] = {t - pairs.r_n * pairs.u_n, Vec3::Zero(), share * first_off_[k] - off_[k]};
    if (isRound(k)) wanted[k].products = t * Vec3::UnitZ() - product(scaling.l, scaling.l);
    if (!earlier) continue;
    const Pairs& d = earlier->pairs[k];
    wanted[k].product -= d.r_n * d.u_n;
    if (isRound(k)) wanted[k].products -= product(scaling.inverse * d.b, scaling.W * d.h);
  }
  return solve(wanted, share * first_away_ - away_, direction);
}

bool CentralPath::tangent(double t, double share, Place& direction) const {
  std::vector<Wanted> wanted(place.pairs.size());
  for (std::size_t k = 0; k < wanted.size(); ++k) wanted[k] = {t, t * Vec3::UnitZ(), share * first_off_[k]};
  return solve(wanted, share * first_away_, direction);
}

bool CentralPath::solve(const std::vector<Wanted>& wanted, Velocities right, Place& direction) const {
  std::vector<Vec3> q(wanted.size());
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    const Point& point = system_.points()[k];
    const double e_n = wanted[k].product / place.pairs[k].u_n;
    Vec3 e(0.0, 0.0, e_n);
    if (isRound(k)) {
      const Scaling& s = scaling_[k];
      q[k] = s.W * quotient(wanted[k].products, s.l);
      e.head<2>() =
          q[k].head<2>() - s.square.topRightCorner<2, 1>() / s.square(2, 2) * (q[k][2] - point.mu * e_n);
    } else {
      e.head<2>() = -point.mu * e_n * point.slide;
    }
    System::push(point, e - D_[k] * wanted[k].off, right);
  }
  direction.y = matrix_.solve(right);
  // One refinement, which also tells what the factors are worth.
  direction.y += matrix_.solve(residual(right, direction.y));
  if (!(residual(right, direction.y).norm() <= kSolved * right.norm())) return false;

  direction.pairs.resize(wanted.size());
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    const Point& point = system_.points()[k];
    const Vec3 du = change(point, direction.y) + wanted[k].off;
    Pairs& d = direction.pairs[k];
    d.u_n = du[2];
    d.r_n = (wanted[k].product - place.pairs[k].r_n * d.u_n) / place.pairs[k].u_n;
    d.b.setZero();
    d.h.setZero();
    if (!isRound(k)) continue;
    const Mat3& square = scaling_[k].square;
    const Vec2 v = square.topRightCorner<2, 1>(), du_T = du.head<2>();
    d.b[2] = point.mu * d.r_n;
    d.h << du_T, (q[k][2] - v.dot(du_T) - d.b[2]) / square(2, 2);
    d.b.head<2>() = q[k].head<2>() - v * d.h[2] - square.topLeftCorner<2, 2>() * du_T;
  }
  return true;
}

/// right - (1 + J^T D J) dy.
Velocities CentralPath::residual(const Velocities& right, const Velocities& dy) const {
  Velocities rest = right - dy;
  for (std::size_t k = 0; k < D_.size(); ++k) {
    const Point& point = system_.points()[k];
    System::push(point, -D_[k] * change(point, dy), rest);
  }
  return rest;
}

double CentralPath::room(const Place& direction) const {
  double t = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < place.pairs.size(); ++k) {
    const Pairs &pairs = place.pairs[k], &d = direction.pairs[k];
    t = std::min(t, std::min(roomWithin(pairs.r_n, d.r_n), roomWithin(pairs.u_n, d.u_n)));
    if (isRound(k)) t = std::min(t, std::min(roomWithin(pairs.b, d.b), roomWithin(pairs.h, d.h)));
  }
  return t;
}

Eigen::VectorXd CentralPath::relative(const Place& direction) const {
  Eigen::VectorXd fractions = Eigen::VectorXd::Zero(8 * static_cast<Eigen::Index>(place.pairs.size()));
  for (std::size_t k = 0; k < place.pairs.size(); ++k) {
    const Pairs &pairs = place.pairs[k], &d = direction.pairs[k];
    fractions.segment<2>(8 * k) << d.r_n / pairs.r_n, d.u_n / pairs.u_n;
    if (isRound(k)) fractions.segment<6>(8 * k + 2) << d.b / pairs.b[2], d.h / pairs.h[2];
  }
  return fractions;
}

}  // namespace rbs::coulomb
