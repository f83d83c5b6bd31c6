// SPDX-License-Identifier: BSD-3-Clause
// Paths in requests: what a file may be called.
#pragma once

#include <string>

namespace rbs {

/// The path of a request, with ".yaml" added where neither that nor ".yml" is there. Throws InvalidInput for one that is not
/// absolute, names a folder, holds control characters or no UTF-8, or is excluded by confineFilesTo().
std::string yamlPath(const std::string& file);

/// Throws InvalidInput unless `name_or_file` is a name, or an absolute path that yamlPath() would take.
void requireSceneName(const std::string& name_or_file);

}  // namespace rbs
