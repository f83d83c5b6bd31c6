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
    : Session(options, read(options, findScene(options.folder, options.scene)).scene) {}

SceneFile Session::read(const Options& options, const std::string& file) {
  SceneFile read = readScene(file, options.seed);
  if (options.fidelity) read.scene.fidelity = *options.fidelity, read.scene.goal.reset();
  return read;
}

Session::Session(const Options& options, SceneDef first)
    : options_(options), simulator_(std::move(first), options.run), timeline_(options.wall_stamps) {}

SceneFile Session::loadScene(const std::string& name_or_file, const std::optional<std::uint64_t>& seed) {
  const std::string file = findScene(options_.folder, name_or_file);
  Options options = options_;
  if (seed) options.seed = seed;
  SceneFile loaded = read(options, file);
  replace({loaded.scene, std::nullopt}, file);
  return loaded;
}

SceneFile Session::loadState(const std::string& file) {
  SceneFile saved = readScene(file);
  if (!saved.state) throw InvalidInput({{file, "", "holds a scene but no saved state: open it as a scene"}});
  // Those of a checkpoint: the hand that held a body then holds it no longer.
  saved.state->grabs.clear();
  saved.state->holds.clear();
  replace(saved, file);
  return saved;
}

void Session::replace(const SceneFile& file, const std::string& text) {
  simulator_.load(file.scene, file.state);
  timeline_.note({"loaded", text});
  forgetWind();
  giveBackMemory();
}

void Session::reset() {
  simulator_.reset();
  timeline_.note({"reset", ""});
  forgetWind();
}

std::string Session::undo() {
  return goBack("undone", &Simulator::undo);
}

std::string Session::redo() {
  return goBack("redone", &Simulator::redo);
}

std::string Session::goBack(const std::string& kind, std::string (Simulator::*go)()) {
  const auto before = simulator_.loaded();
  const std::string what = (simulator_.*go)();
  timeline_.note({kind, what});
  if (simulator_.loaded() != before) forgetWind();
  return what;
}

void Session::forgetWind() {
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
