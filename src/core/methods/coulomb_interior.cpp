// Interior point method with Nesterov and Todd's scaling and Mehrotra's predictor and corrector.
//
// Coulomb's law of a point in two complementary pairs of vectors in cones, with x o z their Jordan product in
// the cone (Alizadeh and Goldfarb 2003; the pairs as in Howell et al., "Dojo", 2022):
//   r_n >= 0,  u_n >= 0,                                 r_n u_n = 0
//   b = (r_T, mu r_n),  h = (u_T, a),  |.| <= last,      b o h = 0.
// The free speed a has no place in the dynamics; the second product makes |u_T| <= a and has friction oppose
// sliding at its limit. De Saxce's shift is eliminated with it: what couples the pairs is that mu r_n is both
// the limit of friction and the first impulse, and that stays within Newton's matrix below. Where mu = 0, or
// where the point slides in a given direction, there is the first pair only.
//
// Newton's method goes after products of t instead of 0, t falling towards 0. With the scaling W of Nesterov
// and Todd (1997; the formulas are those of Andersen, Dahl and Vandenberghe 2003), W h = W^-1 b = l,
//   db = q - W^2 dh,         q = W (l \ (t e - l o l - correction))
//   dr_n = (c - r_n du_n)/u_n,   c = t - r_n u_n - correction.
// With W^2 in blocks A (tangential), v (tangential and last), g (last), db_n = mu dr_n gives da, and
//   dr_T = q_T - v/g (q_n - mu dr_n) - (A - v v^T/g) du_T,
// so that dr = e - D du at each point, D having the column of dr_n/du_n also in its tangential rows: it is
// not symmetric. The velocities follow from y = y_free + J^T r:
//   (1 + J^T D J) dy = J^T (e + D (u - J y - drive)) - (y - y_free - J^T r).
//
// All products begin at the same t, in units of the whole island: so the lightest bodies' are the last to
// close, which 1e4 : 1 in masses needs; at the same t for their own mass, half of such islands get stuck. The
// path of the products may turn back at some t > 0, since the problem is not monotone; there steps shrink to
// nothing, and what was reached is for others to go on from. D grows without bound where a product goes to 0,
// and the factors lose their digits with it: the last digits are for `newton`.
#include "methods/coulomb_solvers.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rbs::coulomb {

namespace {

using Mat2 = Eigen::Matrix2d;

constexpr double kMostOfStep = 0.99;  // to the boundary
constexpr double kLeastCentring = 1e-8;
constexpr double kShortStep = 0.05;
constexpr int kShortSteps = 6;    // in a row, until it is stuck
constexpr double kSolved = 1e-3;  // what a solution of the linear equations may leave

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
double stepWithin(double x, double d) {
  return d < 0.0 ? -x / d : std::numeric_limits<double>::infinity();
}

double stepWithin(const Vec3& x, const Vec3& d) {
  // det(x + t d) = a t^2 + 2 b t + c; its least positive root.
  const double a = determinant(d), c = std::max(determinant(x), 0.0);
  const double b = x[2] * d[2] - x.head<2>().dot(d.head<2>());
  double t = stepWithin(x[2], d[2]);
  const double root = b * b - a * c;
  if (root < 0.0) return t;
  const double q = -(b + std::copysign(std::sqrt(root), b));
  if (q / a > 0.0) t = std::min(t, q / a);
  if (c / q > 0.0) t = std::min(t, c / q);
  return t;
}

/// W of Nesterov and Todd, with W h = W^-1 b.
struct Scaling {
  Mat3 W, inverse, square;
  Vec3 l;

  void set(const Vec3& b, const Vec3& h) {
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
};

/// A point and its pairs.
struct Pairs {
  bool round;  // friction is on the cone: both pairs
  Vec3 along;  // the impulse of r_n = 1 where there is only the first
  double r_n, u_n;
  Vec3 b, h;
  Scaling scaling;
  Vec3 off;  // u - J y - drive
  Vec3 q;
  double c;
  double dr_n, du_n;  // the step
  Vec3 db, dh;

