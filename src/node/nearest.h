// SPDX-License-Identifier: BSD-3-Clause
// The known name that was probably meant by one that is not known.
#pragma once

#include <string>
#include <vector>

namespace rbs {

/// The most similar of the `known` names, where one is similar enough to have been meant; otherwise "".
/// Costs the product of the lengths of the names.
std::string nearestName(const std::string& name, const std::vector<std::string>& known);

}  // namespace rbs
