// SPDX-License-Identifier: BSD-3-Clause
// Session: the scene that is loaded, and its replacement by another.
#pragma once

#include "timeline.h"

#include "rigid_body_sim/scenes.h"
#include "rigid_body_sim/simulator.h"

#include <mutex>
#include <optional>
#include <string>

namespace rbs {

class Session {
 public:
  struct Options {
    std::string folder;                 ///< folder of the catalogue of scenes
    std::string scene = "playground";   ///< first scene: a name of the catalogue or a path
    std::optional<std::uint64_t> seed;  ///< replaces the seed of every scene
    std::optional<Fidelity> fidelity;   ///< replaces the solver settings of every scene
    bool wall_stamps = false;           ///< stamp messages with wall time
    Simulator::Options run;
  };

  /// Throws InvalidInput for a faulty or unknown scene.
  explicit Session(const Options& options);

  Simulator& simulator() { return simulator_; }
  Timeline& timeline() { return timeline_; }
  const std::string& folder() const { return options_.folder; }

  /// Replaces the world by a scene of the catalogue or of a file; `seed` replaces Options::seed. Returns what was
  /// loaded. A saved state that the file holds too is left out. Throws InvalidInput for a bad scene.
  SceneFile loadScene(const std::string& name_or_file,
                      const std::optional<std::uint64_t>& seed = std::nullopt);
  /// Replaces the world by a state that was saved, without its user forces. Returns what was loaded. Throws InvalidInput
  /// for a file without one.
  SceneFile loadState(const std::string& file);
  /// Back to the world as it was loaded.
  void reset();
  /// Takes the last edit back, or makes it again. Returns it in words. Throws InvalidInput where there is none.
  std::string undo();
  std::string redo();

  /// Whether the scene itself has air. Air that was added by switching the wind on does not count.
  bool hasOwnAir() const;
  /// The wind that a switch turns on: the one it turned off, or else that of the scene, or else the default.
  Wind usualWind() const;
  void setUsualWind(const Wind& wind);

 private:
  Session(const Options& options, SceneDef first);
  static SceneFile read(const Options& options, const std::string& file);
  void replace(const SceneFile& file, const std::string& text);
  std::string goBack(const std::string& kind, std::string (Simulator::*go)());
  void forgetWind();

  const Options options_;
  mutable std::mutex mutex_;
  std::optional<Wind> turned_off_;  ///< the wind that was
  Simulator simulator_;
  Timeline timeline_;
};

}  // namespace rbs
