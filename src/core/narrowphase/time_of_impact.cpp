// SPDX-License-Identifier: BSD-3-Clause
// Closed forms where the gap is a root of a polynomial in time; conservative advancement elsewhere.
#include "narrowphase/time_of_impact.h"

#include "base/algebra.h"
#include "narrowphase/collide.h"
#include "narrowphase/parabola.h"
#include "narrowphase/safe_step.h"
#include "narrowphase/tolerances.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rbs {

namespace {

// A pair touches at `from` when its gap is below this fraction of the smaller length, or rounding.
constexpr double kTouching = 1e-12;
// A gap that closes is followed down to this fraction.
constexpr double kClosed = 1e-14;
// A pair that overlaps and opens may come nearer by this fraction of the overlap before it turns round.
constexpr double kSink = 1e-3;
// A velocity below this fraction of those it is the difference of is zero.
constexpr double kNoSpeed = 8.0 * kEpsilon;
constexpr int kAdvances = 10000;

// The pair at one time.
struct Scene {
  MovingShape a, b;
  Gap gap;
  double closed, touching;  // the gap of a pair that has closed, and of one that touches at `from`, m

  /// `kept` is what the looks at one pair hand on from one to the next (collide.h).
  Scene(const Shape& shape_a, const Motion& motion_a, const Shape& shape_b, const Motion& motion_b, double t,
        Simplex& kept)
      : a(shape_a, motion_a, t),
        b(shape_b, motion_b, t),
        gap(rbs::gap(shape_a, a.X_WB, shape_b, b.X_WB, kept)) {
    const double length = std::min(characteristicLength(shape_a), characteristicLength(shape_b));
    double size = a.X_WB.p_WB.cwiseAbs().maxCoeff() + b.X_WB.p_WB.cwiseAbs().maxCoeff();
    for (const Shape* shape : {&shape_a, &shape_b})
      if (!std::holds_alternative<Plane>(*shape)) size += boundingRadius(*shape);
    const double rounding = 4.0 * kEpsilon * size;
    closed = kClosed * length + rounding;
    touching = kTouching * length + rounding;
  }
};

// Whether something that closes at `speed` (negative: opens) and is pressed at `push`, both differences of
// terms as large as `speeds` and `pushes`, comes closer at once.
bool closes(double speed, double speeds, double push, double pushes) {
  if (std::abs(speed) > kNoSpeed * speeds) return speed > 0.0;
  return push > kNoSpeed * pushes;
}

// Whether any of the points that touch comes closer. A pair whose manifold is empty counts as closing.
bool approaches(const Scene& scene) {
  const MovingShape &a = scene.a, &b = scene.b;
  const Manifold manifold = collide(a.shape, a.X_WB, b.shape, b.X_WB, scene.touching);
  const Vec3& n = manifold.n_W;
  for (int k = 0; k < manifold.size; ++k) {
    const Vec3 arm_a = manifold.points[k].p_W - a.X_WB.p_WB, arm_b = manifold.points[k].p_W - b.X_WB.p_WB;
    const Vec3 velocity_a = a.v_W + a.w_W.cross(arm_a), velocity_b = b.v_W + b.w_W.cross(arm_b);
    const double speeds =
        a.v_W.norm() + b.v_W.norm() + a.w_W.norm() * arm_a.norm() + b.w_W.norm() * arm_b.norm();
    if (closes(n.dot(velocity_a - velocity_b), speeds, n.dot(a.a_W - b.a_W), a.a_W.norm() + b.a_W.norm()))
      return true;
  }
  return manifold.size == 0;
}

// The direction along which a pair is watched. How the normal has turned since the last look predicts how it
// turns on: where edges meet, the separation along a normal that stays as it is is soon lost. The normal of a
// plane turns with the plane.
class Watch {
 public:
  explicit Watch(const Scene& scene) : n_(scene.gap.n_W) {
    for (const MovingShape* x : {&scene.a, &scene.b})
      if (std::holds_alternative<Plane>(x->shape)) plane_ = true, turn_ = x->w_W;
  }

  /// Looks again after `passed` seconds.
  void look(const Scene& scene, double passed) {
    if (!plane_) turn_ = n_.cross(scene.gap.n_W) / passed;
    n_ = scene.gap.n_W;
  }

  double timeApart(const Scene& scene, bool touches, const Levels& levels, double horizon) const {
    const double time = rbs::timeApart(scene.a, scene.b, n_, turn_, touches, levels, horizon);
    if (plane_ || turn_.isZero(0.0) || time >= horizon) return time;
    return std::max(time, rbs::timeApart(scene.a, scene.b, n_, Vec3::Zero(), touches, levels, horizon));
  }

