// SPDX-License-Identifier: BSD-3-Clause
// The table of hard cases: what a case is, and the sheet on which it writes its figures.
//
// A figure is one bound of one metric of one case at one setting. It holds when the measured number is within
// the bound of the reference, so a bound bites on both sides, and NaN never holds.
#pragma once

#include "rigid_body_sim/scene.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace rbs::stability {

/// The settings that are run, from fast to exact.
inline constexpr std::array kSettings = kFidelities;

/// Which settings a bound is asked of. Where it is not asked, the measured number is shown.
struct Bound {
  std::optional<double> preview, interactive, accurate, reference;

  std::optional<double> at(Fidelity setting) const;
};

/// Of the exact settings; the others show it.
inline Bound exact(double bound) {
  return {{}, {}, bound, bound};
}
/// Of `reference` alone: `accurate` solves to 1e-6, which is not enough for it.
inline Bound referenceOnly(double bound) {
  return {{}, {}, {}, bound};
}
/// Of the default setting, and another of `reference` alone.
inline Bound fastAndReference(double fast, double reference) {
  return {{}, fast, {}, reference};
}
/// Of the default setting, and another of the exact ones.
inline Bound fastAndExact(double fast, double exact) {
  return {{}, fast, exact, exact};
}
/// Of all settings but `preview`: closed forms and located impacts serve them all alike.
inline Bound closedForm(double bound) {
  return {{}, bound, bound, bound};
}
/// A promise of every setting.
inline Bound every(double bound) {
  return {bound, bound, bound, bound};
}
/// Shown, asked of none.
inline Bound shown() {
  return {};
}

/// One line of the table.
struct Row {
  std::string metric, unit;
  double measured = 0.0;
  double reference = 0.0;
  std::optional<double> bound;  ///< on |measured - reference|; empty: shown only

  bool holds() const;  ///< true where nothing is asked
};

/// One run of a case at one setting.
class Sheet {
 public:
  Sheet(Fidelity setting, bool full_length) : setting_(setting), full_length_(full_length) {}

  Fidelity setting() const { return setting_; }
  bool isExact() const { return setting_ != Fidelity::Preview && setting_ != Fidelity::Interactive; }
  /// A length of time or a count: `quick` in the tests, `full` in scripts/stability.
  template <class T>
  T length(T quick, T full) const {
    return full_length_ ? full : quick;
  }
  /// The same where the exact settings are too slow for that.
  template <class T>
  T length(T quick, T exact_quick, T full) const {
    return length(isExact() ? exact_quick : quick, full);
  }

  /// An error, whose reference is 0.
  void error(const std::string& metric, const std::string& unit, double measured, const Bound& bound);
  /// A number with a reference of its own.
  void value(const std::string& metric, const std::string& unit, double measured, double reference,
             const Bound& bound);
  /// Whether something is as it should be: 1 or 0, and 1 is asked.
  void check(const std::string& metric, bool is_so, const Bound& asked_of);

  const std::vector<Row>& rows() const { return rows_; }

 private:
  Fidelity setting_;
  bool full_length_;
  std::vector<Row> rows_;
};

/// A case: what it sets up and asks, in words, and the run that measures it.
struct Case {
  const char* number;  ///< "A05"
  const char* title;
  const char* text;  ///< the set-up, the reference and what is asked, so that the page stands alone
  void (*run)(Sheet& sheet);
};

// The groups, each in the file of its name.
std::vector<Case> flightCases();
std::vector<Case> impactCases();
std::vector<Case> frictionCases();
std::vector<Case> structureCases();
std::vector<Case> scaleCases();
std::vector<Case> ccdCases();
std::vector<Case> abuseCases();
std::vector<Case> airCases();
std::vector<Case> determinismCases();

/// All cases, by number.
std::vector<Case> allCases();

/// A figure that is not met, with what was measured and why.
struct Shortfall {
  const char* number;
  const char* setting;
  const char* metric;
  const char* measured;  ///< in words and numbers
  const char* reason;
};

/// The list of what is known to fall short in the tests. It is kept true: a test fails as well when a figure
/// on the list has come to hold.
const std::vector<Shortfall>& knownShortfalls();

}  // namespace rbs::stability
