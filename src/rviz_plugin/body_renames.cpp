// SPDX-License-Identifier: BSD-3-Clause
#include "body_renames.h"

#include <algorithm>
#include <string>
#include <unordered_map>
#include <unordered_set>

namespace rbs {

namespace {

using rigid_body_sim::BodyDescription;

bool isEqualButForTheName(BodyDescription before, const BodyDescription& now) {
  before.name = now.name;
  return before == now;
}

}  // namespace

// The same handle is the same body within a scene. A scene file that was edited and loaded again numbers its bodies
// otherwise: there the last names are still to be found, or the new ones were there before.
QHash<QString, QString> renamesOf(const rigid_body_sim::BodyDescriptions& before,
                                  const rigid_body_sim::BodyDescriptions& now) {
  QHash<QString, QString> new_names;
  if (now.scene != before.scene) return new_names;
  std::unordered_map<std::uint64_t, const BodyDescription*> bodies;
  std::unordered_set<std::string> names_before, names_now;
  for (const auto& body : before.bodies) bodies[body.id] = &body, names_before.insert(body.name);
  for (const auto& body : now.bodies) names_now.insert(body.name);
  const bool are_same_bodies =
      std::equal(before.bodies.begin(), before.bodies.end(), now.bodies.begin(), now.bodies.end(),
                 [](const BodyDescription& a, const BodyDescription& b) { return a.id == b.id; });
  for (const auto& body : now.bodies) {
    const auto known = bodies.find(body.id);
    if (known == bodies.end() || known->second->name == body.name) continue;
    const std::string& last_name = known->second->name;
    const bool is_new = names_now.count(last_name) == 0 && names_before.count(body.name) == 0;
    if (is_new || (are_same_bodies && isEqualButForTheName(*known->second, body)))
      new_names.insert(QString::fromStdString(last_name), QString::fromStdString(body.name));
  }
  return new_names;
}

}  // namespace rbs
