// Drag: the force of the air.
//
// A sphere of radius R moving at u = v - v_air feels F = -(rho C A/2) |u| u with A = pi R².
//
// A capsule, cylinder, cone or hull is taken like a sphere, with a quarter of its surface for A: that is the
// mean of the projected areas of a convex body over all directions (A. Cauchy, 1832). It feels no couple.
//
// A box is felt by its faces. A surface element dA with outward normal n that moves at u through the air and
// faces it (n.u > 0) sweeps up the air in its way: dF = -(rho C/2) (n.u) u dA. Summed over a box that does
// not spin this is the drag of its projected area, and no torque: the couple of face k is its area times
// half its extent times (n_k.u) n_k x u, area times extent is the volume for each of them, and the sum of
// (n_k.u) n_k over the windward faces is u itself, so that u x u is left. A box that spins has elements of
// different velocity; each face is taken at its 2 x 2 Gauss points, which gives the damping of the spin and
// its coupling with the wind.
//
// In time: a step of the linearly implicit midpoint rule (Rosenbrock with gamma = 1/2),
//   (M - h/2 J) dV = h (F(V) + G),   J = dF/dV,   G all other loads.
// For drag alone, u' = -k |u| u, this is dV = -h k u²/(1 + h k u), so u(h) = u/(1 + k u h): the exact
// solution, which never overshoots however stiff. Its fixed point is F + G = 0: the exact terminal velocity.
// In between it is of second order.
#include "algebra.h"
#include "effects/effects.h"
#include "text.h"

#include <Eigen/LU>

#include <cmath>

namespace rbs {

namespace {

using Vec6 = Eigen::Matrix<double, 6, 1>;
using Mat6 = Eigen::Matrix<double, 6, 6>;

// Acceleration of a sphere over the step h. M - h/2 J is alpha I + beta u u^T, inverted by Sherman and
// Morrison's formula.
Vec3 sphereAcceleration(const Vec3& u, double k, const Vec3& a_W, double h) {
  const double speed = u.norm();
  const Vec3 b = a_W - k * speed * u;
  if (speed == 0.0) return b;
  const double alpha = 1.0 + 0.5 * h * k * speed;
  const double beta = 0.5 * h * k / speed;
  return (b - beta * u.dot(b) / (alpha + beta * speed * speed) * u) / alpha;
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

void dragBox(const Box& box, const Bodies& bodies, Index i, const Vec3& u, double half_rho_C, double h,
             Load& load) {
  const Mat3 R_WB = bodies.R_WB(i);
  const Vec3& w = bodies.twist[i].w_WB;
  const BoxDrag air = boxDrag(box.size, R_WB, u, w, half_rho_C);
  const double mass = bodies.traits[i].mass;
  const Mat3 inertia_W = R_WB * bodies.inertia[i].moments.asDiagonal() * R_WB.transpose();
  Mat6 M = Mat6::Zero();
  M.topLeftCorner<3, 3>() = mass * Mat3::Identity();
  M.bottomRightCorner<3, 3>() = inertia_W;
  Vec6 rhs = air.wrench;
  rhs.head<3>() += mass * load.a_W;
  rhs.tail<3>() += load.torque_W;
  const Vec6 rate = (M - 0.5 * h * air.jacobian).partialPivLu().solve(rhs);
  load.a_W = rate.head<3>();
  load.torque_W = inertia_W * rate.tail<3>();
}

}  // namespace

// Eight waves for each horizontal component, with periods from 0.7 s to 9 s and phases from the seed: a
// closed form in time, so that a gust is the same whatever the step. Each wave of amplitude A has variance
// A²/2; A = gust sqrt(2/8) gives the standard deviation asked for.
Vec3 airVelocity(const SceneDef& settings, double time) {
  if (!settings.wind) return Vec3::Zero();
  const Wind& wind = *settings.wind;
  Vec3 u = wind.velocity;
  if (wind.gust == 0.0) return u;
  std::uint64_t state = settings.seed;
  const auto uniform = [&state] {  // SplitMix64 (Steele, Lea, Flood, OOPSLA 2014)
    std::uint64_t z = (state += 0x9e3779b97f4a7c15ull);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1.0p-53;
  };
  constexpr int kWaves = 8;
  for (int axis = 0; axis < 2; ++axis) {
    for (int k = 0; k < kWaves; ++k) {
      const double period = 0.7 * std::pow(9.0 / 0.7, (k + uniform()) / kWaves);
      const double phase = 2.0 * kPi * uniform();
      u[axis] += wind.gust * std::sqrt(2.0 / kWaves) * std::sin(2.0 * kPi * time / period + phase);
    }
  }
  return u;
}

namespace drag {

Need need(const Census& c) {
  if (c.air_density == 0.0) return {false, "the scene has no air"};
  if (c.dragged == 0) return {false, "no body that forces move has a drag coefficient above 0"};
  return {true, std::string(c.wind ? "wind" : "still air") + " of " + text(c.air_density) + " kg/m³ on " +
                    count(c.dragged, "body", "bodies")};
}

// Runs after the other loads: the implicit step sees them all. The gust is taken at the middle of the step.
void run(Context& context) {
  const SceneStore& scene = context.scene;
  StepStore& step = context.step;
  const double h = step.h();
  const Vec3 air = airVelocity(scene.settings, step.t0 + 0.5 * h);
  for (const Index i : scene.rosters.dragged) {
    const Traits& t = scene.bodies.traits[i];
    const Vec3 u = scene.bodies.twist[i].v_WB - air;
    const double half_rho_C = 0.5 * scene.settings.air->density * t.dragCoefficient();
    if (const auto* box = std::get_if<Box>(&t.shape)) {
      dragBox(*box, scene.bodies, i, u, half_rho_C, h, step.load[i]);
    } else {
      const auto* ball = std::get_if<Sphere>(&t.shape);
      const double area = ball ? kPi * ball->radius * ball->radius : 0.25 * surfaceArea(t.shape);
      step.load[i].a_W = sphereAcceleration(u, half_rho_C * area / t.mass, step.load[i].a_W, h);
    }
  }
}

}  // namespace drag
}  // namespace rbs