 private:
  Vec3 n_, turn_ = Vec3::Zero();
  bool plane_ = false;
};

// Steps forward by times for which the pair certainly stays apart. A pair that touches and opens is led over
// the time until it is free or turns round. Cut off, it answers a time that is early.
std::optional<double> advance(const Shape& a, const Motion& motion_a, const Shape& b, const Motion& motion_b,
                              double from, double to, int* looks) {
  double t = from, step = 0.0;
  std::optional<Watch> watch;
  Simplex kept;
  for (int k = 0; k < kAdvances; ++k) {
    const Scene scene(a, motion_a, b, motion_b, t, kept);
    if (looks != nullptr) ++*looks;
    const double distance = scene.gap.distance;
    const bool touches = distance <= (t == from ? scene.touching : scene.closed);
    if (touches && approaches(scene)) return t;

    if (watch)
      watch->look(scene, step);
    else
      watch.emplace(scene);
    const double floor = (1.0 + kSink) * std::min(distance, 0.0) - scene.touching;
    const double time = watch->timeApart(scene, touches, {0.5 * scene.closed, scene.touching, floor}, to - t);
    if (time >= to - t) return std::nullopt;
    double after = t + time;
    if (after == t) {
      if (!touches) return t;  // closer than time can resolve
      after = std::nextafter(t, std::numeric_limits<double>::infinity());
    }
    if (after > to) return std::nullopt;
    step = after - t;
    t = after;
  }
  return t;
}

std::optional<double> within(std::optional<double> s, double from, double to) {
  if (!s || *s > to - from) return std::nullopt;
  return std::min(from + *s, to);
}

// Equal accelerations leave the centres of B and A a straight path d + v s, and |d + v s| = R at
//   s = c / (-d.v + sqrt(|v|² R² - |d x v|²)),   c = |d|² - R²,
// the root of the quadratic in the form without cancellation.
std::optional<double> spheresOnLine(double radii, const Scene& scene) {
  const Vec3 d = scene.b.X_WB.p_WB - scene.a.X_WB.p_WB, v = scene.b.v_W - scene.a.v_W;
  const double distance = d.norm(), speed = v.norm(), closing = -d.dot(v);
  if (!(closing > kNoSpeed * distance * (scene.a.v_W.norm() + scene.b.v_W.norm()))) return std::nullopt;
  if (distance - radii <= scene.touching) return 0.0;
  const double across = d.cross(v).norm();
  const double discriminant = (speed * radii - across) * (speed * radii + across);
  if (discriminant < 0.0) return std::nullopt;
  return (distance - radii) * (distance + radii) / (closing + std::sqrt(discriminant));
}

// The height over a plane that does not turn is h + v s + a s²/2. Touching and not approaching, the sphere
// comes back at the later root, or turns round at the apex when it never gets free.
std::optional<double> sphereOverPlane(const Scene& scene) {
  const double height = scene.gap.distance, v = scene.gap.n_W.dot(scene.b.v_W - scene.a.v_W),
               a = scene.gap.n_W.dot(scene.b.a_W - scene.a.a_W);
  if (height > scene.touching) return firstFall(height, v, a);
  if (approaches(scene)) return 0.0;
  if (!(a < 0.0)) return std::nullopt;
  return (std::max(v, 0.0) + std::sqrt(std::max(0.0, v * v - 2.0 * a * height))) / -a;
}

// The path of the centre of sphere A, seen from the box B, which does not turn.
Parabola pathOverBox(const Scene& scene) {
  const Mat3 R_BW = scene.b.R_WB.transpose();
  return {R_BW * (scene.a.X_WB.p_WB - scene.b.X_WB.p_WB), R_BW * (scene.a.v_W - scene.b.v_W),
          R_BW * (scene.a.a_W - scene.b.a_W)};
}

// A sphere and a box that does not turn, or another sphere: then `radius` is that of both, `half` is zero.
std::optional<double> sphereAndBox(double radius, const Vec3& half, const Scene& scene, double horizon) {
  const bool touches = scene.gap.distance <= scene.touching;
  if (touches && approaches(scene)) return 0.0;
  return firstWithin(radius, half, pathOverBox(scene), touches, scene.touching, horizon);
}

}  // namespace

std::optional<double> timeOfImpact(const Shape& a, const Motion& motion_a, const Shape& b,
                                   const Motion& motion_b, double from, double to, int* looks) {
  if (!(from <= to)) return std::nullopt;
  if (std::holds_alternative<Plane>(a) && std::holds_alternative<Plane>(b)) return std::nullopt;
  const auto* sphere = std::get_if<Sphere>(&a);
  if (sphere == nullptr && std::holds_alternative<Sphere>(b))
    return timeOfImpact(b, motion_b, a, motion_a, from, to, looks);
  if (sphere == nullptr) return advance(a, motion_a, b, motion_b, from, to, looks);

  Simplex kept;
  const Scene scene(a, motion_a, b, motion_b, from, kept);
  if (const auto* other = std::get_if<Sphere>(&b)) {
    const double radii = sphere->radius + other->radius;
    return within(motion_a.a_W == motion_b.a_W ? spheresOnLine(radii, scene)
                                               : sphereAndBox(radii, Vec3::Zero(), scene, to - from),
                  from, to);
  }
  if (motion_b.twist.w_WB.isZero(0.0)) {
    if (std::holds_alternative<Plane>(b)) return within(sphereOverPlane(scene), from, to);
    if (const auto* box = std::get_if<Box>(&b))
      return within(sphereAndBox(sphere->radius, 0.5 * box->size, scene, to - from), from, to);
  }
  return advance(a, motion_a, b, motion_b, from, to, looks);
}

}  // namespace rbs