  Vec3 impulse() const { return round ? Vec3(b[0], b[1], r_n) : Vec3(r_n * along); }
  Vec3 velocity() const { return round ? Vec3(h[0], h[1], u_n) : Vec3(0.0, 0.0, u_n); }
  double products() const { return r_n * u_n + (round ? b.dot(h) : 0.0); }
  double productsAt(double step) const {
    return (r_n + step * dr_n) * (u_n + step * du_n) + (round ? (b + step * db).dot(h + step * dh) : 0.0);
  }
  double longestStep() const {
    const double t = std::min(stepWithin(r_n, dr_n), stepWithin(u_n, du_n));
    return round ? std::min(t, std::min(stepWithin(b, db), stepWithin(h, dh))) : t;
  }
  void move(double step, double mu) {
    r_n += step * dr_n;
    u_n += step * du_n;
    if (!round) return;
    b += step * db;
    b[2] = mu * r_n;
    h += step * dh;
  }
};

class InteriorPoint {
 public:
  InteriorPoint(const System& system, BodyBlocks& matrix)
      : system_(system),
        matrix_(matrix),
        y_(system.free()),
        pairs_(system.points().size()),
        D_(pairs_.size()) {
    // The size of the start is that of the velocities, and of the unit at least.
    double sum = 0.0;
    for (const Point& point : system.points()) sum += system.velocity(point, y_).squaredNorm();
    const double size = std::max(1.0, std::sqrt(sum / static_cast<double>(pairs_.size())));
    for (std::size_t k = 0; k < pairs_.size(); ++k) {
      const Point& point = system.points()[k];
      Pairs& pairs = pairs_[k];
      pairs.round = point.mu > 0.0 && !point.slides;
      pairs.along << -point.mu * point.slide, 1.0;
      pairs.r_n = pairs.u_n = size;
      pairs.b << 0.0, 0.0, point.mu * size;
      pairs.h << 0.0, 0.0, size / point.mu;
      count_ += pairs.round ? 2 : 1;
    }
  }

  Impulses impulses() const {
    Impulses r(3, pairs_.size());
    for (std::size_t k = 0; k < pairs_.size(); ++k) r.col(k) = pairs_[k].impulse();
    return r;
  }

  /// One predictor and corrector. False where it does not get anywhere.
  bool advance() {
    linearise();
    if (!matrix_.factor(D_)) return false;
    double products = 0.0;
    for (const Pairs& pairs : pairs_) products += pairs.products();
    Velocities dy;
    if (!solve(0.0, false, dy)) return false;
    const double affine = std::min(1.0, longestStep());
    const double left = 1.0 - affine;
    if (!solve(std::max(left * left * left, kLeastCentring) * products / count_, true, dy)) return false;
    const double step = std::min(1.0, kMostOfStep * longestStep());
    short_steps_ = step < kShortStep ? short_steps_ + 1 : 0;
    if (short_steps_ == kShortSteps || !std::isfinite(step)) return false;
    y_ += step * dy;
    for (std::size_t k = 0; k < pairs_.size(); ++k) pairs_[k].move(step, system_.points()[k].mu);
    return true;
  }

 private:
  void linearise() {
    away_ = y_ - system_.free();
    for (std::size_t k = 0; k < pairs_.size(); ++k) {
      const Point& point = system_.points()[k];
      Pairs& pairs = pairs_[k];
      System::push(point, -pairs.impulse(), away_);
      pairs.off = pairs.velocity() - system_.velocity(point, y_);
      if (!pairs.round) pairs.off.head<2>().setZero();
      Mat3& D = D_[k];
      D.setZero();
      const double dr_n = pairs.r_n / pairs.u_n;
      if (pairs.round) {
        pairs.scaling.set(pairs.b, pairs.h);
        const Mat3& square = pairs.scaling.square;
        const Vec2 v = square.topRightCorner<2, 1>();
        D.topLeftCorner<2, 2>() = square.topLeftCorner<2, 2>() - v * v.transpose() / square(2, 2);
        D.col(2) << point.mu * dr_n / square(2, 2) * v, dr_n;
      } else {
        D.col(2) = dr_n * pairs.along;
      }
    }
  }

