// The census: how much of each thing the scene holds. It decides which stages run.
//
// It changes by edits alone. What one step holds (touching pairs, fast bodies, impacts) is not here:
// that only makes a stage's list empty.
#pragma once

#include "bodies.h"
#include "rigid_body_sim/scene.h"

#include <string>

namespace rbs {

struct Census {
  Index bodies = 0;
  Index moved_by_forces = 0;  ///< dynamic, neither held nor frozen
  Index led = 0;              ///< kinematic or held
  Index collidable = 0;       ///< with a mask that is not 0
  Index asymmetric = 0;       ///< moved by forces, with principal moments that differ
  Index rough = 0;            ///< friction > 0
  Index bouncy = 0;           ///< restitution > 0
  Index dragged = 0;          ///< moved by forces, with a drag coefficient > 0
  Index grabs = 0, holds = 0, wrenches = 0;
  double gravity = 0.0;      ///< magnitude, m/s²
  double air_density = 0.0;  ///< kg/m³; 0 without air
  bool wind = false;
  Fidelity fidelity = Fidelity::Interactive;

  friend bool operator==(const Census& a, const Census& b);
};

struct SceneStore;
struct Rosters;
Census takeCensus(const SceneStore& scene);
Rosters takeRosters(const Bodies& bodies);

/// Whether a stage is needed, and why, in words and numbers.
struct Need {
  bool active;
  std::string reason;
};

}  // namespace rbs
