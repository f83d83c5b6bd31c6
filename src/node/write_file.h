// SPDX-License-Identifier: BSD-3-Clause
// Files that are written whole or not at all.
#pragma once

#include <string>

namespace rbs {

/// Replaces the file at `path` by one that holds `text`; it is on the disk when this returns. The text goes
/// to a new file beside it first, which then takes its name, so that whoever reads `path`, and whatever ends
/// this process, finds the old text or the new one. Throws std::runtime_error with the path and the reason;
/// the old file then stays.
void writeFile(const std::string& path, const std::string& text);

}  // namespace rbs
