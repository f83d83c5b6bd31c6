#include "census.h"

#include "context.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace rbs {

namespace {

auto fields(const Census& c) {
  return std::tie(c.bodies, c.moved_by_forces, c.led, c.collidable, c.asymmetric, c.rough, c.bouncy,
                  c.dragged, c.grabs, c.holds, c.wrenches, c.gravity, c.air_density, c.wind,
                  c.fidelity);
}

}  // namespace

bool operator==(const Census& a, const Census& b) {
  return fields(a) == fields(b);
}

Census takeCensus(const SceneStore& scene) {
  Census c;
  c.bodies = scene.bodies.size();
  for (Index i = 0; i < c.bodies; ++i) {
    const Traits& t = scene.bodies.traits[i];
    c.moved_by_forces += t.moved_by_forces();
    c.led += t.led();
    c.collidable += t.mask != 0;
    c.asymmetric += t.moved_by_forces() && !scene.bodies.inertia[i].isotropic;
    c.rough += t.material.friction > 0.0;
    c.bouncy += t.material.restitution > 0.0;
    c.dragged += t.moved_by_forces() && t.dragCoefficient() > 0.0;
  }
  c.grabs = static_cast<Index>(scene.grabs.size());
  c.holds = static_cast<Index>(scene.holds.size());
  c.wrenches = static_cast<Index>(scene.wrenches.size());
  c.gravity = scene.settings.gravity.norm();
  c.air_density = scene.settings.air ? scene.settings.air->density : 0.0;
  c.wind = scene.settings.wind.has_value();
  c.fidelity = scene.settings.fidelity;
  return c;
}

Rosters takeRosters(const Bodies& bodies) {
  Rosters r;
  for (Index i = 0; i < bodies.size(); ++i) {
    const Traits& t = bodies.traits[i];
    if (t.moved_by_forces()) r.movers.push_back(i);
    if (t.moved_by_forces() && t.dragCoefficient() > 0.0) r.dragged.push_back(i);
    if (t.led()) r.led.push_back(i);
    if (t.mask != 0) (std::holds_alternative<Plane>(t.shape) ? r.planes : r.collidable).push_back(i);
  }
  return r;
}

double pairFriction(const Material& a, const Material& b) {
  return std::sqrt(a.friction * b.friction);
}

double pairRestitution(const Material& a, const Material& b) {
  return std::max(a.restitution, b.restitution);
}

double fallSpeed(double gravity, double length) {
  constexpr double kEarth = 9.81;
  return std::sqrt((gravity > 0.0 ? gravity : kEarth) * length);
}

}  // namespace rbs
