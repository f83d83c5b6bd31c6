// SPDX-License-Identifier: BSD-3-Clause
// Services that load and save.
#include "services.h"

#include "request_paths.h"
#include "words.h"
#include "write_file.h"

#include <rigid_body_sim/File.h>
#include <rigid_body_sim/ListScenes.h>
#include <rigid_body_sim/LoadScene.h>
#include <rigid_body_sim/LoadSceneWithSeed.h>

namespace rbs {
namespace {

using rigid_body_sim::File;
using rigid_body_sim::ListScenes;
using rigid_body_sim::LoadScene;
using rigid_body_sim::LoadSceneWithSeed;

std::string saveScene(Simulator& simulator, const File::Request& request) {
  const std::string path = yamlPath(request.file);
  const auto [world, snapshot] = simulator.copy();
  const SceneDef scene = world.capture();
  writeFile(path, writeScene(scene), request.overwrite);
  simulator.markSaved(snapshot->revision);
  return words("saved ", bodyCount(scene.bodies.size()), " to ", path);
}

std::string saveState(Simulator& simulator, const File::Request& request) {
  const std::string path = yamlPath(request.file);
  const auto [world, snapshot] = simulator.copy();
  const SceneDef scene = world.capture();
  const SavedState state = world.captureState();
  writeFile(path, writeScene(scene, state), request.overwrite);
  simulator.markSaved(snapshot->revision);
  return words("saved ", bodyCount(scene.bodies.size()), " at ", state.time, " s to ", path);
}

std::string loadedInWords(const SceneDef& scene) {
  return words("loaded '", scene.name, "': ", bodyCount(scene.bodies.size()));
}

std::string loadScene(Session& session, const std::string& name,
                      const std::optional<std::uint64_t>& seed = std::nullopt) {
  requireSceneName(name);
  const SceneFile loaded = session.loadScene(name, seed);
  return loadedInWords(loaded.scene) +
         (loaded.state ? ", without the saved state of the file: load_state continues from it" : "");
}

}  // namespace

void Services::offerScenes() {
  offer<LoadScene>("load_scene", [this](const LoadScene::Request& request, LoadScene::Response&) {
    return loadScene(session_, request.name);
  });
  offer<LoadSceneWithSeed>("load_scene_with_seed",
                           [this](const LoadSceneWithSeed::Request& request, LoadSceneWithSeed::Response&) {
                             return loadScene(session_, request.name, request.seed);
                           });
  offer<File>("load_state", [this](const File::Request& request, File::Response&) {
    return loadedInWords(session_.loadState(yamlPath(request.file)).scene);
  });
  offer<File>("save_scene", [this](const File::Request& request, File::Response&) {
    return saveScene(simulator_, request);
  });
  offer<File>("save_state", [this](const File::Request& request, File::Response&) {
    return saveState(simulator_, request);
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
