// Closed forms where the gap is a quadratic of time; conservative advancement elsewhere.
#include "narrowphase/time_of_impact.h"

#include "integrate.h"
#include "narrowphase/collide.h"
#include "narrowphase/safe_step.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rbs {

namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
// A pair touches at `from` when its gap is below this fraction of the smaller length, or rounding.
constexpr double kTouching = 1e-12;
// A gap that closes is followed down to this fraction.
constexpr double kClosed = 1e-14;
// A velocity below this fraction of those it is the difference of is zero.
constexpr double kStill = 8.0 * kEpsilon;
constexpr int kAdvances = 10000;

// The pair at one time.
struct Scene {
  Pose X_WA, X_WB;
  Mover a, b;

  Scene(const Shape& shape_a, const Motion& motion_a, const Shape& shape_b, const Motion& motion_b, double t)
      : X_WA(motion_a.at(t)),
        X_WB(motion_b.at(t)),
        a(mover(shape_a, X_WA, motion_a, t)),
        b(mover(shape_b, X_WB, motion_b, t)) {}

  static Mover mover(const Shape& shape, const Pose& pose, const Motion& motion, double t) {
    return {
        shape, pose.q_WB.toRotationMatrix(), pose.p_WB, motion.velocityAt(t), motion.a_W, motion.twist.w_WB};
  }
  // What rounding leaves of a gap, m.
  double rounding() const {
    double size = X_WA.p_WB.cwiseAbs().maxCoeff() + X_WB.p_WB.cwiseAbs().maxCoeff();
    for (const Mover* x : {&a, &b})
      if (!std::holds_alternative<Plane>(x->shape)) size += boundingRadius(x->shape);
    return 4.0 * kEpsilon * size;
  }
};

double smallerLength(const Shape& a, const Shape& b) {
  return std::min(characteristicLength(a), characteristicLength(b));
}

// Whether something that closes at `speed` (negative: opens) and is pressed at `push`, both differences of
// terms as large as `speeds` and `pushes`, comes closer at once.
bool closes(double speed, double speeds, double push, double pushes) {
  if (std::abs(speed) > kStill * speeds) return speed > 0.0;
  return push > kStill * pushes;
}

// Whether any of the points within `margin` comes closer. A pair whose manifold is empty counts as closing.
bool approaches(const Scene& scene, double margin) {
  const Mover &a = scene.a, &b = scene.b;
  const Manifold manifold = collide(a.shape, scene.X_WA, b.shape, scene.X_WB, margin);
  const Vec3& n = manifold.n_W;
  for (int k = 0; k < manifold.size; ++k) {
    const Vec3 arm_a = manifold.points[k].p_W - a.p_W, arm_b = manifold.points[k].p_W - b.p_W;
    const Vec3 velocity_a = a.v_W + a.w_W.cross(arm_a), velocity_b = b.v_W + b.w_W.cross(arm_b);
    const double speeds =
        a.v_W.norm() + b.v_W.norm() + a.w_W.norm() * arm_a.norm() + b.w_W.norm() * arm_b.norm();
    if (closes(n.dot(velocity_a - velocity_b), speeds, n.dot(a.a_W - b.a_W), a.a_W.norm() + b.a_W.norm()))
      return true;
  }
  return manifold.size == 0;
}

// Steps forward by times for which the pair certainly stays apart. A pair that touches and opens is led over
// the time for which it certainly does not come back; deep in overlap, for which it does not turn round,
// which under constant acceleration is half of that. Cut off, it answers a time that is early.
std::optional<double> advance(const Shape& a, const Motion& motion_a, const Shape& b, const Motion& motion_b,
                              double from, double to) {
  const double length = smallerLength(a, b);
  double t = from;
  for (int k = 0; k < kAdvances; ++k) {
    const Scene scene(a, motion_a, b, motion_b, t);
    const Gap now = gap(a, scene.X_WA, b, scene.X_WB);
    const double closed = kClosed * length + scene.rounding();
    const double touching = kTouching * length + scene.rounding();
    const bool touches = now.distance <= (t == from ? touching : closed);
    if (touches && approaches(scene, touching)) return t;

    const double overlap = std::max(0.0, -now.distance);
    const double slack = touches ? touching + 1e-3 * overlap : 0.0;
    const double share = overlap > touching ? 0.5 : 1.0;
    const double step =
        share * safeStep(scene.a, scene.b, now.n_W, now.distance + overlap, slack, (to - t) / share);
    if (step >= to - t) return std::nullopt;
    double after = t + step;
    if (after == t) {
      if (!touches) return t;  // closer than time can resolve
      after = std::nextafter(t, std::numeric_limits<double>::infinity());
    }
    if (after > to) return std::nullopt;
    t = after;
  }
  return t;
}

