// SPDX-License-Identifier: BSD-3-Clause
// Services that make, remove and change bodies.
#include "services.h"

#include "body_spec.h"
#include "convert.h"
#include "names.h"
#include "words.h"

#include <rigid_body_sim/MoveBody.h>
#include <rigid_body_sim/NamedBody.h>
#include <rigid_body_sim/ResizeBody.h>
#include <rigid_body_sim/SetBody.h>
#include <rigid_body_sim/SpawnBodies.h>
#include <rigid_body_sim/SpawnBody.h>
#include <std_srvs/Trigger.h>

#include <cmath>

namespace rbs {
namespace {

using rigid_body_sim::MoveBody;
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
  if (by_size == by_factor) throw InvalidInput({{"size and factor", "", "give one of them, and not zero"}});
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
  return words("'", request.name, "' is now: ", describe((*after.bodies)[after.find(id)]));
}

std::string move(World& world, const MoveBody::Request& request, MoveBody::Response&) {
  BodyEdit edit;
  edit.pose = fromMsg(request.pose);
  if (!request.keep_velocity) edit.twist = Twist{};
  world.editBody(bodyNamed(world, request.name), edit);
  return words("'", request.name, "' is at ", inWords(edit.pose->p_WB), " m",
               request.keep_velocity ? " and keeps its velocity" : ", at rest");
}

bool isEmpty(const BodyEdit& edit) {
  return !edit.twist && !edit.kind && !edit.mass && !edit.density && !edit.friction && !edit.restitution &&
         !edit.drag_coefficient && !edit.rolling_resistance && !edit.torsional_resistance && !edit.color &&
         !edit.group && !edit.mask;
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
  return words("'", request.name, "' is now: ", describe((*after.bodies)[after.find(id)]));
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
  offerEdit<Trigger>("clear", clear);
  offerEdit<ResizeBody>("resize_body", resize);
  offerEdit<MoveBody>("move_body", move);
  offerEdit<SetBody>("set_body", set);
}

}  // namespace rbs