  /// The step towards products of t; with Mehrotra's correction by the step found before.
  bool solve(double t, bool correct, Velocities& dy) {
    Velocities right = -away_;
    for (std::size_t k = 0; k < pairs_.size(); ++k) {
      const Point& point = system_.points()[k];
      Pairs& pairs = pairs_[k];
      pairs.c = t - pairs.r_n * pairs.u_n - (correct ? pairs.dr_n * pairs.du_n : 0.0);
      Vec3 e = pairs.c / pairs.u_n * pairs.along;
      if (pairs.round) {
        const Scaling& s = pairs.scaling;
        Vec3 wanted = Vec3(0.0, 0.0, t) - product(s.l, s.l);
        if (correct) wanted -= product(s.inverse * pairs.db, s.W * pairs.dh);
        pairs.q = s.W * quotient(wanted, s.l);
        e.head<2>() = pairs.q.head<2>() -
                      s.square.topRightCorner<2, 1>() / s.square(2, 2) * (pairs.q[2] - point.mu * e[2]);
      }
      System::push(point, e + D_[k] * pairs.off, right);
    }
    dy = matrix_.solve(right);
    // One refinement, which also tells what the factors are worth.
    dy += matrix_.solve(left(right, dy));
    if (!(left(right, dy).norm() <= kSolved * right.norm())) return false;
    for (std::size_t k = 0; k < pairs_.size(); ++k) {
      const Point& point = system_.points()[k];
      Pairs& pairs = pairs_[k];
      const Vec3 du = change(point, dy) - pairs.off;
      pairs.du_n = du[2];
      pairs.dr_n = (pairs.c - pairs.r_n * pairs.du_n) / pairs.u_n;
      if (!pairs.round) continue;
      const Mat3& square = pairs.scaling.square;
      const Vec2 v = square.topRightCorner<2, 1>(), du_T = du.head<2>();
      pairs.db[2] = point.mu * pairs.dr_n;
      pairs.dh << du_T, (pairs.q[2] - v.dot(du_T) - pairs.db[2]) / square(2, 2);
      pairs.db.head<2>() = pairs.q.head<2>() - v * pairs.dh[2] - square.topLeftCorner<2, 2>() * du_T;
    }
    return true;
  }

  static Vec3 change(const Point& point, const Velocities& dy) {
    Vec3 du = Vec3::Zero();
    if (point.i != kNone) du.noalias() += point.J_i * dy.col(point.i);
    if (point.j != kNone) du.noalias() += point.J_j * dy.col(point.j);
    return du;
  }

  /// right - (1 + J^T D J) dy.
  Velocities left(const Velocities& right, const Velocities& dy) const {
    Velocities rest = right - dy;
    for (std::size_t k = 0; k < pairs_.size(); ++k) {
      const Point& point = system_.points()[k];
      System::push(point, -D_[k] * change(point, dy), rest);
    }
    return rest;
  }

  double longestStep() const {
    double t = std::numeric_limits<double>::infinity();
    for (const Pairs& pairs : pairs_) t = std::min(t, pairs.longestStep());
    return t;
  }

  const System& system_;
  BodyBlocks& matrix_;
  Velocities y_;
  std::vector<Pairs> pairs_;
  std::vector<Mat3> D_;
  Velocities away_;  // y - y_free - J^T r
  int count_ = 0;    // of pairs
  int short_steps_ = 0;
};

}  // namespace

Answer interiorPoint(const System& system, BodyBlocks& matrix, double tolerance, int cap) {
  InteriorPoint method(system, matrix);
  Answer best;
  best.r = Impulses::Zero(3, system.points().size());
  best.residuals = system.residuals(best.r);
  for (int k = 1; k <= cap && !best.within(tolerance); ++k) {
    best.iterations = k;
    if (!method.advance()) break;
    const Impulses r = method.impulses();
    const Residuals residuals = system.residuals(r);
    if (residuals.beyond_rounding < best.residuals.beyond_rounding) best.r = r, best.residuals = residuals;
  }
  return best;
}

}  // namespace rbs::coulomb
