// SPDX-License-Identifier: BSD-3-Clause
#include "replay_services.h"

#include "answer.h"
#include "words.h"

#include <rigid_body_sim/AccuracyGoal.h>
#include <rigid_body_sim/ApplyImpulse.h>
#include <rigid_body_sim/ApplyWrench.h>
#include <rigid_body_sim/CastRay.h>
#include <rigid_body_sim/ClosestPoints.h>
#include <rigid_body_sim/DuplicateBodies.h>
#include <rigid_body_sim/EditBodies.h>
#include <rigid_body_sim/File.h>
#include <rigid_body_sim/GetBody.h>
#include <rigid_body_sim/ListBodies.h>
#include <rigid_body_sim/ListScenes.h>
#include <rigid_body_sim/LoadScene.h>
#include <rigid_body_sim/LoadSceneWithSeed.h>
#include <rigid_body_sim/MeasureAccuracy.h>
#include <rigid_body_sim/MoveBody.h>
#include <rigid_body_sim/NamedBodies.h>
#include <rigid_body_sim/NamedBody.h>
#include <rigid_body_sim/Overlaps.h>
#include <rigid_body_sim/ResizeBody.h>
#include <rigid_body_sim/Seek.h>
#include <rigid_body_sim/SetBody.h>
#include <rigid_body_sim/SetEffects.h>
#include <rigid_body_sim/SetFidelity.h>
#include <rigid_body_sim/SetGravity.h>
#include <rigid_body_sim/SetSpeed.h>
#include <rigid_body_sim/SetWind.h>
#include <rigid_body_sim/SpawnBodies.h>
#include <rigid_body_sim/SpawnBody.h>
#include <rigid_body_sim/Step.h>
#include <rigid_body_sim/TuneFidelity.h>
#include <std_srvs/SetBool.h>
#include <std_srvs/Trigger.h>

#include <algorithm>
#include <exception>
#include <stdexcept>

namespace rbs {

using namespace rigid_body_sim;
using std_srvs::SetBool;
using std_srvs::Trigger;

ReplayServices::ReplayServices(Player& player, const std::string& simulator)
    : player_(player), node_(simulator) {
  offerTime();
  refuseEdits();
}

// `handler` returns the message of the reply, or throws.
template <class Service, class Handler>
void ReplayServices::offer(const std::string& name, Handler handler) {
  servers_.push_back(node_.advertiseService(name, answerBy<Service>(handler)));
}

template <class Service>
void ReplayServices::refuse(const std::string& name) {
  offer<Service>(name, [](const auto&, auto&) -> std::string {
    throw std::runtime_error("this is the replay of a recording; start a simulator for that: sim.launch");
  });
}

void ReplayServices::offerTime() {
  const auto offerTrigger = [this](const char* name, void (Player::*act)()) {
    offer<Trigger>(name, [this, act](const auto&, auto&) {
      (player_.*act)();
      return player_.inWords();
    });
  };
  offerTrigger("pause", &Player::pause);
  offerTrigger("resume", &Player::resume);
  offerTrigger("toggle_pause", &Player::togglePause);
  offerTrigger("reset", &Player::goToStart);
  offer<SetSpeed>("set_speed", [this](const auto& request, auto&) {
    player_.setSpeed(request.factor);
    return request.factor == 0.0 ? "as fast as possible"
                                 : words("requested real-time factor: ", request.factor);
  });
  offer<Step>("step", [this](const auto& request, auto& response) {
    response.taken = player_.step(request.n);
    response.time = player_.seconds();
    if (response.taken < std::max(request.n, 1u))
      throw std::runtime_error("the recording ends here: " + player_.inWords());
    return player_.inWords();
  });
  offer<Trigger>("republish", [this](const auto&, auto&) {
    player_.seek(player_.seconds());
    return "what is shown is sent again";
  });
  offer<Seek>("seek", [this](const auto& request, auto&) {
    player_.seek(request.time);
    return player_.inWords();
  });
}

void ReplayServices::refuseEdits() {
  refuse<SpawnBody>("spawn_body");
  refuse<SpawnBodies>("spawn_bodies");
  refuse<NamedBody>("delete_body");
  refuse<NamedBodies>("delete_bodies");
  refuse<DuplicateBodies>("duplicate_bodies");
  refuse<EditBodies>("edit_bodies");
  refuse<Trigger>("clear");
  refuse<ResizeBody>("resize_body");
  refuse<MoveBody>("move_body");
  refuse<SetBody>("set_body");
  refuse<ApplyImpulse>("apply_impulse");
  refuse<ApplyWrench>("apply_wrench");
  refuse<GetBody>("get_body");
  refuse<ListBodies>("list_bodies");
  refuse<CastRay>("cast_ray");
  refuse<ClosestPoints>("closest_points");
  refuse<Overlaps>("overlaps");
  refuse<SetBool>("enable_wind");
  refuse<SetWind>("set_wind");
  refuse<SetGravity>("set_gravity");
  refuse<SetEffects>("set_effects");
  refuse<SetFidelity>("set_fidelity");
  refuse<TuneFidelity>("tune_fidelity");
  refuse<AccuracyGoal>("seek_accuracy");
  refuse<AccuracyGoal>("apply_accuracy");
  refuse<MeasureAccuracy>("measure_accuracy");
  refuse<Trigger>("stop_accuracy");
  refuse<SetBool>("estimate_error");
  refuse<SetBool>("show_ghost");
  refuse<Trigger>("undo");
  refuse<Trigger>("redo");
  refuse<ListScenes>("list_scenes");
  refuse<LoadScene>("load_scene");
  refuse<LoadSceneWithSeed>("load_scene_with_seed");
  refuse<File>("load_state");
  refuse<File>("save_scene");
  refuse<File>("save_state");
}

}  // namespace rbs
