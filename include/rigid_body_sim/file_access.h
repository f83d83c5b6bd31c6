// SPDX-License-Identifier: BSD-3-Clause
// Which files may be read and written, and when reading ends early. Set once, before any thread reads a file.
#pragma once

#include <functional>
#include <string>

namespace rbs {

/// Scenes, states and meshes are read and written in this folder and those below it only, wherever links
/// lead; "" lifts that. The catalogue of scenes, the meshes beside a scene and those of packages are read all
/// the same. Throws InvalidInput for a path that is no folder.
void confineFilesTo(const std::string& folder);

/// Throws InvalidInput with `path` where `file` is outside of the folder of confineFilesTo(), and of `also`.
void requireAccess(const std::string& file, const std::string& path, const std::string& also = "");

/// Reading of a file, and the making of a hull, ask this now and then, and throw InvalidInput once it is
/// true. It is called from any thread.
void interruptReadingBy(std::function<bool()> interrupted);

/// Throws InvalidInput with `path` if interruptReadingBy() says so.
void stopIfInterrupted(const std::string& path);

}  // namespace rbs
