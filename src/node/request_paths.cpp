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

[[noreturn]] void refuse(const char* field, const std::string& value, const std::string& allowed) {
  throw InvalidInput({{field, quoted(value, kLongestPath), allowed}});
}

void requirePath(const char* field, const std::string& path, const char* allowed) {
  if (path.empty() || path[0] != '/') refuse(field, path, allowed);
  if (printable(path, std::string::npos) != path)
    refuse(field, path, "a path in UTF-8 without control characters");
}

}  // namespace

std::string yamlPath(const std::string& file) {
  requirePath("file", file, "an absolute path");
  std::error_code error;
  if (file.back() == '/' || fs::is_directory(file, error)) refuse("file", file, "a file: this is a folder");
  const std::string path = endsInYaml(file) ? file : file + kEnding;
  requireAccess(path, "file");
  return path;
}

void requireSceneName(const std::string& name_or_file) {
  const bool is_path = name_or_file.find('/') != std::string::npos || endsInYaml(name_or_file);
  if (is_path) requirePath("name", name_or_file, "a name of the catalogue, or an absolute path");
}

}  // namespace rbs
