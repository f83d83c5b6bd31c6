// SPDX-License-Identifier: BSD-3-Clause
// Boxes that stand on each other: nothing moves, whatever they weigh. What carries n of them is n times the
// weight of one, so an iteration that has not got there lets them sink; how far they sank is what its
// impulses lack.
#include "../problem.h"

#include <algorithm>

namespace rbs::accuracy {
namespace {

Problem atRest(const std::string& name, const std::string& sentence, const std::vector<double>& masses) {
  Problem p;
  p.name = name;
  p.sentence = sentence;
  p.against = "exact";
  p.measure = "largest distance that a box moved, as a fraction of its edge";
  p.duration = 2.0;
  p.steps.pop_back();  // for the sake of time
  std::vector<BodyDef> bodies{floor(0.5)};
  for (std::size_t k = 0; k < masses.size(); ++k)
    bodies.push_back(
        body(Box{Vec3::Ones()}, masses[k], Vec3(0, 0, 0.5 + static_cast<double>(k)), Vec3::Zero(), 0.5));
  p.task.scene = scene(bodies);
  p.error = [](double, const std::vector<Motion>& m) {
    double worst = 0;
    for (std::size_t k = 1; k < m.size(); ++k)
      worst = std::max(worst, (m[k].pose.p_WB - Vec3(0, 0, static_cast<double>(k) - 0.5)).norm());
    return worst;
  };
  return p;
}

const RegisterProblem stack(atRest("stack", "Ten boxes stand on each other for 2 s; do they stay?",
                                   std::vector<double>(10, 1000.0)));
const RegisterProblem ratio(atRest("mass_ratio",
                                   "A box of 1000 kg stands on one of 1 kg for 2 s; do they stay?",
                                   {1.0, 1000.0}));

}  // namespace
}  // namespace rbs::accuracy
