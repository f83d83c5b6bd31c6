// SPDX-License-Identifier: BSD-3-Clause
// Reading the values that scene files and commands share.
#pragma once

#include "rigid_body_sim/world.h"
#include "scene/yaml_fields.h"
#include "state/scene_fields.h"

#include <optional>

namespace rbs {

/// Key `fidelity`: the name of a quality level; or a mapping with its numbers, or with a goal by which the
/// settings change.
void readFidelity(Fields& top, FileProblems& problems, SceneDef& scene);
/// Key `effects`: a mapping of effects to on, off or auto.
void readEffects(Fields& top, FileProblems& problems, EffectOverrides& out);
/// Key of the air, the wind or the fluid: a mapping.
template <class Surrounding>
void readSurrounding(Fields& top, const char* key, FileProblems& problems, std::optional<Surrounding>& out) {
  readGroup(top, key, problems, [&](Fields& fields) {
    Surrounding& value = out.emplace();
    forEachField(Of<Surrounding>{},
                 [&](const char* name, auto field, Range) { fields.read(name, value.*field); });
  });
}

/// The keys of a value among others; all are needed.
void readGrab(Fields& fields, Grab& grab);
void readPose(Fields& fields, Pose& pose);
void readTwist(Fields& fields, Twist& twist);

}  // namespace rbs
