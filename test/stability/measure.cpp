// SPDX-License-Identifier: BSD-3-Clause
#include "measure.h"

#include "rigid_body_sim/scenes.h"

#include <algorithm>

namespace rbs::stability {
namespace {

bool isFinite(const BodyState& state) {
  return state.pose.p_WB.allFinite() && state.pose.q_WB.coeffs().allFinite() &&
         state.twist.v_WB.allFinite() && state.twist.w_WB.allFinite();
}

}  // namespace

SceneDef fromCatalogue(const std::string& name) {
  return readScene(findScene(RBS_SCENES, name)).scene;
}

std::string named(const char* format, double value) {
  char text[96];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

BodyDef fixedBox(const std::string& name, const Vec3& size, const Vec3& p_W) {
  BodyDef def = test::box(name, size, p_W);
  def.kind = BodyKind::Static;
  return def;
}

SceneDef room(double side) {
  SceneDef scene = test::emptySpace(kFrame);
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {-1.0, 1.0}) {
      Vec3 size = Vec3::Constant(side + 1.0), p = Vec3::Zero();
      size[axis] = 0.5, p[axis] = sign * (0.5 * side + 0.25);
      scene.bodies.push_back(fixedBox("wall_" + std::to_string(scene.bodies.size()), size, p));
    }
  }
  return scene;
}

long double kineticEnergyOf(const World& world) {
  const Snapshot snapshot = world.snapshot();
  long double sum = 0.0L;
  for (std::size_t k = 0; k < snapshot.states.size(); ++k) {
    const BodyDescription& body = (*snapshot.bodies)[k];
    if (body.kind != BodyKind::Dynamic) continue;
    const BodyState& state = snapshot.states[k];
    const Vec3 w_B = state.pose.q_WB.conjugate() * state.twist.w_WB;
    for (int axis = 0; axis < 3; ++axis) {
      const long double v = state.twist.v_WB[axis], w = w_B[axis];
      sum += 0.5L * (body.mass * v * v + body.inertia[axis] * w * w);
    }
  }
  return sum;
}

long double energyOf(const World& world) {
  const Snapshot snapshot = world.snapshot();
  long double sum = kineticEnergyOf(world);
  for (std::size_t k = 0; k < snapshot.states.size(); ++k) {
    const BodyDescription& body = (*snapshot.bodies)[k];
    if (body.kind != BodyKind::Dynamic) continue;
    for (int axis = 0; axis < 3; ++axis)
      sum -=
          static_cast<long double>(body.mass) * snapshot.gravity[axis] * snapshot.states[k].pose.p_WB[axis];
  }
  return sum;
}

double energyScaleOf(const World& world) {
  const Snapshot snapshot = world.snapshot();
  const double g = snapshot.gravity.norm();
  const Vec3 up = g > 0.0 ? Vec3(-snapshot.gravity / g) : Vec3::UnitZ();
  double weight = 0.0, lowest = 1e300, highest = -1e300;
  for (std::size_t k = 0; k < snapshot.states.size(); ++k) {
    const BodyDescription& body = (*snapshot.bodies)[k];
    if (body.kind != BodyKind::Dynamic) continue;
    weight += body.mass * g;
    const double height = up.dot(snapshot.states[k].pose.p_WB), half = boundingRadius(body.shape);
    lowest = std::min(lowest, height - half);
    highest = std::max(highest, height + half);
  }
  return static_cast<double>(kineticEnergyOf(world)) + weight * std::max(0.0, highest - lowest);
}

double fastestPoint(const World& world) {
  const Snapshot snapshot = world.snapshot();
  double fastest = 0.0;
  for (std::size_t k = 0; k < snapshot.states.size(); ++k) {
    const BodyDescription& body = (*snapshot.bodies)[k];
    if (body.kind != BodyKind::Dynamic) continue;
    const Twist& twist = snapshot.states[k].twist;
    fastest = std::max(fastest, twist.v_WB.norm() + twist.w_WB.norm() * boundingRadius(body.shape));
  }
  return fastest;
}

