// What is known to fall short, with the figure and the reason.
#include "suite.h"

namespace rbs::stability {

const std::vector<Shortfall>& knownShortfalls() {
  static const std::vector<Shortfall> list{
      {"A11", "interactive", "first bounces found, e = 0.5", "9 of 12",
       "a pair that meets more than six times with hardly any time in between becomes a contact"},
      {"A12", "interactive", "velocities after, of the 4 m/s of approach", "0.063",
       "an approach that grazes within the step is met a step early, as a contact"},
      {"A12", "interactive", "angular momentum, of the largest of one ball", "0.0056", "as above"},
      {"A14", "interactive", "impacts, masses 1 : 1e10", "4.1e4 of 314159",
       "the budget of impacts of one step"},
      {"A14", "interactive", "energy, relative, masses 1 : 1e10", "0.16", "as above"},
      {"A75", "interactive", "gained in all, of its scale: elastic_666", "0.013",
       "many impacts at once are left to the soft contacts, whose rebound at the end of the step is not "
       "exact"},
  };
  return list;
}

}  // namespace rbs::stability
