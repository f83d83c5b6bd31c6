// SPDX-License-Identifier: BSD-3-Clause
// Which bodies have other names than before.
#pragma once

#include <rigid_body_sim/BodyDescriptions.h>

#include <QHash>
#include <QString>

namespace rbs {

/// New names by the last ones, whoever gave them; empty for another scene. Not those of bodies that take each other's names:
/// they cannot be told from a scene file that was edited and loaded again.
QHash<QString, QString> renamesOf(const rigid_body_sim::BodyDescriptions& before,
                                  const rigid_body_sim::BodyDescriptions& now);

}  // namespace rbs
