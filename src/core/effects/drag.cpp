// SPDX-License-Identifier: BSD-3-Clause
// Drag: the force of the air.
//
// A sphere of radius R moving at u = v - v_air feels F = -(rho C A/2) |u| u with A = pi R².
//
// A capsule, cylinder, cone or hull is taken like a sphere, with a quarter of its surface for A: that is the
// mean of the projected areas of a convex body over all directions (A. Cauchy, 1832). It feels no torque.
//
// A box is felt by its faces. A surface element dA with outward normal n that moves at u through the air and
// faces it (n.u > 0) sweeps up the air in its way: dF = -(rho C/2) (n.u) u dA. Summed over a box that does
// not spin this is the drag of its projected area, and no torque: the torque of face k is its area times
// half its extent times (n_k.u) n_k x u, area times extent is the volume for each of them, and the sum of
// (n_k.u) n_k over the windward faces is u itself, so that u x u is left. A box that spins has elements of
// different velocity; each face is taken at its 2 x 2 Gauss points, which gives the damping of the spin and
// its coupling with the wind.
//
// In time: a step of the linearly implicit midpoint rule (Rosenbrock with gamma = 1/2),
//   (M - h/2 J) dV = h (F(V) + G),   J = dF/dV,   G all other loads.
// For drag alone, u' = -k |u| u, this is dV = -h k u²/(1 + h k u), so u(h) = u/(1 + k u h): the exact
// solution, which never overshoots however stiff. Its fixed point is F + G = 0: the exact terminal velocity.
// In between it is of second order, with a box as it stands and spins in the middle of the step. Boxes and bodies
// in contact get it.
//
// From rest J = 0, and a load b alone would send a body to h b, whatever the drag at that speed. It nears its terminal
// velocity sqrt(b/k) within 1/sqrt(k b). Where the step is not short beside that, as of foam that is let go under
// water, the drag is that of the velocity at the end of the step, V1 = V + h M^-1 (F(V1) + G). For a body that does not
// turn this is closed: u1 points along s = u + h b, and |u1| (1 + h k |u1|) = |s|. It passes no terminal velocity, and has
// the same fixed point. A box finds it by Newton's method.
//
// On a body in contact the force R of its contacts acts too. It is known from the last step:
//   (M - h/2 J) dV = h (F(V) + G + R),
// and the contact solver gets the load M dV/h - R. A body at rest has dV = 0 and so the whole load F + G.
// Without R its load would be A (F + G) with A = M (M - h/2 J)^-1, whose eigenvalues are in (0, 1]. With R
// what is missing from the load is multiplied by I - A in each step.
//
// Bodies in flight that the air does not turn are integrated to rounding, by the method of Dormand and Prince
// (1980) with its own choice of steps.
#include "base/algebra.h"
#include "base/text.h"
#include "dynamics/integrate.h"
#include "effects/contact_forces.h"
#include "effects/effects.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace rbs {

namespace {

using Vec6 = Eigen::Matrix<double, 6, 1>;
using Mat6 = Eigen::Matrix<double, 6, 6>;

// h² k |b| from which a load takes a body to its terminal velocity within a step. There both methods are off by a tenth.
constexpr double kReachesTerminal = 0.25;

bool reachesTerminal(double k, double load_a, double h) {
  return h * h * k * load_a > kReachesTerminal;
}

// Acceleration of a sphere over the step h, where a_W is that of all other forces. M - h/2 J is
// alpha I + beta u u^T, inverted by Sherman and Morrison's formula.
Vec3 sphereAcceleration(const Vec3& u, double k, const Vec3& a_W, double h) {
  const double speed = u.norm();
  if (reachesTerminal(k, a_W.norm(), h)) {
    const Vec3 s = u + h * a_W;
    return (2.0 / (1.0 + std::sqrt(1.0 + 4.0 * h * k * s.norm())) * s - u) / h;
  }
  const Vec3 b = a_W - k * speed * u;
  if (speed == 0.0) return b;
  const double alpha = 1.0 + 0.5 * h * k * speed;
  const double beta = 0.5 * h * k / speed;
  return (b - beta * u.dot(b) / (alpha + beta * speed * speed) * u) / alpha;
}

// What a body moves through: air, or a mean of air and fluid, weighted by the volume in each.
struct Medium {
  double density;
  Vec3 v_W;
};

Medium mediumOf(const Context& context, Index i) {
  const SceneDef& settings = context.scene.settings;
  const double wet = context.step.submerged.empty() ? 0.0 : context.step.submerged[i];
  const double air = settings.air ? (1.0 - wet) * settings.air->density : 0.0;
  const double density = wet > 0.0 ? air + wet * settings.fluid->density : air;
  return {density, density > air ? Vec3(air / density * context.step.air) : context.step.air};
}

double halfDensity(const SceneStore& scene, Index i, const Medium& medium) {
  return 0.5 * medium.density * scene.bodies.traits[i].dragCoefficient();
}

/// k of the acceleration -k |u| u of a body that is no box, 1/m.
double dragOf(const SceneStore& scene, Index i, const Medium& medium) {
  const Traits& t = scene.bodies.traits[i];
  const double area = t.round ? kPi * t.side_radius * t.side_radius : 0.25 * surfaceArea(t.shape);
  return halfDensity(scene, i, medium) * area / t.mass;
}

// The wrench of the air on a surface element and its derivative, added up over a box. V = (u, w).
struct BoxDrag {
  Vec6 wrench = Vec6::Zero();
  Mat6 jacobian = Mat6::Zero();

