// SPDX-License-Identifier: BSD-3-Clause
#include "names.h"

#include "rigid_body_sim/quote.h"
#include "words.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace rbs {
namespace {

/// Levenshtein distance: how many characters must be added, removed or replaced to turn `a` into `b`.
/// `row[j]` holds the distance of the part of `a` seen so far to the first j characters of `b`.
std::size_t editDistance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0]++;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, diagonal + 1});
    }
  }
  return row.back();
}

/// The most similar name, where one is similar enough to have been meant; otherwise "".
std::string nearestName(const std::string& name, const std::vector<BodyDescription>& bodies) {
  constexpr std::size_t kLongestName = 64;
  if (name.empty() || name.size() > kLongestName) return "";
  std::string nearest;
  std::size_t least = 1 + std::max<std::size_t>(2, name.size() / 3);
  for (const BodyDescription& body : bodies) {
    const std::size_t distance = editDistance(name, body.name);
    if (distance >= least) continue;
    least = distance;
    nearest = body.name;
  }
  return nearest;
}

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
  const std::string nearest = nearestName(name, bodies);
  const std::string hint = nearest.empty() ? "" : "did you mean '" + nearest + "'?; ";
  const std::string known = bodies.empty() ? "the world has no bodies" : "bodies: " + someNames(bodies);
  throw InvalidInput({{name.empty() ? "name is missing" : "unknown body " + quoted(name), "", hint + known}});
}

FrameLookup& frameLookup() {
  static FrameLookup lookup;
  return lookup;
}

}  // namespace

BodyId bodyNamed(const World& world, const std::string& name) {
  const BodyId id = world.find(name);
  if (!id) refuseName(name, *world.snapshot().bodies);
  return id;
}

std::size_t indexNamed(const Snapshot& snapshot, const std::string& name) {
  const int index = snapshot.find(name);
  if (index < 0) refuseName(name, *snapshot.bodies);
  return index;
}

void findFramesBy(FrameLookup lookup) { frameLookup() = std::move(lookup); }

Pose frameNamed(const Snapshot& snapshot, const std::string& frame_id) {
  if (frame_id.empty() || frame_id == worldFrame()) return {};
  int index = snapshot.find(frame_id);
  const std::string& prefix = framePrefix();
  if (index < 0 && !prefix.empty() && frame_id.compare(0, prefix.size(), prefix) == 0) {
    index = snapshot.find(frame_id.substr(prefix.size()));
  }
  return index < 0 ? frameLookup()(frame_id) : snapshot.states[index].pose;
}

Pose frameNamed(const World& world, const std::string& frame_id) {
  if (frame_id.empty() || frame_id == worldFrame()) return {};
  return frameNamed(world.snapshot(), frame_id);
}

const Vec3& finiteVector(const Vec3& v, const std::string& path) {
  if (!v.allFinite()) throw InvalidInput({{path, inWords(v), "finite numbers"}});
  return v;
}

Pose compose(const Pose& X_WF, const Pose& X_FB) {
  return {X_WF.p_WB + X_WF.q_WB * X_FB.p_WB, X_WF.q_WB * X_FB.q_WB};
}

}  // namespace rbs
