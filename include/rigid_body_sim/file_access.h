// SPDX-License-Identifier: BSD-3-Clause
// Which files may be read and written, and when reading ends early. Set once, before any thread reads a file.
#pragma once

#include <functional>
#include <string>

namespace rbs {

/// Confines files to this folder and those below it, wherever links lead; "" lifts that. findScene(),
/// readMesh() and requireAccess() obey it. readScene() does not check: pass it what findScene() returned.
/// Scenes of the catalogue, meshes beside a scene and meshes of packages may be read all the same. Throws
/// InvalidInput unless `folder` is the absolute path of a folder.
void confineFilesTo(const std::string& folder);

/// Throws InvalidInput with `path` where `file` is outside of the folder of confineFilesTo(), and of the
/// folder `also` unless that is empty.
void requireAccess(const std::string& file, const std::string& path, const std::string& also = "");

/// Sets the function that ends reading early. readScene(), readMesh() and makeHull() call it now and then,
/// from any thread, and throw InvalidInput once it returns true. An empty function never ends anything.
void interruptReadingBy(std::function<bool()> interrupted);

/// Throws InvalidInput with `path` if the function of interruptReadingBy() returns true.
void stopIfInterrupted(const std::string& path);

}  // namespace rbs