  // An element at r from the centre with outward normal n; c = rho C dA/2.
  void add(const Vec3& u_centre, const Vec3& w, const Vec3& r, const Vec3& n, double c) {
    const Vec3 u = u_centre + w.cross(r);
    const double facing = n.dot(u);
    if (facing <= 0.0) return;
    const Vec3 force = -c * facing * u;
    const Mat3 J = -c * (u * n.transpose() + facing * Mat3::Identity());
    const Mat3 lever = crossMatrix(r);
    wrench.head<3>() += force;
    wrench.tail<3>() += r.cross(force);
    jacobian.topLeftCorner<3, 3>() += J;
    jacobian.topRightCorner<3, 3>() -= J * lever;
    jacobian.bottomLeftCorner<3, 3>() += lever * J;
    jacobian.bottomRightCorner<3, 3>() -= lever * J * lever;
  }
};

BoxDrag boxDrag(const Vec3& size, const Mat3& R_WB, const Vec3& u, const Vec3& w, double half_rho_C) {
  const double gauss = 1.0 / std::sqrt(3.0);
  BoxDrag sum;
  for (int axis = 0; axis < 3; ++axis) {
    const int s = (axis + 1) % 3, t = (axis + 2) % 3;
    const double area = size[s] * size[t];
    for (const double side : {-1.0, 1.0}) {
      for (int point = 0; point < 4; ++point) {
        Vec3 r_B;
        r_B[axis] = side * 0.5 * size[axis];
        r_B[s] = (point & 1 ? gauss : -gauss) * 0.5 * size[s];
        r_B[t] = (point & 2 ? gauss : -gauss) * 0.5 * size[t];
        sum.add(u, w, R_WB * r_B, side * R_WB.col(axis), 0.25 * area * half_rho_C);
      }
    }
  }
  return sum;
}

// The most that a box is turned by to where it stands in the middle of a step, rad. What spins faster is as if it spun
// at that rate: its air changes several times a step, and a torque that is that of one attitude may spin it up. Then what
// counts is what is left of it in the mean: that along the angular momentum L, about which the box turns and tumbles. Air at
// rest only takes from L.
constexpr double kMostHalfTurn = 0.5;

// Whether a torque alone gives a body energy in h.
bool addsSpin(const Bodies& bodies, Index i, const Vec3& torque_W, double h) {
  Pose pose = bodies.pose[i];
  Twist twist = bodies.twist[i];
  const double before = bodies.spinEnergy(i, pose.q_WB, twist.w_WB);
  fly(pose, twist, bodies.inertia[i], Vec3::Zero(), torque_W, h);
  return bodies.spinEnergy(i, pose.q_WB, twist.w_WB) > before;
}

// What is left of a torque of the air over h in which a box of angular momentum L turns many times.
Vec3 meanTorque(const Vec3& torque_W, const Vec3& L_W, double h) {
  return std::clamp(torque_W.dot(L_W) / L_W.squaredNorm(), -1.0 / h, 0.0) * L_W;
}

// From far above the terminal velocity each step of Newton's method halves the speed, and then doubles the digits. Where faces come
// into the lee or out of it a whole step may be too long.
constexpr int kMostNewtonSteps = 60, kMostHalvedSteps = 8;
constexpr double kNewtonTolerance = 1e-13;

// The wrench of forces and inertia, M rate = others + air(V + h rate), solved for the rate. What is left of a wrench f is measured by
// f M^-1 f, which has one unit and no length to choose: forces and torques count by what they move. It falls in each step, until it is
// rounding.
template <class Air>
Vec6 terminalRate(const Mat6& M, const Vec6& others, double h, const Air& airAt) {
  const Eigen::LLT<Mat6> mass(M);
  const auto sizeOf = [&](const Vec6& wrench) { return std::sqrt(wrench.dot(mass.solve(wrench))); };
  Vec6 rate = Vec6::Zero();
  BoxDrag air = airAt(rate);
  Vec6 left = others + air.wrench;
  for (int step = 0; step < kMostNewtonSteps; ++step) {
    const double size = sizeOf(left);
    if (size <= kNewtonTolerance * (sizeOf(others) + sizeOf(air.wrench))) break;
    Vec6 change = (M - h * air.jacobian).partialPivLu().solve(left);
    BoxDrag next = airAt(rate + change);
    for (int k = 0; k < kMostHalvedSteps && !(sizeOf(others + next.wrench - M * (rate + change)) < size);
         ++k) {
      change *= 0.5;
      next = airAt(rate + change);
    }
    const Vec6 next_left = others + next.wrench - M * (rate + change);
    if (!(sizeOf(next_left) < size)) break;
    rate += change, air = next, left = next_left;
  }
  return rate;
}

void dragBox(const Box& box, const Bodies& bodies, Index i, const Vec3& u, double half_rho_C, double h,
             const ContactForces& contacts, Load& load) {
  // As it is in the middle of the step without loads: turned, and spinning with the same angular momentum.
  const Mat3 R0_WB = bodies.R_WB(i);
  const Vec3& moments = bodies.inertia[i].moments;
  const Vec3 w0 = bodies.twist[i].w_WB, half_turn = std::min(0.5 * h, kMostHalfTurn / w0.norm()) * w0;
  const Mat3 R_WB = rotationBy(half_turn).toRotationMatrix() * R0_WB;
  const Vec3 L_W = R0_WB * moments.cwiseProduct(R0_WB.transpose() * w0);
  const Vec3 w = R_WB * (R_WB.transpose() * L_W).cwiseQuotient(moments);
  const BoxDrag air = boxDrag(box.size, R_WB, u, w, half_rho_C);
  const double mass = bodies.traits[i].mass;
  const Mat3 inertia_W = R_WB * moments.asDiagonal() * R_WB.transpose();
  Mat6 M = Mat6::Zero();
  M.topLeftCorner<3, 3>() = mass * Mat3::Identity();
  M.bottomRightCorner<3, 3>() = inertia_W;
  Vec6 rhs = air.wrench;
  rhs.head<3>() += mass * load.a_W;
  rhs.tail<3>() += load.torque_W;
  const Vec3 carried = contacts.on(i, rhs.head<3>());
  rhs.head<3>() += carried;
  Vec6 rate;
  const double k = half_rho_C * 0.25 * surfaceArea(box) / mass;
  if (reachesTerminal(k, (load.a_W + carried / mass).norm(), h)) {
    rate = terminalRate(M, rhs - air.wrench, h, [&](const Vec6& rate) {
      return boxDrag(box.size, R_WB, u + h * rate.head<3>(), w + h * rate.tail<3>(), half_rho_C);
    });
  } else {
    rate = (M - 0.5 * h * air.jacobian).partialPivLu().solve(rhs);
  }
  load.a_W = rate.head<3>() - carried / mass;
  const Vec3 torque_W = inertia_W * rate.tail<3>();
  const Vec3 of_air_W = torque_W - load.torque_W;
  const bool is_mean = 0.5 * h * w0.norm() > kMostHalfTurn && addsSpin(bodies, i, of_air_W, h);
  load.torque_W = is_mean ? load.torque_W + meanTorque(of_air_W, L_W, h) : torque_W;
}

}  // namespace

