// SPDX-License-Identifier: BSD-3-Clause
// What is known to fall short, with the figure and the reason.
#include "suite.h"

namespace rbs::stability {

const std::vector<Shortfall>& knownShortfalls() {
  static const std::vector<Shortfall> list{
      {"A11", "interactive", "first bounces found, e = 0.5", "9 of 12",
       "a pair that meets more than six times with hardly any time in between becomes a contact"},
      {"A38", "interactive", "places after 60 steps, boxes of 0.001 m against 0.05 m, of the size", "0.00099",
       "rounding decides the order of the first touches, and one pass a sub-step does not bring the answers "
       "together"},
      {"A38", "interactive", "places after 60 steps, boxes of 100 m against 0.05 m, of the size", "0.00097",
       "rounding decides the order of the first touches, and one pass a sub-step does not bring the answers "
       "together"},
      {"A43", "interactive", "movement of any block", "0.018 m", "soft contacts sink in under thirty layers"},
      {"A66", "interactive", "fastest body that was not held", "45 m/s",
       "a hand that moves in steps pulls faster than it moves, and what is caught between two is squeezed "
       "out"},
      {"A66", "accurate", "fastest body that was not held", "41 m/s",
       "a hand that moves in steps pulls faster than it moves, and what is caught between two is squeezed "
       "out"},
      {"A66", "reference", "fastest body that was not held", "41 m/s",
       "a hand that moves in steps pulls faster than it moves, and what is caught between two is squeezed "
       "out"},
      {"A75", "accurate", "gained in a step, of its scale: boxes_on_slope", "1.7e-07",
       "what rocks or tips gains and loses what a step of second order leaves"},
      {"A75", "accurate", "gained in a step, of its scale: dominoes", "5.6e-07",
       "what rocks or tips gains and loses what a step of second order leaves"},
      {"A75", "reference", "gained in a step, of its scale: boxes_on_slope", "1.7e-07",
       "what rocks or tips gains and loses what a step of second order leaves"},
      {"A75", "reference", "gained in a step, of its scale: dominoes", "5.4e-07",
       "what rocks or tips gains and loses what a step of second order leaves"},
      {"A76", "interactive", "rms speed at rest: pyramid", "0.00046 m/s",
       "soft contacts of a tall structure are still settling"},
      {"A76", "interactive", "rms speed at rest: jenga", "0.0028 m/s",
       "soft contacts of a tall structure are still settling"},
  };
  return list;
}

}  // namespace rbs::stability
