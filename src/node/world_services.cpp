// SPDX-License-Identifier: BSD-3-Clause
// Services that change the air, gravity and effects, and services that read bodies.
#include "services.h"

#include "convert.h"
#include "names.h"
#include "rigid_body_sim/modelling_error.h"
#include "rigid_body_sim/quote.h"
#include "words.h"

#include <rigid_body_sim/GetBody.h>
#include <rigid_body_sim/ListBodies.h>
#include <rigid_body_sim/SetEffects.h>
#include <rigid_body_sim/SetGravity.h>
#include <rigid_body_sim/SetWind.h>
#include <std_srvs/SetBool.h>
#include <std_srvs/Trigger.h>

#include <set>

namespace rbs {
namespace {

using rigid_body_sim::GetBody;
using rigid_body_sim::ListBodies;
using rigid_body_sim::SetEffects;
using rigid_body_sim::SetGravity;
using rigid_body_sim::SetWind;
using std_srvs::SetBool;

/// Throws InvalidInput for a wind that a scene would not take.
void check(const Wind& wind) {
  SceneDef scene;
  scene.air = Air{};
  scene.wind = wind;
  const std::vector<Problem> problems = validate(scene);
  if (!problems.empty()) throw InvalidInput(problems);
}

/// Switches the wind on, and adds air where there is none. Returns the reply in words.
std::string startWind(World& world, const Wind& wind) {
  check(wind);
  const bool has_air = world.scene().air.has_value();
  if (!has_air) world.setAir(Air{});
  world.setWind(wind);
  return words("wind on: ", describe(world.snapshot().air),
               has_air ? "" : "; air was added, because the scene had none");
}

/// Switches the wind off, and removes the air where the scene itself has none.
std::string stopWind(World& world, bool own_air) {
  if (own_air) {
    world.setWind(std::nullopt);
  } else {
    world.setAir(std::nullopt);
  }
  return words("wind off: ", describe(world.snapshot().air),
               own_air ? "" : ", because the scene has none of its own");
}

std::string enableWind(Session& session, bool on) {
  return session.simulator().apply([&](World& world) {
    const std::optional<Wind> wind = world.scene().wind;
    if (wind) session.setUsualWind(*wind);
    return on ? startWind(world, session.usualWind()) : stopWind(world, session.hasOwnAir());
  });
}

std::string setWind(World& world, const SetWind::Request& request, SetWind::Response&) {
  return startWind(world, Wind{fromMsg(request.velocity), request.gust});
}

std::string setGravity(World& world, const SetGravity::Request& request, SetGravity::Response&) {
  world.setGravity(fromMsg(request.gravity));
  return words("set gravity to ", inWords(world.scene().gravity), " m/s^2");
}

/// The overrides that a request leaves. Throws InvalidInput for an unknown effect, or one named twice.
EffectOverrides overridden(EffectOverrides effects, const SetEffects::Request& request) {
  std::set<Effect> named;
  const auto take = [&](const std::vector<std::string>& names) {
    std::vector<Effect> list;
    for (const std::string& name : names) {
      list.push_back(effectNamed(name));
      if (!named.insert(list.back()).second)
        throw InvalidInput({{"effect", quoted(name) + " twice", "each effect once"}});
    }
    return list;
  };
  const auto on = take(request.force_on), off = take(request.force_off), detect = take(request.detect);
  for (const Effect effect : on) effects[effect] = true;
  for (const Effect effect : off) effects[effect] = false;
  for (const Effect effect : detect) effects.erase(effect);
  return effects;
}

std::string describe(const EffectOverrides& effects) {
  if (effects.empty()) return "all effects are detected";
  std::string on, off;
  for (const auto& [effect, is_on] : effects) {
    std::string& list = is_on ? on : off;
    list += words(list.empty() ? "" : ", ", effectName(effect));
  }
  return words(on.empty() ? "" : "forced on: ", on, on.empty() || off.empty() ? "" : "; ",
               off.empty() ? "" : "forced off: ", off);
}

// The modelling error is measured on a copy, on the thread of the service: the simulation goes on meanwhile.
std::string setEffects(Simulator& simulator, const SetEffects::Request& request,
                       SetEffects::Response& response) {
  SceneDef scene;
  SavedState state;
  const std::string message = simulator.apply([&](World& world) {
    const EffectOverrides effects = overridden(world.scene().effects, request);
    const std::vector<StageInfo> before = world.pipeline();
    world.setEffects(effects);
    response.changes = stageChanges(before, world.pipeline());
    if (!request.force_off.empty()) scene = world.capture(), state = world.captureState();
    return describe(effects);
  });
  for (const std::string& name : request.force_off) {
    const auto error = measureModellingError(scene, state, {{effectNamed(name), false}},
                                             [] { return !ros::isShuttingDown(); });
    if (ros::isShuttingDown()) break;
    response.neglected.push_back(
        words("without ", name, ": ", error ? rbs::describe(*error) : "the scene is too large to measure"));
  }
  return message;
}

std::string getBody(const Snapshot& snapshot, const GetBody::Request& request, GetBody::Response& response) {
  const std::size_t index = indexNamed(snapshot, request.name);
  const BodyDescription& body = (*snapshot.bodies)[index];
  response.body.description = toMsg(body);
  response.body.pose = toMsg(snapshot.states[index].pose);
  response.body.twist = toMsg(snapshot.states[index].twist);
  return words("'", body.name, "' at ", inWords(snapshot.states[index].pose.p_WB), " m: ", describe(body));
}

std::string listBodies(const Snapshot& snapshot, const ListBodies::Request&, ListBodies::Response& response) {
  for (const BodyDescription& body : *snapshot.bodies) response.names.push_back(body.name);
  response.hash = hexadecimal(snapshot.hash);
  return bodyCount(response.names.size());
}

}  // namespace

void Services::offerSurroundings() {
  offer<SetBool>("enable_wind", [this](const SetBool::Request& request, SetBool::Response&) {
    return enableWind(session_, request.data);
  });
  offerEdit<SetWind>("set_wind", setWind);
  offerEdit<SetGravity>("set_gravity", setGravity);
  offer<SetEffects>("set_effects",
                    [this](const SetEffects::Request& request, SetEffects::Response& response) {
                      return setEffects(simulator_, request, response);
                    });
}

void Services::offerReading() {
  offerQuery<GetBody>("get_body", getBody);
  offerQuery<ListBodies>("list_bodies", listBodies);
  offer<std_srvs::Trigger>(
      "republish", [this](const std_srvs::Trigger::Request&, std_srvs::Trigger::Response&) {
        session_.timeline().repeat();
        return std::string("the transforms, states, contacts and details are sent again");
      });
}

}  // namespace rbs
