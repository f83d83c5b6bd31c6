// SPDX-License-Identifier: BSD-3-Clause
// The scene analysis: how much of each thing the scene holds. It decides which stages run.
//
// It changes by edits, and where a step puts bodies to sleep, wakes or freezes them, or ends a wrench. What one step holds
// (touching pairs, fast bodies, impacts) is not here: that only makes a stage's list empty.
#pragma once

#include "rigid_body_sim/scene.h"
#include "state/bodies.h"
#include "state/scene_fields.h"

#include <array>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <vector>

namespace rbs {

struct SceneAnalysis {
  Index bodies = 0;
  Index moved_by_forces = 0;  ///< dynamic, and neither held, frozen nor asleep
  Index kinematic = 0;        ///< of kind kinematic, or dragged
  Index asleep = 0;
  Index ballistic = 0;                          ///< moved by gravity alone, and never meeting another
  std::array<Index, kEffects.size()> asking{};  ///< by effect: bodies that ask for it (effects.h)
  std::array<Index, std::variant_size_v<Shape>> shapes{};  ///< of those that may meet another, by shape
  Index grabs = 0, holds = 0, wrenches = 0;
  SceneDef scene;  ///< without its bodies

  /// How many bodies ask for an effect.
  Index askingFor(Effect effect) const { return asking[static_cast<std::size_t>(effect)]; }

  auto counts() const {
    return std::tie(bodies, moved_by_forces, kinematic, asleep, ballistic, asking, shapes, grabs, holds,
                    wrenches);
  }
  friend bool operator==(const SceneAnalysis& a, const SceneAnalysis& b) {
    return a.counts() == b.counts() && sameSurroundings(a.scene, b.scene);
  }
};

/// Whether a stage is needed, and why, in words and numbers.
struct Need {
  bool active;
  std::string reason;
};

/// What the last analysis found of each body, so that an edit of one body looks at that body alone.
struct SceneCounts {
  /// Group, mask, and whether forces move it: bodies of one kind may meet the same others. There are few
  /// kinds.
  using Layer = std::tuple<std::uint32_t, std::uint32_t, bool>;
  struct Entry {
    Layer layer{};
    std::size_t shape = 0;  ///< index of its Shape
    bool moved = false, kinematic = false, asleep = false;
    std::array<bool, kEffects.size()> asks{};  ///< for each effect
  };
  std::map<Layer, Index> layers;  ///< how many bodies are of a kind
  std::set<Layer> partnered;      ///< kinds that may meet another body, one of the two moved by forces
  std::vector<Entry> entries;     ///< by body
  std::uint64_t looks = 0;        ///< how many bodies have been looked at so far
  SceneAnalysis analysis;
};

}  // namespace rbs
