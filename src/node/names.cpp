// SPDX-License-Identifier: BSD-3-Clause
#include "names.h"

#include "convert.h"
#include "nearest.h"

namespace rbs {
namespace {

/// The first few names, and how many more there are.
std::string someNames(const std::vector<BodyDescription>& bodies) {
  constexpr std::size_t kShown = 10;
  std::string list;
  for (std::size_t i = 0; i < bodies.size() && i < kShown; ++i) {
    list += (i == 0 ? "" : ", ") + bodies[i].name;
  }
  if (bodies.size() > kShown) list += " and " + std::to_string(bodies.size() - kShown) + " more";
  return list;
}

[[noreturn]] void refuseName(const std::string& name, const std::vector<BodyDescription>& bodies) {
  std::vector<std::string> names;
  for (const BodyDescription& body : bodies) names.push_back(body.name);
  const std::string nearest = nearestName(name, names);
  const std::string hint = nearest.empty() ? "" : "did you mean '" + nearest + "'?; ";
  const std::string known = bodies.empty() ? "the world has no bodies" : "bodies: " + someNames(bodies);
  throw InvalidInput({{name.empty() ? "name is missing" : "unknown body '" + name + "'", "", hint + known}});
}

}  // namespace

BodyId bodyNamed(const World& world, const std::string& name) {
  const BodyId id = world.find(name);
  if (!id) refuseName(name, *world.bodies());
  return id;
}

std::size_t indexNamed(const Snapshot& snapshot, const std::string& name) {
  const int index = snapshot.find(name);
  if (index < 0) refuseName(name, *snapshot.bodies);
  return index;
}

Pose frameNamed(const Snapshot& snapshot, const std::string& frame_id) {
  if (frame_id.empty() || frame_id == kWorldFrame) return {};
  return snapshot.states[indexNamed(snapshot, frame_id)].pose;
}

Pose frameNamed(const World& world, const std::string& frame_id) {
  if (frame_id.empty() || frame_id == kWorldFrame) return {};
  return world.pose(bodyNamed(world, frame_id));
}

Pose compose(const Pose& X_WF, const Pose& X_FB) {
  return {X_WF.p_WB + turned(X_WF.q_WB, X_FB.p_WB), X_WF.q_WB * X_FB.q_WB};
}

}  // namespace rbs
