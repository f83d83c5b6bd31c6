// SPDX-License-Identifier: BSD-3-Clause
// The certificate of a step: what is checked before its result is handed out.
#pragma once

#include "context.h"

namespace rbs::certificate {

Need need(const Census& census);

/// Adds what one solve says of an island to its certificate: the worst residuals, the sum of the iterations,
/// the most expensive solver.
void add(IslandCertificate& certificate, const IslandCertificate& solve);

/// Puts the deepest penetration and the certificates of the islands in contact into the report. A body whose
/// state is not finite is put back to where the step found it and frozen, and the report says so.
void run(Context& context);

}  // namespace rbs::certificate
