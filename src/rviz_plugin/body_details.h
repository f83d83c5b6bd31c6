// SPDX-License-Identifier: BSD-3-Clause
// What ~body_details says of the bodies, checked and put in the order of a catalog.
#pragma once

#include "body_catalog.h"

#include <rigid_body_sim/BodyDetails.h>

#include <optional>
#include <vector>

namespace rbs {

/// How the last step took a body, and how far it is from the reference run.
struct BodyDetail {
  std::uint8_t method = rigid_body_sim::BodyDetails::NONE;
  std::uint64_t island = 0;       ///< id of its oldest body; 0: none
  std::optional<float> distance;  ///< m, >= 0; empty: not compared
};

/// By body of the catalog; those that the message does not know have the details of none. Throws BadMessage.
std::vector<BodyDetail> readDetails(const rigid_body_sim::BodyDetails& message, const BodyCatalog& catalog);

}  // namespace rbs
