// SPDX-License-Identifier: BSD-3-Clause
#include "rigid_body_sim/file_access.h"

#include "rigid_body_sim/quote.h"
#include "rigid_body_sim/types.h"

#include <algorithm>
#include <filesystem>

namespace rbs {
namespace {

namespace fs = std::filesystem;

fs::path& root() {
  static fs::path folder;
  return folder;
}

std::function<bool()>& interruption() {
  static std::function<bool()> asked;
  return asked;
}

/// Whether `file`, all links followed, is in `folder` or below.
bool isIn(const fs::path& folder, const fs::path& file) {
  std::error_code error;
  const fs::path inner = fs::weakly_canonical(file, error);
  if (error) return false;
  const fs::path outer = fs::weakly_canonical(folder, error);
  if (error) return false;
  return std::mismatch(outer.begin(), outer.end(), inner.begin(), inner.end()).first == outer.end();
}

}  // namespace

void confineFilesTo(const std::string& folder) {
  if (folder.empty()) {
    root().clear();
    return;
  }
  std::error_code error;
  if (folder[0] != '/' || !fs::is_directory(folder, error)) {
    throw InvalidInput({{"file_root", quoted(folder), "the absolute path of a folder"}});
  }
  root() = fs::canonical(folder);
}

void requireAccess(const std::string& file, const std::string& path, const std::string& also) {
  if (root().empty() || isIn(root(), file) || (!also.empty() && isIn(also, file))) return;
  throw InvalidInput(
      {{path, quoted(file, kLongestPath), "a file in " + root().string() + ", which files are confined to"}});
}

void interruptReadingBy(std::function<bool()> interrupted) {
  interruption() = std::move(interrupted);
}

void stopIfInterrupted(const std::string& path) {
  if (interruption() && interruption()())
    throw InvalidInput({{path, "interrupted", "the time that it takes"}});
}

}  // namespace rbs
