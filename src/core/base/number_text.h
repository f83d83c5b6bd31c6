// SPDX-License-Identifier: BSD-3-Clause
// Numbers and names as people read and write them in files and messages.
#pragma once

#include "rigid_body_sim/types.h"

#include <optional>
#include <string>
#include <vector>

namespace rbs {

/// The shortest decimal text that reads back as exactly this number; "inf", "-inf" or "nan" otherwise.
/// Independent of the locale.
std::string numberText(double number);
std::string numberText(float number);
std::string vectorText(const Vec3& v);  ///< "[x, y, z]"

/// The number that the whole of `text` spells in decimal; empty when it is no finite number.
std::optional<double> parseNumber(const std::string& text);

/// The candidate that `name` is most likely a misspelling of; empty when none is near.
std::string nearestName(const std::string& name, const std::vector<std::string>& candidates);

}  // namespace rbs
