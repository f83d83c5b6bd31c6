// SPDX-License-Identifier: BSD-3-Clause
#include "request_paths.h"

#include "rigid_body_sim/file_access.h"
#include "rigid_body_sim/quote.h"
#include "rigid_body_sim/types.h"

#include <filesystem>

namespace rbs {
namespace {

namespace fs = std::filesystem;

const std::string kEnding = ".yaml";

bool endsInYaml(const std::string& file) {
  const std::string ending = fs::path(file).extension().string();
  return ending == kEnding || ending == ".yml";
}

[[noreturn]] void refuse(const std::string& file, const std::string& allowed) {
  throw InvalidInput({{"file", quoted(file, kLongestPath), allowed}});
}

void requirePath(const std::string& file) {
  if (file.empty() || file[0] != '/') refuse(file, "an absolute path");
  if (printable(file, std::string::npos) != file) refuse(file, "a path in UTF-8 without control characters");
}

}  // namespace

std::string yamlPath(const std::string& file) {
  requirePath(file);
  std::error_code error;
  if (file.back() == '/' || fs::is_directory(file, error)) refuse(file, "a file: this is a folder");
  const std::string path = endsInYaml(file) ? file : file + kEnding;
  requireAccess(path, "file");
  return path;
}

void requireSceneName(const std::string& name_or_file) {
  const bool is_path = name_or_file.find('/') != std::string::npos || endsInYaml(name_or_file);
  if (is_path && name_or_file[0] != '/') refuse(name_or_file, "a name of the catalogue, or an absolute path");
  if (is_path) requirePath(name_or_file);
}

}  // namespace rbs
