// SPDX-License-Identifier: BSD-3-Clause
// Scene files (YAML), and the catalogue: a folder of named scenes.
#pragma once

#include "rigid_body_sim/world.h"

#include <optional>
#include <string>
#include <vector>

namespace rbs {

/// What a scene file holds.
struct SceneFile {
  SceneDef scene;                   ///< the scene, sound by validate()
  std::optional<SavedState> state;  ///< rest of a saved state; empty: the file is a scene only
};

/// Reads a scene from text of at most 64 MiB. Throws InvalidInput with every problem: "file:line: path",
/// value, allowed. `file` is named in messages, and meshes are looked for beside it. `seed` replaces the seed
/// of the text when given.
SceneFile parseScene(const std::string& text, const std::string& file,
                     std::optional<std::uint64_t> seed = std::nullopt);

/// Reads a scene file by parseScene(). A scene without a name of its own gets that of the file. Throws
/// InvalidInput as parseScene() does, and for a file that is over 64 MiB or cannot be read. Where a faulty
/// file does not even hold the word `bodies`, the message quotes nothing of it. confineFilesTo() is not
/// checked: see findScene().
SceneFile readScene(const std::string& file, std::optional<std::uint64_t> seed = std::nullopt);

/// The text of a scene, which parseScene() reads back bit for bit. Throws InvalidInput for a faulty scene,
/// and for one of more than 100,000 bodies or 64 MiB of text.
std::string writeScene(const SceneDef& scene, const std::optional<SavedState>& state = std::nullopt);

/// One scene of a catalogue.
struct SceneEntry {
  std::string name;      ///< file name without ".yaml"
  std::string property;  ///< SceneDef::property; "faulty: " and the faults for a scene that cannot be read
};

/// The scenes of the catalogue in `folder`, in the order of their names. It reads every file. Throws
/// InvalidInput for a folder that cannot be read.
std::vector<SceneEntry> listScenes(const std::string& folder);

/// The scene file for `name_or_file`: a name of the catalogue in `folder`, or a path (it has a '/' or ends in
/// ".yaml"), which need not exist; ".yaml" is added where only that file exists. Throws InvalidInput that lists
/// the known names for an unknown one, and for a path that confineFilesTo() excludes.
std::string findScene(const std::string& folder, const std::string& name_or_file);

}  // namespace rbs
