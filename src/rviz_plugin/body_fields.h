// SPDX-License-Identifier: BSD-3-Clause
// The properties of a body that are numbers: how each is read, and how a new value is asked for.
#pragma once

#include "bodies_client.h"

#include <QString>

#include <optional>
#include <vector>

namespace rbs {

/// A body as it is known now.
struct KnownBody {
  const rigid_body_sim::BodyDescription* description = nullptr;
  std::optional<BodyMotion> motion;  ///< empty: no state has come yet
};

/// A property of one number, or of three.
struct BodyField {
  const char* title;
  const char* unit;  ///< empty: none
  const char* tip;
  int parts;  ///< 1 or 3: along x, y and z
  /// The value of one part; empty where this body has none.
  std::optional<double> (*read)(const KnownBody& body, int part);
  /// Asks for another value of one part; the other parts stay.
  void (*write)(rigid_body_sim::BodyChange& change, const KnownBody& body, int part, double value);
  /// Whether 0 cannot be asked for: in a change it means that the property stays.
  bool above_zero;
  bool is_mask;  ///< bits, shown as hexadecimal
};

/// In the order in which they are shown.
const std::vector<BodyField>& bodyFields();

/// A value as it is shown.
QString inText(const BodyField& field, double value);

/// A number that was typed; empty for what is none. A mask may begin with 0x, and is 0 to 0xffffffff.
std::optional<double> fromText(const BodyField& field, const QString& text);

}  // namespace rbs
