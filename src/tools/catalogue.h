// SPDX-License-Identifier: BSD-3-Clause
// Where the catalogue of scenes is, for programs that run without a node.
#pragma once

#include <filesystem>
#include <string>

namespace rbs {

/// Beside this program where it is installed; else in the source folder, `from_source`.
inline std::string catalogueFolder(const std::string& from_source) {
  std::error_code error;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error);
  const std::filesystem::path installed = program.parent_path() / "../../share/rigid_body_sim/scenes";
  return std::filesystem::is_directory(installed, error) ? installed.lexically_normal().string()
                                                         : from_source;
}

}  // namespace rbs