Watch::Watch(SceneDef scene, Fidelity setting)
    : world_([&] {
        scene.fidelity = setting;
        return std::move(scene);
      }()),
      scale_(energyScaleOf(world_)),
      start_(static_cast<double>(energyOf(world_))),
      before_(start_) {}

void Watch::step() {
  const StepReport& report = world_.step();
  impacts_ += report.impacts;
  deepest_ = std::max(deepest_, report.deepest_penetration);
  for (const Warning& warning : report.warnings) finite_ &= warning.kind != "non_finite";
  const Snapshot snapshot = world_.snapshot();
  for (const BodyState& state : snapshot.states) finite_ &= isFinite(state);
  const double now = static_cast<double>(energyOf(world_));
  if (scale_ > 0.0) {
    step_growth_ = std::max(step_growth_, (now - before_) / scale_);
    total_growth_ = std::max(total_growth_, (now - start_) / scale_);
  }
  before_ = now;
}

void Watch::run(double seconds) {
  const auto steps = std::lround(seconds / world_.scene().step);
  for (long k = 0; k < steps; ++k) step();
}

bool Watch::runUntil(double seconds, const std::function<bool(const World&)>& until) {
  const auto steps = std::lround(seconds / world_.scene().step);
  for (long k = 0; k < steps; ++k) {
    if (until(world_)) return true;
    step();
  }
  return until(world_);
}

void Watch::writeFinite(Sheet& sheet) const {
  sheet.check("all numbers finite", finite_, every(0.0));
}

void Watch::writePromises(Sheet& sheet) const {
  writeFinite(sheet);
  Bound in_a_step = exact(1e-9), in_all = fastAndExact(1e-3, 1e-6);
  in_all.preview = 1e-3;
  sheet.error("energy gained in a step, of its scale", "", step_growth_, in_a_step);
  sheet.error("energy gained in all, of its scale", "", total_growth_, in_all);
}

FreeTop::FreeTop(const Vec3& moments, const Quat& q_WB, const Vec3& w_WB)
    : moments_(moments.cast<long double>()), q_(q_WB.w(), q_WB.x(), q_WB.y(), q_WB.z()) {
  const Eigen::Quaternion<long double> q(q_[0], q_[1], q_[2], q_[3]);
  const Real3 w = w_WB.cast<long double>();
  const Real3 momentum_B = moments_.cwiseProduct(q.conjugate() * w);
  momentum_W_ = q * momentum_B;
}

FreeTop::Real3 FreeTop::bodySpin(const Real4& q) const {
  const Eigen::Quaternion<long double> orientation(q[0], q[1], q[2], q[3]);
  const Real3 momentum_B = orientation.normalized().conjugate() * momentum_W_;
  return momentum_B.cwiseQuotient(moments_);
}

FreeTop::Real4 FreeTop::rate(const Real4& q) const {
  const Real3 w = bodySpin(q);
  const Eigen::Quaternion<long double> product = Eigen::Quaternion<long double>(q[0], q[1], q[2], q[3]) *
                                                 Eigen::Quaternion<long double>(0.0L, w[0], w[1], w[2]);
  return 0.5L * Real4(product.w(), product.x(), product.y(), product.z());
}

void FreeTop::run(long double seconds, long double step) {
  const auto steps = std::max(1L, std::lround(static_cast<double>(seconds / step)));
  const long double h = seconds / steps;
  for (long k = 0; k < steps; ++k) {
    const Real4 k1 = rate(q_), k2 = rate(q_ + 0.5L * h * k1), k3 = rate(q_ + 0.5L * h * k2),
                k4 = rate(q_ + h * k3);
    q_ = (q_ + h / 6.0L * (k1 + 2.0L * k2 + 2.0L * k3 + k4)).normalized();
  }
}

Quat FreeTop::orientation() const {
  return Quat(static_cast<double>(q_[0]), static_cast<double>(q_[1]), static_cast<double>(q_[2]),
              static_cast<double>(q_[3]));
}

Vec3 FreeTop::spinInBody() const {
  return bodySpin(q_).cast<double>();
}

double angleBetween(const Quat& a, const Quat& b) {
  const Quat between = a.conjugate() * b;
  return 2.0 * std::atan2(between.vec().norm(), std::abs(between.w()));
}

}  // namespace rbs::stability
