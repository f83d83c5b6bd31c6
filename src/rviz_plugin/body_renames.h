// SPDX-License-Identifier: BSD-3-Clause
// Which bodies have other names than before.
#pragma once

#include <rigid_body_sim/BodyDescriptions.h>

#include <QHash>
#include <QString>

namespace rbs {

/// New names by the last ones, whoever gave them; empty for another scene. Bodies that take names of others are followed where all
/// else of them is as it was, and no body has come or gone: a scene file that was edited and loaded again may number its bodies
/// otherwise.
QHash<QString, QString> renamesOf(const rigid_body_sim::BodyDescriptions& before,
                                  const rigid_body_sim::BodyDescriptions& now);

}  // namespace rbs
