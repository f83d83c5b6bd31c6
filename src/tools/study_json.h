// SPDX-License-Identifier: BSD-3-Clause
// An accuracy study as JSON: what scene_accuracy prints and the node reads.
#pragma once

#include "rigid_body_sim/accuracy.h"

#include <nlohmann/json.hpp>

namespace rbs {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ErrorRate, distance, angle, energy)

inline void to_json(nlohmann::json& json, const Setting& setting) {
  json = {{"name", settingName(setting)}, {"preset", fidelityName(setting.preset)}, {"divisions", setting.divisions}};
  if (setting.sub_steps) json["sub_steps"] = *setting.sub_steps;
  if (setting.tolerance) json["tolerance"] = *setting.tolerance;
  if (setting.max_solve_ms) json["max_solve_ms"] = *setting.max_solve_ms;
}
inline void from_json(const nlohmann::json& json, Setting& setting) {
  setting.preset = fidelityNamed(json.at("preset").get<std::string>());
  json.at("divisions").get_to(setting.divisions);
  if (json.contains("sub_steps")) setting.sub_steps = json["sub_steps"].get<std::uint32_t>();
  if (json.contains("tolerance")) setting.tolerance = json["tolerance"].get<double>();
  if (json.contains("max_solve_ms")) setting.max_solve_ms = json["max_solve_ms"].get<double>();
}

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(SettingCost, setting, step_ms, error, worst, at_most, steps)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(AccuracyStudy, scene, time, step, window, seconds, windows, dropped, uncertainty,
                                   trouble, complete, settings)

}  // namespace rbs
