// SPDX-License-Identifier: BSD-3-Clause
// How our nodes start and end.
#pragma once

#include <optional>
#include <string>

namespace rbs {

/// Starts a node on wall time, whatever the rest of the graph lives on: it is the source of the graph's clock, and its
/// timers go on while that stands.
void initOnWallTime(int argc, char** argv, const std::string& name);

/// Ends the node in good order at SIGTERM, and when its terminal is closed; roscpp does so at SIGINT only.
void endInGoodOrder();

/// Handles --help, --version and unknown arguments of `program` without starting a node, which would end another of its
/// name. Nothing where there is nothing but remappings; otherwise the exit code.
std::optional<int> answerWithoutNode(int argc, char** argv, const std::string& program,
                                     const std::string& version, std::string (*help)());

}  // namespace rbs