// Equal accelerations leave the centres of B and A a straight path d + v s, and |d + v s| = R at
//   s = c / (-d.v + sqrt(|v|² R² - |d x v|²)),   c = |d|² - R²,
// the root of the quadratic in the form without cancellation.
std::optional<double> spheresOnLine(double radii, const Scene& scene, double length, double from, double to) {
  const Vec3 d = scene.b.p_W - scene.a.p_W, v = scene.b.v_W - scene.a.v_W;
  const double distance = d.norm(), speed = v.norm(), closing = -d.dot(v);
  if (!(closing > kStill * distance * (scene.a.v_W.norm() + scene.b.v_W.norm()))) return std::nullopt;
  if (distance - radii <= kTouching * length + scene.rounding()) return from;
  const double across = d.cross(v).norm();
  const double discriminant = (speed * radii - across) * (speed * radii + across);
  if (discriminant < 0.0) return std::nullopt;
  const double s = (distance - radii) * (distance + radii) / (closing + std::sqrt(discriminant));
  if (s > to - from) return std::nullopt;
  return std::min(from + s, to);
}

// The height over a plane that does not turn is h + v s + a s²/2. Touching and not approaching, the sphere
// comes back at the later root, or turns round at the apex when it never gets free.
std::optional<double> sphereOverPlane(double height, double v, double a, bool touches, bool approaches,
                                      double from, double to) {
  std::optional<double> s;
  if (!touches)
    s = firstFall(height, v, a);
  else if (approaches)
    s = 0.0;
  else if (a < 0.0)
    s = (std::max(v, 0.0) + std::sqrt(std::max(0.0, v * v - 2.0 * a * height))) / -a;
  if (!s || *s > to - from) return std::nullopt;
  return std::min(from + *s, to);
}

}  // namespace

Pose Motion::at(double t) const {
  const double s = t - t0;
  return {pose.p_WB + s * (twist.v_WB + 0.5 * s * a_W),
          (rotationBy(s * twist.w_WB) * pose.q_WB).normalized()};
}

std::optional<double> timeOfImpact(const Shape& a, const Motion& motion_a, const Shape& b,
                                   const Motion& motion_b, double from, double to) {
  if (!(from <= to)) return std::nullopt;
  const auto *sphere_a = std::get_if<Sphere>(&a), *sphere_b = std::get_if<Sphere>(&b);
  if (sphere_a != nullptr && sphere_b != nullptr && motion_a.a_W == motion_b.a_W)
    return spheresOnLine(sphere_a->radius + sphere_b->radius, Scene(a, motion_a, b, motion_b, from),
                         smallerLength(a, b), from, to);

  const bool plane_a = std::holds_alternative<Plane>(a), plane_b = std::holds_alternative<Plane>(b);
  if (plane_a && plane_b) return std::nullopt;
  const Motion& plane = plane_a ? motion_a : motion_b;
  if ((plane_a && sphere_b != nullptr) || (plane_b && sphere_a != nullptr)) {
    if (plane.twist.w_WB.isZero(0.0)) {
      const Scene scene(a, motion_a, b, motion_b, from);
      const Gap now = gap(a, scene.X_WA, b, scene.X_WB);
      const double touching = kTouching * smallerLength(a, b) + scene.rounding();
      return sphereOverPlane(now.distance, now.n_W.dot(scene.b.v_W - scene.a.v_W),
                             now.n_W.dot(scene.b.a_W - scene.a.a_W), now.distance <= touching,
                             now.distance <= touching && approaches(scene, touching), from, to);
    }
  }
  return advance(a, motion_a, b, motion_b, from, to);
}

}  // namespace rbs
