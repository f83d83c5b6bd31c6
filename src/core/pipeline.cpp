// THE table of stages: a step of the world is these rows, in this order. A newcomer starts reading here.
//
// Each row says when the scene needs it; a row that is not needed is not called. islands.advance hands
// batches of islands to the methods (methods/), whose rows stand below it: flight for bodies that nothing
// touches, the soft step or the exact step for bodies in contact.
#include "pipeline.h"

#include "broadphase/sweep_and_prune.h"
#include "certificate.h"
#include "effects/effects.h"
#include "fidelity.h"
#include "impacts.h"
#include "islands.h"
#include "methods/methods.h"
#include "text.h"

#include <array>
#include <chrono>

namespace rbs {

namespace {

struct Stage {
  const char* name;
  Need (*need)(const Census&);
  void (*run)(Context&);
};

constexpr std::array kStages{
    Stage{"hands.hold", holds::need, holds::run},
    Stage{"forces.gravity", gravity::need, gravity::run},
    Stage{"forces.wrench", wrenches::need, wrenches::run},
    Stage{"forces.grab", grabs::need, grabs::run},
    Stage{"forces.drag", drag::need, drag::run},
    Stage{"broadphase.pairs", sweep_and_prune::need, sweep_and_prune::run},
    Stage{"impacts.find", impacts::need, impacts::find},
    Stage{"islands.link", islands::need, islands::link},
    Stage{"islands.advance", islands::need, islands::advance},
    Stage{"certificate", certificate::need, certificate::run},
};

// Parts of the methods that a scene may do without; they are chosen row by row inside islands.advance.
struct Part {
  const char* name;
  Need (*need)(const Census&);
};

Need needFriction(const Census& c) {
  if (c.rough < 2) return {false, "fewer than two bodies have friction above 0"};
  return {true, count(c.rough, "body has", "bodies have") + " friction above 0"};
}

Need needGyroscopic(const Census& c) {
  if (c.asymmetric == 0) return {false, "no body has principal moments that differ"};
  return {true, count(c.asymmetric, "body has", "bodies have") + " principal moments that differ"};
}

std::string contactLaw(Fidelity fidelity) {
  const FidelitySettings settings = settingsOf(fidelity);
  const std::string name = std::string(fidelityName(fidelity)) + ": ";
  if (settings.exact) return name + "Coulomb's law to " + text(settings.tolerance);
  return name + "soft contacts, " + count(settings.sub_steps, "sub-step", "sub-steps") +
         (settings.promotes ? "; Coulomb's law for small stiff groups" : "");
}

constexpr std::array kParts{
    Part{"rotation.gyroscopic", needGyroscopic},
    Part{"contacts.friction", needFriction},
};

double secondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

void StepStore::begin(Index n, double from, double to) {
  t0 = from;
  t1 = to;
  load.assign(n, {});
  airless.clear();
  bounds.resize(n);
  contacts.clear();
  inherited = 0;
  supported.assign(n, 0);
  standing.clear();
  impacts.clear();
  stamp.assign(n, 0);
  islands.clear();
  island.assign(n, kNone);
  contact_seconds.assign(kContactRows, 0.0);
  report = {};
}

void Pipeline::filter(const Census& census) {
  active_.clear();
  for (std::size_t row = 0; row < kStages.size(); ++row)
    if (kStages[row].need(census).active) active_.push_back(row);
  seconds_.assign(kStages.size(), 0.0);
  contact_seconds_.clear();
}

void Pipeline::run(Context& context) {
  const auto step_start = std::chrono::steady_clock::now();
  for (const std::size_t row : active_) {
    const auto start = std::chrono::steady_clock::now();
    kStages[row].run(context);
    seconds_[row] = secondsSince(start);
  }
  contact_seconds_ = context.step.contact_seconds;
  context.step.report.seconds = secondsSince(step_start);
}

std::vector<StageInfo> Pipeline::describe(const Census& census) const {
  std::vector<StageInfo> rows;
  for (std::size_t row = 0; row < kStages.size(); ++row) {
    const Need need = kStages[row].need(census);
    rows.push_back({kStages[row].name, need.active, need.reason, seconds_.empty() ? 0.0 : seconds_[row]});
    if (kStages[row].run != islands::advance) continue;
    const Need contact = sweep_and_prune::need(census);
    for (std::size_t k = 0; k < kContactRows; ++k) {
      const double seconds = k < contact_seconds_.size() ? contact_seconds_[k] : 0.0;
      const std::string reason = k == kSolve && contact.active ? contactLaw(census.fidelity) : contact.reason;
      rows.push_back({kContactRowNames[k], contact.active, reason, seconds});
    }
    for (const Part& part : kParts) {
      const Need inner = part.need(census);
      rows.push_back({part.name, inner.active, inner.reason, 0.0});
    }
  }
  return rows;
}

}  // namespace rbs
