// SPDX-License-Identifier: BSD-3-Clause
// The parts behind the interface of World.
#pragma once

#include "rigid_body_sim/commands.h"
#include "rigid_body_sim/world.h"
#include "state/context.h"
#include "step/analyse_scene.h"
#include "step/pipeline.h"
#include "step/sleep.h"

#include <algorithm>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <vector>

namespace rbs {

struct World::Impl {
  SceneStore scene;
  StepStore step;
  SceneAnalysis analysis;
  Pipeline pipeline;
  std::uint64_t next_serial = 1;
  std::uint64_t edits = 0;
  std::uint64_t description_version = 0;
  // By the stem of a name: the numbers up to this one have bodies. Dropped when a name is given up.
  std::unordered_map<std::string, std::uint64_t> numbers_taken;
  mutable std::shared_ptr<const std::vector<BodyDescription>> descriptions;
  std::function<void(const Command&)> journal;

  // To be called after a change from outside; `command` makes the command.
  template <class Make>
  void record(const Make& command) const {
    if (journal) journal({command()});
  }

  Index require(BodyId id) const {
    const Index i = scene.bodies.indexOf(id);
    if (i == kNone) throw InvalidInput({{"body", std::to_string(id.serial), "a body of this world"}});
    return i;
  }

  // To be called after every edit; `described` when a description changed. `changed` lists the bodies that
  // the edit was about, besides those it appended, where it was about nothing else.
  void edited(bool described, const std::optional<std::vector<Index>>& changed = std::nullopt) {
    ++edits;
    scene.just_edited = true;
    if (described) descriptionsChanged();
    begunAnew(changed);
  }

  void descriptionsChanged() {
    ++description_version;
    descriptions.reset();
  }

  // To be called when what the stages go by has changed.
  void begunAnew(const std::optional<std::vector<Index>>& changed = std::nullopt) {
    const bool some_rest = !scene.rest.empty();
    sleep::wakeAll(scene);
    changed && !some_rest ? adopt(analyseScene(scene, *changed)) : recount();
  }

  void recount() { adopt(analyseScene(scene)); }

  void adopt(SceneAnalysis now) {
    if (now == analysis) return;
    analysis = std::move(now);
    pipeline.filter(analysis);
  }

  void letGo(BodyId id) {
    const auto ofBody = [id](const auto& pull) { return pull.body == id; };
    scene.grabs.erase(std::remove_if(scene.grabs.begin(), scene.grabs.end(), ofBody), scene.grabs.end());
    scene.holds.erase(std::remove_if(scene.holds.begin(), scene.holds.end(), ofBody), scene.holds.end());
  }

  // A force at a point of the body, and a torque, from now on. Throws InvalidInput.
  TimedWrench wrenchOf(BodyId id, const Vec3& force_W, const Vec3& torque_W, const Vec3& point_W,
                       double seconds) const;
  void release(Index i);
  // Sets a part of the settings, as an edit. Throws InvalidInput.
  template <class Part, class Make>
  void change(Part SceneDef::*part, const Part& value, const Make& command);
  void advance(double to);
  std::string freeName(const Shape& shape, const std::unordered_set<std::string>& taken);
  void nameBodies(std::vector<BodyDef>& bodies);
};

}  // namespace rbs
