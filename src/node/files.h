// SPDX-License-Identifier: BSD-3-Clause
// Files of requests: what a path may be, and writing one whole.
#pragma once

#include <string>

namespace rbs {

/// The path of a request, with ".yaml" added where it is missing. Throws InvalidInput for one that is not
/// absolute, names a folder, holds control characters or no UTF-8, or is excluded by confineFilesTo().
std::string yamlPath(const std::string& file);

/// Throws InvalidInput unless `name_or_file` is a name, or an absolute path that yamlPath() would take.
void requireSceneName(const std::string& name_or_file);

/// Writes all of the text or nothing, on the disk when it returns: to a file with a name of its own beside
/// `path`, which then takes its place. A file that is there already stays as it is unless `overwrite` is
/// true. Throws InvalidInput with the reason.
void writeFile(const std::string& path, const std::string& text, bool overwrite);

}  // namespace rbs
