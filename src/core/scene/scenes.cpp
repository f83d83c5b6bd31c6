// SPDX-License-Identifier: BSD-3-Clause
// The catalogue of named scenes: a folder of scene files.
#include "rigid_body_sim/scenes.h"
#include "base/number_text.h"
#include "rigid_body_sim/file_access.h"
#include "rigid_body_sim/quote.h"

#include <algorithm>
#include <filesystem>

namespace rbs {
namespace {

namespace fs = std::filesystem;

constexpr const char* kExtension = ".yaml";

/// Base names of the scene files in a folder, in alphabetic order.
std::vector<std::string> sceneNames(const std::string& folder) {
  std::error_code error;
  std::vector<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    if (entry.path().extension() == kExtension) names.push_back(entry.path().stem().string());
  }
  if (error) throw InvalidInput({{folder, error.message(), "the folder of the scenes"}});
  std::sort(names.begin(), names.end());
  return names;
}

std::string fileOf(const std::string& folder, const std::string& name) {
  return (fs::path(folder) / (name + kExtension)).string();
}

/// A faulty file of the catalogue says so in the place of its property and hides no other scene.
std::string propertyOf(const std::string& file) {
  try {
    return readScene(file).scene.property;
  } catch (const InvalidInput& error) {
    return std::string("faulty: ") + error.what();
  }
}

bool isPath(const std::string& name_or_file) {
  const std::string ending = fs::path(name_or_file).extension().string();
  return name_or_file.find('/') != std::string::npos || ending == kExtension || ending == ".yml";
}

/// The path, or with ".yaml" where only that exists, as the services that save a file add it.
std::string existingFile(const std::string& path) {
  std::error_code error;
  return !fs::exists(path, error) && fs::exists(path + kExtension, error) ? path + kExtension : path;
}

}  // namespace

std::vector<SceneEntry> listScenes(const std::string& folder) {
  std::vector<SceneEntry> entries;
  for (const std::string& name : sceneNames(folder))
    entries.push_back({name, propertyOf(fileOf(folder, name))});
  return entries;
}

std::string findScene(const std::string& folder, const std::string& name_or_file) {
  if (isPath(name_or_file)) {
    const std::string file = existingFile(name_or_file);
    requireAccess(file, "file");
    return file;
  }
  const std::vector<std::string> names = sceneNames(folder);
  if (std::find(names.begin(), names.end(), name_or_file) != names.end()) return fileOf(folder, name_or_file);

  std::string known;
  for (const std::string& name : names) known += (known.empty() ? "scenes: " : ", ") + name;
  const std::string near = nearestName(name_or_file, names);
  throw InvalidInput({{"unknown scene " + quoted(name_or_file), "",
                       (near.empty() ? "" : "did you mean '" + near + "'? ") + known}});
}

}  // namespace rbs
