// SPDX-License-Identifier: BSD-3-Clause
// What RViz goes on to draw of a simulator that is no more.
#pragma once

#include <string>

namespace rviz {
class DisplayContext;
}

namespace rbs {

/// Clears the displays of interactive markers of this node, by its resolved name. RViz keeps them when their server dies.
/// What a server that lives has, comes again.
void dropMarkersOf(const std::string& node, rviz::DisplayContext& context);

}  // namespace rbs
