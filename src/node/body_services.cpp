// SPDX-License-Identifier: BSD-3-Clause
// Services that make, remove and change bodies.
#include "services.h"

#include "body_spec.h"
#include "convert.h"
#include "duplicate.h"
#include "names.h"
#include "words.h"

#include <rigid_body_sim/DuplicateBodies.h>
#include <rigid_body_sim/EditBodies.h>
#include <rigid_body_sim/MoveBody.h>
#include <rigid_body_sim/NamedBodies.h>
#include <rigid_body_sim/NamedBody.h>
#include <rigid_body_sim/ResizeBody.h>
#include <rigid_body_sim/SetBody.h>
#include <rigid_body_sim/SpawnBodies.h>
#include <rigid_body_sim/SpawnBody.h>
#include <std_srvs/Trigger.h>

#include <algorithm>
#include <cmath>

namespace rbs {
namespace {

using rigid_body_sim::BodyChange;
using rigid_body_sim::DuplicateBodies;
using rigid_body_sim::EditBodies;
using rigid_body_sim::MoveBody;
using rigid_body_sim::NamedBodies;
using rigid_body_sim::NamedBody;
using rigid_body_sim::ResizeBody;
using rigid_body_sim::SetBody;
using rigid_body_sim::SpawnBodies;
using rigid_body_sim::SpawnBody;
using std_srvs::Trigger;

/// What became of a request to spawn, and what it left to the simulator.
std::string spawnMessage(const SpawnBody::Request& request, const Snapshot& snapshot, std::size_t index) {
  const BodyDescription& body = (*snapshot.bodies)[index];
  std::string message = words("spawned '", body.name, "' at ", inWords(snapshot.states[index].pose.p_WB),
                              " m: ", describe(body));
  std::string assumed;
  if (std::holds_alternative<Plane>(body.shape)) {
    if (isZero(request.pose)) message += "; assumed: through the origin, level";
    return message;
  }
  if (isZero(request.pose)) assumed += ", the first free place above the origin";
  if (isZero(request.size) && request.shape != "hull") assumed += ", the size";
  if (request.mass == 0.0 && request.density == 0.0) assumed += words(", density ", body.density, " kg/m^3");
  return assumed.empty() ? message : message + "; assumed: " + assumed.substr(2);
}

std::string spawnOne(World& world, const SpawnPlan& plan, const SpawnBody::Request& request,
                     SpawnBody::Response& response) {
  const BodyId id = world.addBody(plan.bodiesIn(world).front());
  const Snapshot snapshot = world.snapshot();
  const std::size_t index = snapshot.find(id);
  response.name = (*snapshot.bodies)[index].name;
  return spawnMessage(request, snapshot, index);
}

std::string spawnMany(World& world, const SpawnPlan& plan, SpawnBodies::Response& response) {
  const std::vector<BodyId> ids = world.addBodies(plan.bodiesIn(world));
  const Snapshot snapshot = world.snapshot();
  for (const BodyId id : ids) response.names.push_back((*snapshot.bodies)[snapshot.find(id)].name);
  return "spawned " + bodyCount(ids.size());
}

std::string remove(World& world, const NamedBody::Request& request, NamedBody::Response&) {
  world.removeBody(bodyNamed(world, request.name));
  return "deleted '" + request.name + "'";
}

std::string clear(World& world, const Trigger::Request&, Trigger::Response&) {
  const std::size_t count = world.snapshot().bodies->size();
  world.clear();
  return "deleted " + bodyCount(count);
}

/// The new shape of a body: either new extents, of which a zero one stays, or a multiple of the old shape.
Shape resizedShape(const Shape& shape, const ResizeBody::Request& request) {
  const bool by_size = !isZero(request.size), by_factor = request.factor != 0.0;
  if (by_size == by_factor)
    throw InvalidInput({{"size and factor", by_size ? "both" : "neither", "one of them, not zero"}});
  if (by_size) return resized(shape, fromMsg(request.size), "body");
  if (std::holds_alternative<Plane>(shape))
    throw InvalidInput({{"shape", "plane", "any other: a plane has no size"}});
  if (!(request.factor > 0.0) || !std::isfinite(request.factor)) {
    throw InvalidInput({{"factor", words(request.factor), "a finite number above 0"}});
  }
  return scaled(shape, request.factor);
}

std::string resize(World& world, const ResizeBody::Request& request, ResizeBody::Response&) {
  const BodyId id = bodyNamed(world, request.name);
  const Snapshot before = world.snapshot();
  BodyEdit edit;
  edit.shape = resizedShape((*before.bodies)[before.find(id)].shape, request);
  world.editBody(id, edit);
  const Snapshot after = world.snapshot();
  return words("resized '", request.name, "': ", describe((*after.bodies)[after.find(id)]));
}

std::string move(World& world, const MoveBody::Request& request, MoveBody::Response&) {
  BodyEdit edit;
  edit.pose = fromMsg(request.pose);
  if (!request.keep_velocity) edit.twist = Twist{};
  world.editBody(bodyNamed(world, request.name), edit);
  return words("moved '", request.name, "' to ", inWords(edit.pose->p_WB), " m",
               request.keep_velocity ? " and keeps its velocity" : ", at rest");
}

std::string set(World& world, const SetBody::Request& request, SetBody::Response&) {
  const BodyId id = bodyNamed(world, request.name);
  const BodyEdit edit = editFrom(request);
  if (isEmpty(edit)) {
    throw InvalidInput({{"nothing to change", "",
                         "give mass or density, twist, kind, collision group or mask, material or color"}});
  }
  world.editBody(id, edit);
  const Snapshot after = world.snapshot();
  return words("changed '", request.name, "': ", describe((*after.bodies)[after.find(id)]));
}

/// Runs one edit of a body; its errors are about "body", and become errors about `path`.
template <class Edit>
void inPath(const std::string& path, Edit edit) {
  try {
    edit();
  } catch (const InvalidInput& refusal) {
    std::vector<Problem> problems = refusal.problems();
    for (Problem& problem : problems)
      if (problem.path.compare(0, 4, "body") == 0) problem.path.replace(0, 4, path);
    throw InvalidInput(problems);
  }
}

std::string editMany(World& world, const EditBodies::Request& request, EditBodies::Response&) {
  const std::vector<BodyChange>& changes = request.changes;
  std::vector<std::string> names;
  for (const BodyChange& change : changes) names.push_back(change.name);
  const auto before = world.bodies();
  const std::vector<std::size_t> indices = indicesNamed(world, names, "changes");
  for (std::size_t k = 0; k < changes.size(); ++k) {
    const std::string path = words("changes[", k, "] ('", names[k], "')");
    const BodyDescription& body = (*before)[indices[k]];
    const BodyEdit edit = editFrom(changes[k], body.shape, path);
    if (isEmpty(edit)) throw InvalidInput({{path, "nothing to change", "at least one property"}});
    inPath(path, [&] { world.editBody(body.id, edit); });
  }
  return changes.size() == 1 ? "changed '" + names[0] + "'" : "changed " + bodyCount(changes.size());
}

std::string removeMany(World& world, const NamedBodies::Request& request, NamedBodies::Response&) {
  const auto before = world.bodies();
  for (const std::size_t i : indicesNamed(world, request.names)) world.removeBody((*before)[i].id);
  return request.names.size() == 1 ? "deleted '" + request.names[0] + "'"
                                   : "deleted " + bodyCount(request.names.size());
}

std::string duplicateMany(World& world, const DuplicateBodies::Request& request,
                          DuplicateBodies::Response& response) {
  const std::vector<BodyId> ids =
      duplicate(world, request.names, std::max(request.count, 1u), fromMsg(request.offset));
  const auto bodies = world.bodies();
  for (std::size_t i = bodies->size() - ids.size(); i < bodies->size(); ++i)
    response.names.push_back((*bodies)[i].name);
  return "added " + words(ids.size(), ids.size() == 1 ? " copy" : " copies");
}

}  // namespace

void Services::offerBodyEdits() {
  // Meshes are read on the thread of the service: the simulation goes on meanwhile.
  offer<SpawnBody>("spawn_body", [this](const SpawnBody::Request& request, SpawnBody::Response& response) {
    const SpawnPlan plan(request);
    return simulator_.apply([&](World& world) { return spawnOne(world, plan, request, response); });
  });
  offer<SpawnBodies>(
      "spawn_bodies", [this](const SpawnBodies::Request& request, SpawnBodies::Response& response) {
        const SpawnPlan plan(request.bodies);
        return simulator_.apply([&](World& world) { return spawnMany(world, plan, response); });
      });
  offerEdit<NamedBody>("delete_body", remove);
  offerEdit<NamedBodies>("delete_bodies", removeMany);
  offerEdit<DuplicateBodies>("duplicate_bodies", duplicateMany);
  offerEdit<EditBodies>("edit_bodies", editMany);
  offerEdit<Trigger>("clear", clear);
  offerEdit<ResizeBody>("resize_body", resize);
  offerEdit<MoveBody>("move_body", move);
  offerEdit<SetBody>("set_body", set);
}

}  // namespace rbs
