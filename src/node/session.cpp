// SPDX-License-Identifier: BSD-3-Clause
#include "session.h"

#include <malloc.h>

namespace rbs {
namespace {

// The allocator keeps the memory of a large scene for good, unless malloc_trim() gives it back.
void giveBackMemory() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

}  // namespace

Session::Session(const Options& options)
    : Session(options, read(options, findScene(options.folder, options.scene))) {}

SceneDef Session::read(const Options& options, const std::string& file) {
  SceneDef scene = readScene(file, options.seed).scene;
  if (options.fidelity) scene.fidelity = *options.fidelity, scene.goal.reset();
  return scene;
}

Session::Session(const Options& options, SceneDef first)
    : options_(options), simulator_(std::move(first), options.run), timeline_(options.wall_stamps) {}

void Session::loadScene(const std::string& name_or_file) {
  const std::string file = findScene(options_.folder, name_or_file);
  replace({read(options_, file), std::nullopt}, file);
}

void Session::loadState(const std::string& file) {
  SceneFile saved = readScene(file);
  if (!saved.state) throw InvalidInput({{file, "", "holds a scene but no saved state: use load_scene"}});
  replace(saved, file);
}

void Session::replace(const SceneFile& file, const std::string& text) {
  simulator_.load(file.scene, file.state);
  noteReplacement("loaded", text);
  giveBackMemory();
}

void Session::reset() {
  simulator_.reset();
  noteReplacement("reset", "");
}

std::string Session::undo() {
  const std::string what = simulator_.undo();
  noteReplacement("undone", what);
  return what;
}

std::string Session::redo() {
  const std::string what = simulator_.redo();
  noteReplacement("redone", what);
  return what;
}

void Session::noteReplacement(const std::string& kind, const std::string& text) {
  timeline_.note({kind, text});
  std::lock_guard<std::mutex> lock(mutex_);
  turned_off_.reset();
}

bool Session::hasOwnAir() const {
  return simulator_.loaded()->air.has_value();
}

Wind Session::usualWind() const {
  std::lock_guard<std::mutex> lock(mutex_);
  return turned_off_.value_or(simulator_.loaded()->wind.value_or(Wind{}));
}

void Session::setUsualWind(const Wind& wind) {
  std::lock_guard<std::mutex> lock(mutex_);
  turned_off_ = wind;
}

}  // namespace rbs
