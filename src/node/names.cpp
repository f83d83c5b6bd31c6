// SPDX-License-Identifier: BSD-3-Clause
#include "names.h"

#include "nearest.h"
#include "rigid_body_sim/quote.h"
#include "words.h"

#include <utility>

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

std::string withoutPrefix(const std::string& frame_id) {
  const std::string& prefix = framePrefix();
  return frame_id.compare(0, prefix.size(), prefix) == 0 ? frame_id.substr(prefix.size()) : frame_id;
}

[[noreturn]] void refuseName(const std::string& name, const std::string& field,
                             const std::vector<BodyDescription>& bodies) {
  std::vector<std::string> names;
  for (const BodyDescription& body : bodies) names.push_back(body.name);
  const std::string nearest = nearestName(withoutPrefix(name), names);
  const std::string hint = nearest.empty() ? "" : "did you mean '" + nearest + "'?; ";
  const std::string known = bodies.empty() ? "the world has no bodies" : "bodies: " + someNames(bodies);
  if (name.empty()) throw InvalidInput({{field, "empty", "the name of a body; " + known}});
  throw InvalidInput({{"unknown body " + quoted(name), "", hint + known}});
}

FrameLookup& frameLookup() {
  static FrameLookup lookup;
  return lookup;
}

}  // namespace

BodyId bodyNamed(const World& world, const std::string& name, const std::string& field) {
  const BodyId id = world.find(name);
  if (!id) refuseName(name, field, *world.bodies());
  return id;
}

BodyId bodyOfFrame(const World& world, const std::string& frame_id, const std::string& field) {
  const BodyId id = world.find(frame_id);
  return id ? id : bodyNamed(world, withoutPrefix(frame_id), field);
}

std::size_t indexNamed(const Snapshot& snapshot, const std::string& name, const std::string& field) {
  const int index = snapshot.find(name);
  if (index < 0) refuseName(name, field, *snapshot.bodies);
  return index;
}

void findFramesBy(FrameLookup lookup) {
  frameLookup() = std::move(lookup);
}

Pose frameNamed(const Snapshot& snapshot, const std::string& frame_id) {
  if (frame_id.empty() || frame_id == worldFrame()) return {};
  int index = snapshot.find(frame_id);
  if (index < 0) index = snapshot.find(withoutPrefix(frame_id));
  return index < 0 ? frameLookup()(frame_id) : snapshot.states[index].pose;
}

Pose frameNamed(const World& world, const std::string& frame_id) {
  if (frame_id.empty() || frame_id == worldFrame()) return {};
  BodyId id = world.find(frame_id);
  if (!id) id = world.find(withoutPrefix(frame_id));
  return id ? world.pose(id) : frameLookup()(frame_id);
}

const Vec3& finiteVector(const Vec3& v, const std::string& path) {
  if (!v.allFinite())
    throw InvalidInput({{path, words('[', v.x(), ", ", v.y(), ", ", v.z(), ']'), "finite numbers"}});
  return v;
}

const Quat& finiteOrientation(const Quat& q, const std::string& path) {
  if (!q.coeffs().allFinite())
    throw InvalidInput(
        {{path, words('[', q.x(), ", ", q.y(), ", ", q.z(), ", ", q.w(), ']'), "finite numbers x, y, z, w"}});
  return q;
}

Pose compose(const Pose& X_WF, const Pose& X_FB) {
  return {X_WF.p_WB + X_WF.q_WB * X_FB.p_WB, X_WF.q_WB * X_FB.q_WB};
}

}  // namespace rbs
