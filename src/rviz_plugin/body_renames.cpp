// SPDX-License-Identifier: BSD-3-Clause
#include "body_renames.h"

#include <string>
#include <unordered_map>
#include <unordered_set>

namespace rbs {

// The same handle is the same body within a scene. A scene file that was edited and loaded again numbers its bodies
// otherwise: there the last names are still to be found, or the new ones were there before.
QHash<QString, QString> renamesOf(const rigid_body_sim::BodyDescriptions& before,
                                  const rigid_body_sim::BodyDescriptions& now) {
  QHash<QString, QString> new_names;
  if (now.scene != before.scene) return new_names;
  std::unordered_map<std::uint64_t, std::string> names;
  std::unordered_set<std::string> names_before, names_now;
  for (const auto& body : before.bodies) names[body.id] = body.name, names_before.insert(body.name);
  for (const auto& body : now.bodies) names_now.insert(body.name);
  for (const auto& body : now.bodies) {
    const auto known = names.find(body.id);
    if (known == names.end() || names_now.count(known->second) > 0 || names_before.count(body.name) > 0)
      continue;
    new_names.insert(QString::fromStdString(known->second), QString::fromStdString(body.name));
  }
  return new_names;
}

}  // namespace rbs
