// SPDX-License-Identifier: BSD-3-Clause
// Lengths in words.
#pragma once

#include <string>

namespace rbs {

/// A length with three digits that count, in the unit that suits it: "20 mm"; "0" for none. `metres` >= 0.
std::string lengthText(double metres);

}  // namespace rbs
