// SPDX-License-Identifier: BSD-3-Clause
// An accuracy study as JSON: what scene_accuracy prints and the node reads.
#pragma once

#include "rigid_body_sim/accuracy.h"

#include <nlohmann/json.hpp>

#include <limits>

namespace rbs {

// JSON knows no infinity: it is written as null.
inline void to_json(nlohmann::json& json, const ErrorRate& rate) {
  json = {{"distance", rate.distance}, {"angle", rate.angle}, {"energy", rate.energy}};
}
inline void from_json(const nlohmann::json& json, ErrorRate& rate) {
  const auto read = [&](const char* name) {
    const nlohmann::json& number = json.at(name);
    return number.is_null() ? std::numeric_limits<double>::infinity() : number.get<double>();
  };
  rate = {read("distance"), read("angle"), read("energy")};
}

inline void to_json(nlohmann::json& json, const Setting& setting) {
  json = {{"name", settingName(setting)},
          {"preset", fidelityName(setting.preset)},
          {"divisions", setting.divisions}};
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
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(AccuracyStudy, scene, time, step, window, shortest, seconds, windows,
                                   shortened, inconclusive, uncertainty, trouble, complete, first_answer,
                                   settings)

}  // namespace rbs
