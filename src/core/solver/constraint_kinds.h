// SPDX-License-Identifier: BSD-3-Clause
// THE list of the kinds of constraints beside contacts. A kind is a class in a file of its own in this folder; to add one is
// that file, its enumerator (state/island.h) and its name here. What it has to have:
//
//   static void addEdges(const SceneStore&, std::vector<Edge>&);           the edges it adds to the graph, in canonical order
//   static bool takes(const Context&, const Subgraph&);                    whether it may have rows among these constraints
//   static double longestSubStep(const Context&, const Subgraph&);         s; infinite: as long as one likes
//   void prepare(const Context&, const Subgraph&, const SolverContacts&, double h);   its rows; h: length of a sub-step, s
//   bool empty() const;                                                    it has none
//   void warmStart(SolverContacts&);                                       velocities += the last sub-step's impulses
//   void solve(SolverContacts&, Pass, const Softness&, double h);          one pass over its rows, Pass::Soft or Pass::Last
//   void store(Context&);                 after the last sub-step: its impulses, and how far its islands are from its law
//
// The bodies of edges are in SolverContacts::bodies, by SolverContacts::slotOf(). Where such a body may meet no other, the kind
// is an effect that it feels (effects/effects.h), or the body counts as ballistic. A body of an edge is supported: no impact is
// predicted as if it were in free flight.
#pragma once

#include "effects_built.h"
#include "solver/rolling.h"

#include <type_traits>

namespace rbs {

template <class... Kinds>
struct KindList {};

using OtherKinds = std::conditional_t<built::rolling, KindList<rolling::Resistance>, KindList<>>;

}  // namespace rbs
