// SPDX-License-Identifier: BSD-3-Clause
// Files that are written whole or not at all.
#pragma once

#include <string>

namespace rbs {

/// Writes all of the text or nothing; it is on the disk when this returns. The text goes to a new file beside
/// `path`, with a name that cannot be foreseen, which then takes the name `path`: whoever reads `path`, and
/// whatever ends this process, finds the old text or the new one. A file that is there already stays as it is
/// unless `overwrite` is true. Throws InvalidInput with the path and the reason.
void writeFile(const std::string& path, const std::string& text, bool overwrite);

}  // namespace rbs
