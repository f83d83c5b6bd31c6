// SPDX-License-Identifier: BSD-3-Clause
#include "click_targets.h"

#include <algorithm>

#include "body_markers.h"
#include "body_menu.h"
#include "convert.h"

namespace rbs {
namespace {

constexpr std::size_t kMostTargets = 300;

/// Not what only fences others in and is drawn translucent, since a click is meant for what one sees through it,
/// and not a plane, of which no part is the place to click.
bool isTarget(const BodyDescription& body, BodyId selected) {
  const bool is_see_through = body.kind == BodyKind::Static && body.color[3] < 1.0f;
  return (!is_see_through || body.id == selected) && !std::holds_alternative<Plane>(body.shape);
}

}  // namespace

void ClickTargets::update(const Snapshot& snapshot, const Vec3& focus, const std::vector<BodyId>& selection) {
  constexpr std::chrono::seconds kRevision(1);  // how often moving bodies change who is nearest
  const auto now = std::chrono::steady_clock::now();
  const bool is_large = snapshot.states.size() > kMostTargets;
  const bool moved_on = focus != focus_ || now - chosen_at_ > kRevision;
  const bool show = snapshot.bodies != described_ || selection != selection_ || (is_large && moved_on);
  if (show) {
    choose(snapshot, focus, selection.empty() ? BodyId{} : selection.back());
    focus_ = focus;
    selection_ = selection;
    chosen_at_ = now;
    described_ = snapshot.bodies;
  }
  const MenuScope all = show ? menuScope(selection) : MenuScope();
  for (const int i : chosen_) {
    const BodyDescription& body = (*snapshot.bodies)[i];
    const Pose& pose = snapshot.states[i].pose;
    if (show) {
      const bool is_selected = std::find(selection.begin(), selection.end(), body.id) != selection.end();
      board_.show(clickTarget(body, pose, snapshot.view, is_selected ? all : MenuScope()));
    } else {
      board_.move(body.name, toMsg(pose));
    }
  }
}

// The nearest bodies by their centres, the selected one first of all.
void ClickTargets::choose(const Snapshot& snapshot, const Vec3& focus, BodyId selected) {
  chosen_.clear();
  for (std::size_t i = 0; i < snapshot.states.size(); ++i) {
    const BodyDescription& body = (*snapshot.bodies)[i];
    if (isTarget(body, selected)) chosen_.push_back(static_cast<int>(i));
  }
  if (chosen_.size() > kMostTargets) {
    const auto distance = [&](int i) {
      const BodyState& state = snapshot.states[i];
      return state.id == selected ? -1.0 : (state.pose.p_WB - focus).squaredNorm();
    };
    std::nth_element(chosen_.begin(), chosen_.begin() + kMostTargets, chosen_.end(),
                     [&](int i, int j) { return distance(i) < distance(j); });
    chosen_.resize(kMostTargets);
  }
  std::set<std::string> names;
  for (const int i : chosen_) names.insert((*snapshot.bodies)[i].name);
  for (const std::string& name : names_) {
    if (!names.count(name)) board_.erase(name);
  }
  names_.swap(names);
}

}  // namespace rbs
