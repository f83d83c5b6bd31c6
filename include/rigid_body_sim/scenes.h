// SPDX-License-Identifier: BSD-3-Clause
// Scene files (YAML) and the catalogue of named scenes: a folder of them.
#pragma once

#include "rigid_body_sim/world.h"

#include <optional>
#include <string>
#include <vector>

namespace rbs {

/// A scene, and the rest of a saved state where the file holds one.
struct SceneFile {
  SceneDef scene;
  std::optional<SavedState> state;
};

/// Reads a scene from text. Throws InvalidInput with every problem: "file:line: path", value, allowed.
/// `file` is named in messages, and meshes are looked for beside it. `seed` replaces the seed of the text
/// when given.
SceneFile parseScene(const std::string& text, const std::string& file,
                     std::optional<std::uint64_t> seed = std::nullopt);

/// Reads a scene file. The same errors; a file over 16 MiB, one that cannot be read, and one without the key
/// `bodies` are refused. Nothing is quoted of a file without that key.
SceneFile readScene(const std::string& file, std::optional<std::uint64_t> seed = std::nullopt);

/// The text of a scene, which parseScene() reads back bit for bit.
std::string writeScene(const SceneDef& scene, const std::optional<SavedState>& state = std::nullopt);

/// Name and property of one scene of a catalogue.
struct SceneEntry {
  std::string name;  ///< file name without ".yaml"
  std::string property;
};

/// The named scenes in `folder`, by name.
std::vector<SceneEntry> listScenes(const std::string& folder);

/// The scene file for `name_or_file`: a name of the catalogue, or a path (it has a '/' or ends in
/// ".yaml"). Throws InvalidInput that lists the known names, and for a path that confineFilesTo() excludes.
std::string findScene(const std::string& folder, const std::string& name_or_file);

}  // namespace rbs
