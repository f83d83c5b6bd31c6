// What is known to fall short, with the figure and the reason.
#include "suite.h"

namespace rbs::stability {

const std::vector<Shortfall>& knownShortfalls() {
  static const std::vector<Shortfall> list{
      {"A11", "interactive", "first bounces found, e = 0.5", "9 of 12",
       "a pair that meets more than six times with hardly any time in between becomes a contact"},
      {"A12", "interactive", "velocities after, of the 4 m/s of approach", "0.063",
       "an approach that grazes is met a step early, as a contact"},
      {"A12", "interactive", "angular momentum, of the largest of one ball", "0.0056",
       "an approach that grazes is met a step early, as a contact"},
      {"A14", "interactive", "impacts, masses 1 : 1e10", "4.1e+04 of 314159",
       "the budget of impacts of one step"},
      {"A14", "interactive", "energy, relative, masses 1 : 1e10", "-0.16",
       "the budget of impacts of one step"},
      {"A15", "interactive", "mean squared error of the energy", "3e+05 J²",
       "more impacts in a step than its budget: the rest are left to the contacts, which keep neither energy "
       "nor walls"},
      {"A15", "interactive", "deepest overlap", "0.075 m",
       "more impacts in a step than its budget: the rest are left to the contacts, which keep neither energy "
       "nor walls"},
      {"A20", "preview", "escaped balls", "4.9e+02",
       "more impacts in a step than its budget: the rest are left to the contacts, which keep neither energy "
       "nor walls"},
      {"A20", "interactive", "energy, relative", "-0.58",
       "more impacts in a step than its budget: the rest are left to the contacts, which keep neither energy "
       "nor walls"},
      {"A20", "interactive", "escaped balls", "11",
       "more impacts in a step than its budget: the rest are left to the contacts, which keep neither energy "
       "nor walls"},
      {"A21", "interactive", "stays below the threshold by 0.001", "0",
       "one pass a sub-step leaves too much of the friction of four corners unsolved"},
      {"A32", "interactive", "energy of the ring, relative", "-0.031",
       "what meets at one time is left to soft contacts, which dissipate"},
      {"A75", "preview", "gained in all, of its scale: gas", "20",
       "more impacts in a step than its budget: the rest are left to the contacts, which keep neither energy "
       "nor walls"},
      {"A75", "preview", "gained in all, of its scale: kapla", "0.0015", "one sub-step on a tall structure"},
      {"A75", "interactive", "gained in all, of its scale: elastic_666", "0.013",
       "more impacts in a step than its budget: the rest are left to the contacts, which keep neither energy "
       "nor walls"},
  };
  return list;
}

}  // namespace rbs::stability
