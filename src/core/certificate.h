// The certificate of a step: what is checked before its result is handed out.
#pragma once

#include "context.h"

namespace rbs::certificate {

Need need(const Census& census);

/// Puts the deepest penetration into the report. A body whose state is not finite is put back to where the
/// step found it and frozen, and the report says so.
void run(Context& context);

}  // namespace rbs::certificate
