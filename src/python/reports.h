// SPDX-License-Identifier: BSD-3-Clause
// Reports: what a step did, the stages that it ran, energy and momentum, and the descriptions of bodies.
#pragma once

#include "errors.h"

#include "rigid_body_sim/snapshot.h"

namespace rbs::python {

py::object fromTotals(const Totals& totals);
/// A tuple of StageInfo.
py::tuple fromPipeline(const std::vector<StageInfo>& stages);
/// A tuple of BodyDescription.
py::tuple fromDescriptions(const std::vector<BodyDescription>& bodies);
/// A list of names.
py::list namesOf(const std::vector<BodyDescription>& bodies);

void bindReports(py::module_& module);

}  // namespace rbs::python
