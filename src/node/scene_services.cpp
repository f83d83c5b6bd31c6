// SPDX-License-Identifier: BSD-3-Clause
// Services that load and save.
#include "services.h"

#include "words.h"

#include <rigid_body_sim/File.h>
#include <rigid_body_sim/ListScenes.h>
#include <rigid_body_sim/LoadScene.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>

namespace rbs {
namespace {

using rigid_body_sim::File;
using rigid_body_sim::ListScenes;
using rigid_body_sim::LoadScene;

/// The path of a request: absolute, and ending in ".yaml".
std::string pathOf(const std::string& file) {
  if (file.empty() || file[0] != '/') throw InvalidInput({{"file", "'" + file + "'", "an absolute path"}});
  const std::string ending = ".yaml";
  const bool has_ending =
      file.size() > ending.size() && file.compare(file.size() - ending.size(), ending.size(), ending) == 0;
  return has_ending ? file : file + ending;
}

/// Writes the whole file or leaves the old one: the text goes to a file beside it first.
void writeFile(const std::string& path, const std::string& text) {
  const std::string part = path + ".part";
  std::ofstream stream(part);
  stream << text;
  stream.close();
  if (stream && std::rename(part.c_str(), path.c_str()) == 0) return;
  const std::string reason = std::strerror(errno);
  std::remove(part.c_str());
  throw InvalidInput({{path, reason, "a file in a folder that can be written"}});
}

std::string saveScene(Simulator& simulator, const std::string& path) {
  SceneDef scene;
  simulator.edit([&](World& world) { scene = world.capture(); });
  writeFile(path, writeScene(scene));
  return words("saved ", bodyCount(scene.bodies.size()), " to ", path);
}

std::string saveState(Simulator& simulator, const std::string& path) {
  SceneDef scene;
  SavedState state;
  simulator.edit([&](World& world) {
    scene = world.capture();
    state = world.captureState();
  });
  writeFile(path, writeScene(scene, state));
  return words("saved ", bodyCount(scene.bodies.size()), " at ", state.time, " s to ", path);
}

std::string loadedInWords(const Simulator& simulator) {
  const std::shared_ptr<const Snapshot> snapshot = simulator.snapshot();
  return words("loaded '", snapshot->scene, "': ", bodyCount(snapshot->bodies->size()));
}

}  // namespace

void Services::offerScenes() {
  offer<LoadScene>("load_scene", [this](const LoadScene::Request& request, LoadScene::Response&) {
    session_.loadScene(request.name);
    return loadedInWords(simulator_);
  });
  offer<File>("load_state", [this](const File::Request& request, File::Response&) {
    session_.loadState(pathOf(request.file));
    return loadedInWords(simulator_);
  });
  offer<File>("save_scene", [this](const File::Request& request, File::Response&) {
    return saveScene(simulator_, pathOf(request.file));
  });
  offer<File>("save_state", [this](const File::Request& request, File::Response&) {
    return saveState(simulator_, pathOf(request.file));
  });
  offer<ListScenes>("list_scenes", [this](const ListScenes::Request&, ListScenes::Response& response) {
    for (const SceneEntry& scene : listScenes(session_.folder())) {
      response.names.push_back(scene.name);
      response.properties.push_back(scene.property);
    }
    return words(response.names.size(), " scenes in ", session_.folder());
  });
}

}  // namespace rbs
