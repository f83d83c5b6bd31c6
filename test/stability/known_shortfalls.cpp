// What is known to fall short, with the figure and the reason.
#include "suite.h"

namespace rbs::stability {

const std::vector<Shortfall>& knownShortfalls() {
  static const std::vector<Shortfall> list{
      {"A11", "interactive", "first bounces found, e = 0.5", "9 of 12",
       "a pair that meets more than six times with hardly any time in between becomes a contact"},
      {"A12", "interactive", "velocities after, of the 4 m/s of approach, grazing at 0.99 and 0.999", "0.063",
       "an approach that grazes is met a step early, as a contact"},
      {"A12", "interactive", "angular momentum, of the largest of one ball, grazing at 0.99 and 0.999",
       "0.0056", "an approach that grazes is met a step early, as a contact"},
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
      {"A34", "interactive", "movement of any cube, 10 cubes", "0.0054 m",
       "sequential impulses do not carry the weight down a tall stack in eight sub-steps"},
      {"A34", "interactive", "kinetic energy per mass after 2 s, 10 cubes", "1.7e-05 J/kg",
       "sequential impulses do not carry the weight down a tall stack in eight sub-steps"},
      {"A34", "interactive", "movement of any cube, 30 cubes", "0.33 m",
       "sequential impulses do not carry the weight down a tall stack in eight sub-steps"},
      {"A34", "interactive", "deepest penetration, 30 cubes", "0.0074 m",
       "sequential impulses do not carry the weight down a tall stack in eight sub-steps"},
      {"A34", "interactive", "kinetic energy per mass after 2 s, 30 cubes", "0.0014 J/kg",
       "sequential impulses do not carry the weight down a tall stack in eight sub-steps"},
      {"A34", "interactive", "movement of any cube, 40 cubes", "0.15 m",
       "sequential impulses do not carry the weight down a tall stack in eight sub-steps"},
      {"A34", "interactive", "deepest penetration, 40 cubes", "0.0088 m",
       "sequential impulses do not carry the weight down a tall stack in eight sub-steps"},
      {"A34", "interactive", "kinetic energy per mass after 2 s, 40 cubes", "0.0005 J/kg",
       "sequential impulses do not carry the weight down a tall stack in eight sub-steps"},
      {"A38", "interactive", "places after 60 steps, boxes of 0.001 m against 0.05 m, of the size", "0.00057",
       "rounding decides the order of the first touches, and one pass a sub-step does not bring the answers "
       "together"},
      {"A38", "interactive", "places after 60 steps, boxes of 100 m against 0.05 m, of the size", "0.00057",
       "rounding decides the order of the first touches, and one pass a sub-step does not bring the answers "
       "together"},
      {"A43", "interactive", "movement of any block", "0.018 m", "soft contacts sink in under thirty layers"},
      {"A43", "interactive", "movement of any block, without the middle blocks", "0.027 m",
       "soft contacts sink in under thirty layers"},
      {"A43", "interactive", "movement of ten boxes laid crosswise", "0.0052 m",
       "soft contacts sink in under thirty layers"},
      {"A44", "interactive", "deepest penetration, of the size, 1 : 1000, 2 boxes", "0.1",
       "sequential impulses cannot carry a mass ratio of 1000 and more"},
      {"A44", "interactive", "1, 10 ... 1e4 kg, heaviest on top: sag", "1.8 m",
       "sequential impulses cannot carry a mass ratio of 1000 and more"},
      {"A44", "interactive", "1, 10 ... 1e4 kg, heaviest on top: moved sideways", "2.6 m",
       "sequential impulses cannot carry a mass ratio of 1000 and more"},
      {"A50", "interactive", "places after 2 s at 1e+07 m", "0.0023 m",
       "the scene begins with gaps of a tenth, and the rounding of 2e-9 m changes when the boxes first "
       "touch"},
      {"A50", "interactive", "contact points at 1e+07 m", "22 of 20",
       "the scene begins with gaps of a tenth, and the rounding of 2e-9 m changes when the boxes first "
       "touch"},
      {"A51", "interactive", "stack at a scale of 1e-06", "0.00053",
       "rounding decides whether boxes that just touch begin as an impact or as a contact"},
      {"A51", "interactive", "stack at a scale of 0.001", "0.00033",
       "rounding decides whether boxes that just touch begin as an impact or as a contact"},
      {"A51", "interactive", "bounce and tumble at a scale of 0.001", "3.8e-05",
       "rounding decides whether boxes that just touch begin as an impact or as a contact"},
      {"A51", "interactive", "bounce and tumble at a scale of 1e+06", "3.8e-05",
       "rounding decides whether boxes that just touch begin as an impact or as a contact"},
      {"A54", "preview", "spinning sticks of 24 at 180 m/s that pass a wall of 1 cm", "5",
       "after an impact that sets it spinning at 1300 rad/s the stick's other end is missed"},
      {"A54", "interactive", "spinning sticks of 24 at 180 m/s that pass a wall of 1 cm", "1",
       "after an impact that sets it spinning at 1300 rad/s the stick's other end is missed"},
      {"A64", "interactive", "fastest, of √(g L): a box in a large box", "0.14",
       "what slides off the large box in a fall also turns"},
      {"A65", "interactive", "fastest, of √(g L): a pyramid of ten boxes that overlap by 0.25", "0.41",
       "each pair parts no faster than the cap, but the speeds of a chain add up"},
      {"A65", "interactive", "fastest, of √(g L): a pyramid of ten boxes that overlap by 0.5", "0.4",
       "each pair parts no faster than the cap, but the speeds of a chain add up"},
      {"A65", "interactive", "fastest, of √(g L): a pyramid of ten boxes that overlap by 1", "1.6",
       "each pair parts no faster than the cap, but the speeds of a chain add up"},
      {"A66", "preview", "deepest centre below the floor", "2.2 m",
       "pulled with that force, one sub-step lets the box through the floor"},
      {"A66", "interactive", "fastest body that was not held", "45 m/s",
       "a hand that moves in steps pulls faster than it moves, and what is caught between two is squeezed "
       "out"},
      {"A69", "preview", "gravity of 1e6 m/s²: out of the room by", "5e+05 m",
       "a fall of 140 m a step through the room's floor: the contacts of the step are those of its start"},
      {"A69", "preview", "all numbers finite", "0",
       "what has fallen through the floor is frozen when it is faster than 1e6 m/s"},
      {"A69", "interactive", "gravity of 1e6 m/s²: out of the room by", "4.9e+05 m",
       "a fall of 140 m a step through the room's floor: the contacts of the step are those of its start"},
      {"A75", "preview", "gained in all, of its scale: gas", "20",
       "more impacts in a step than its budget: the rest are left to the contacts, which keep neither energy "
       "nor walls"},
      {"A75", "preview", "gained in all, of its scale: kapla", "0.0015", "one sub-step on a tall structure"},
      {"A75", "interactive", "gained in all, of its scale: elastic_666", "0.013",
       "more impacts in a step than its budget: the rest are left to the contacts, which keep neither energy "
       "nor walls"},
      {"A76", "interactive", "rms speed at rest: pyramid", "0.00046 m/s",
       "soft contacts of a tall structure are still settling"},
      {"A76", "interactive", "rms speed at rest: jenga", "0.0028 m/s",
       "soft contacts of a tall structure are still settling"},
  };
  return list;
}

}  // namespace rbs::stability
