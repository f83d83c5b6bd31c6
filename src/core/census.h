// SPDX-License-Identifier: BSD-3-Clause
// The census: how much of each thing the scene holds. It decides which stages run.
//
// It changes by edits alone. What one step holds (touching pairs, fast bodies, impacts) is not here:
// that only makes a stage's list empty.
#pragma once

#include "bodies.h"
#include "rigid_body_sim/scene.h"

#include <array>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <vector>

namespace rbs {

struct Census {
  Index bodies = 0;
  Index moved_by_forces = 0;  ///< dynamic, neither held nor frozen
  Index led = 0;              ///< kinematic or held
  Index asleep = 0;
  Index collidable = 0;                                    ///< with another body that they may meet
  std::array<Index, std::variant_size_v<Shape>> shapes{};  ///< of those, by shape
  Index ballistic = 0;   ///< moved by gravity alone, and never meeting another
  Index asymmetric = 0;  ///< moved by forces, with principal moments that differ
  Index rough = 0;       ///< collidable, friction > 0
  Index bouncy = 0;      ///< collidable, restitution > 0
  Index rolling = 0;     ///< collidable, with rolling or torsional resistance > 0
  Index dragged = 0;     ///< moved by forces, with a drag coefficient > 0
  Index turned = 0;      ///< moved by forces, with something that may turn them
  Index grabs = 0, holds = 0, wrenches = 0;
  double gravity = 0.0;        ///< magnitude, m/s²
  double air_density = 0.0;    ///< kg/m³; 0 without air
  double fluid_density = 0.0;  ///< kg/m³; 0 without a fluid
  double fluid_level = 0.0;    ///< m
  bool wind = false;
  Setting fidelity;
  EffectOverrides overrides;

  friend bool operator==(const Census& a, const Census& b);
};

/// Whether a stage is needed, and why, in words and numbers.
struct Need {
  bool active;
  std::string reason;
};

/// What the last census made of each body, so that an edit of one need not look at all.
struct CensusTally {
  /// Group, mask, and whether forces move it: bodies of one kind may meet the same others. There are few
  /// kinds.
  using Layer = std::tuple<std::uint32_t, std::uint32_t, bool>;
  struct Entry {
    Layer layer{};
    std::size_t shape = 0;       ///< index of its Shape
    std::uint32_t features = 0;  ///< what it was counted for, by bit
  };
  std::map<Layer, Index> layers;  ///< how many bodies are of a kind
  std::set<Layer> partnered;      ///< kinds that may meet another body, one of the two moved by forces
  std::vector<Entry> entries;     ///< by body
  std::uint64_t looks = 0;        ///< how many bodies have been looked at so far
  Census census;
};

struct SceneStore;
/// Goes through the bodies once: remakes the dense lists, decides the effects and what each body feels of
/// them. Returns the census.
Census takeCensus(SceneStore& scene);
/// The same after an edit of these bodies and of what pulls at them, and of nothing else but that bodies were
/// appended: looks only at those. Looks at all where what others feel has changed: an effect, or whom they
/// may meet.
Census takeCensus(SceneStore& scene, const std::vector<Index>& changed);
/// Takes a body out of tally and lists, before it is erased.
void uncountBody(SceneStore& scene, Index i);

}  // namespace rbs