namespace drag {

Need need(const SceneAnalysis& c) {
  const bool fluid = effects::need(Effect::Buoyancy, c).active;  // which says who is in it
  if (!c.scene.air && !fluid) return {false, "the scene has neither air nor a fluid"};
  if (c.askingFor(Effect::Drag) == 0)
    return {false, "no body that forces move has a drag coefficient above 0"};
  std::string medium;
  if (c.scene.air)
    medium =
        std::string(c.scene.wind ? "wind" : "still air") + " of " + text(c.scene.air->density) + " kg/m^3";
  if (fluid)
    medium += (medium.empty() ? "" : " and ") + std::string("a fluid of ") +
              text(c.scene.fluid ? c.scene.fluid->density : 0.0) + " kg/m^3";
  return {true, medium + " on " + count(c.askingFor(Effect::Drag), "body", "bodies")};
}

namespace {

// Adds the drag of body i over h s to its load.
void add(Context& context, Index i, double h, const ContactForces& contacts) {
  const SceneStore& scene = context.scene;
  Load& load = context.step.load[i];
  const Medium medium = mediumOf(context, i);
  const Vec3 u = scene.bodies.twist[i].v_WB - medium.v_W;
  if (const auto* box = std::get_if<Box>(&scene.bodies.traits[i].shape))
    return dragBox(*box, scene.bodies, i, u, halfDensity(scene, i, medium), h, contacts, load);
  const double k = dragOf(scene, i, medium), mass = scene.bodies.traits[i].mass;
  const Vec3 alone = load.a_W - k * u.norm() * u;
  const Vec3 carried = contacts.on(i, mass * alone) / mass;
  load.a_W = sphereAcceleration(u, k, load.a_W + carried, h) - carried;
}

}  // namespace

// Runs after the other loads: the implicit step sees them all. The gust is taken at the middle of the step.
void run(Context& context) {
  StepStore& step = context.step;
  step.air = airVelocity(context.scene.settings, step.t0 + 0.5 * step.h());
  step.load_without_drag.resize(step.load.size());
  const ContactForces contacts(context);
  for (const Index i : context.scene.lists.feelingOf(Effect::Drag)) {
    step.load_without_drag[i] = step.load[i];
    add(context, i, step.h(), contacts);
  }
}

void renew(Context& context, Index i, double seconds) {
  StepStore& step = context.step;
  const std::vector<Index>& feeling = context.scene.lists.feelingOf(Effect::Drag);
  if (step.load_without_drag.empty() || !(seconds > 0.0)) return;
  if (!std::binary_search(feeling.begin(), feeling.end(), i)) return;
  step.load[i] = step.load_without_drag[i];
  add(context, i, seconds, {});
}

std::optional<FlightEnd> fly(const Context& context, Index i, const Vec3& p_WB, const Vec3& v_WB,
                             double seconds) {
  constexpr double kStiff = 10.0;  // k |u| t from which implicit steps are better
  constexpr double kTolerance = 1e-14;
  const Traits& t = context.scene.bodies.traits[i];
  if (context.step.load_without_drag.empty() || t.dragCoefficient() == 0.0 ||
      std::holds_alternative<Box>(t.shape))
    return {};
  const Medium medium = mediumOf(context, i);
  const Vec3 b = context.step.load_without_drag[i].a_W, air = medium.v_W;
  const double k = dragOf(context.scene, i, medium);
  Vec3 x = Vec3::Zero(), u = v_WB - air;  // as the air sees it
  const double scale = u.norm() + seconds * b.norm();
  if (scale == 0.0) return FlightEnd{p_WB + seconds * v_WB, v_WB};
  if (!(k * scale * seconds <= kStiff)) return {};  // nor where one of them is no number

  // The method of Dormand and Prince; place is the integral of u with the same weights.
  const auto slope = [&](const Vec3& w) -> Vec3 { return b - k * w.norm() * w; };
  double done = 0.0, h = seconds;
  while (done < seconds) {
    h = std::min(h, seconds - done);
    const Vec3 k1 = slope(u);
    const Vec3 u2 = u + h * k1 / 5.0, k2 = slope(u2);
    const Vec3 u3 = u + h * (3.0 / 40.0 * k1 + 9.0 / 40.0 * k2), k3 = slope(u3);
    const Vec3 u4 = u + h * (44.0 / 45.0 * k1 - 56.0 / 15.0 * k2 + 32.0 / 9.0 * k3), k4 = slope(u4);
    const Vec3 u5 = u + h * (19372.0 / 6561.0 * k1 - 25360.0 / 2187.0 * k2 + 64448.0 / 6561.0 * k3 -
                             212.0 / 729.0 * k4),
               k5 = slope(u5);
    const Vec3 u6 = u + h * (9017.0 / 3168.0 * k1 - 355.0 / 33.0 * k2 + 46732.0 / 5247.0 * k3 +
                             49.0 / 176.0 * k4 - 5103.0 / 18656.0 * k5),
               k6 = slope(u6);
    const auto weigh = [](const Vec3& a, const Vec3& c, const Vec3& d, const Vec3& e, const Vec3& f) -> Vec3 {
      return 35.0 / 384.0 * a + 500.0 / 1113.0 * c + 125.0 / 192.0 * d - 2187.0 / 6784.0 * e +
             11.0 / 84.0 * f;
    };
    const Vec3 u7 = u + h * weigh(k1, k3, k4, k5, k6), k7 = slope(u7);
    const Vec3 error = h * (71.0 / 57600.0 * k1 - 71.0 / 16695.0 * k3 + 71.0 / 1920.0 * k4 -
                            17253.0 / 339200.0 * k5 + 22.0 / 525.0 * k6 - k7 / 40.0);
    const double share = error.norm() / (kTolerance * scale);
    if (share <= 1.0 || h < 1e-6 * seconds) {
      x += h * weigh(u, u3, u4, u5, u6);
      u = u7;
      done = h < seconds - done ? done + h : seconds;
    }
    h *= std::clamp(0.9 * std::pow(std::max(share, 1e-10), -0.2), 0.2, 5.0);
  }
  return FlightEnd{p_WB + x + seconds * air, u + air};
}

}  // namespace drag
}  // namespace rbs
