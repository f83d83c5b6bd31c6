// SPDX-License-Identifier: BSD-3-Clause
#include "suite.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>

namespace rbs::stability {

std::optional<double> Bound::at(Fidelity setting) const {
  const std::string name = fidelityName(setting);
  if (name == "preview") return preview;
  if (name == "interactive") return interactive;
  if (name == "accurate") return accurate;
  return reference;
}

bool Row::holds() const {
  return !bound || std::abs(measured - reference) <= *bound;
}

void Sheet::error(const std::string& metric, const std::string& unit, double measured, const Bound& bound) {
  value(metric, unit, measured, 0.0, bound);
}

void Sheet::value(const std::string& metric, const std::string& unit, double measured, double reference,
                  const Bound& bound) {
  rows_.push_back({metric, unit, measured, reference, bound.at(setting_)});
}

void Sheet::check(const std::string& metric, bool is_so, const Bound& asked_of) {
  value(metric, "", is_so ? 1.0 : 0.0, 1.0, asked_of);
}

std::vector<Case> allCases() {
  std::vector<Case> cases;
  for (const auto& group : {flightCases(), impactCases(), frictionCases(), structureCases(), scaleCases(),
                            ccdCases(), abuseCases(), airCases(), determinismCases()})
    cases.insert(cases.end(), group.begin(), group.end());
  std::sort(cases.begin(), cases.end(),
            [](const Case& a, const Case& b) { return std::strcmp(a.number, b.number) < 0; });
  return cases;
}

}  // namespace rbs::stability
