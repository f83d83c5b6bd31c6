// SPDX-License-Identifier: BSD-3-Clause
// The contact points of the soft step, four pairs at a time.
//
// Gauss-Seidel is sequential: each pair reads the velocities that the pair before it wrote. Two pairs that
// share no dynamic body are independent, so they can be solved at the same time. Each pair gets a level, one
// more than the highest level of any earlier pair that shares a dynamic body with it. A pass takes the levels
// in order, and the pairs of a level four at a time. Every pair then reads exactly the velocities that it
// would read in the original order. This is level scheduling, known from triangular systems (Y. Saad,
// "Iterative Methods for Sparse Linear Systems", 2nd ed. 2003, 11.6).
#pragma once

#include "solver/lanes.h"
#include "solver/pass_regions.h"
#include "solver/solver_contacts.h"

#include <array>
#include <functional>
#include <vector>

namespace rbs {

/// A soft constraint as an impulse solver writes it (soft_step.h).
struct Softness {
  double bias, mass, impulse;  // b, a, c
};

/// A pass over the constraints of a sub-step.
enum class Pass {
  Soft,   ///< constraints are soft and close their gaps
  Relax,  ///< the bodies have moved; points that push are to be at rest; those that slide get friction once more after that
  Last,   ///< Relax, and the impulses of the sub-step are added to the sums
};

class ContactLanes {
  // Where there are many points, a pass waits for memory. So rows hold arms, from which passes find how bodies turn, and what
  // passes do not read is kept beside the rows and bundles, but for the gap, which makes a row of whole lines of the cache.
  /// Along the normal. Mass, arms and impulse are zero in lanes without such a point: nothing happens there.
  struct NormalRow {
    NormalRow() {}             // not "= default": a vector would clear what is about to be filled in
    Lanes arm_i[3], arm_j[3];  // r_i and r_j of SolverPoint, in the frame of the contact
    Lanes mass, open, impulse, gap;
  };
  struct FrictionRow {
    FrictionRow() {}
    Lanes mass11, mass12, mass22, rho;
    Lanes impulse1, impulse2;
  };
  /// The impulses since the points were found, which passes do not read.
  struct SumRow {
    SumRow() {}
    Lanes n, t1, t2;
  };
  /// Four pairs of a level. The k-th points of them make a row.
  struct Bundle {
    std::array<SolverBody*, kLanes> i, j;
    std::array<SolverBody*, kLanes> to_i,
        to_j;                         // that get the velocities: what impulses do not move is not written to
    std::array<Index, kLanes> block;  // in the contacts; kNone: this lane is empty
    Lanes frame[3][3];                // n, t1, t2: the frame of the contact
    Lanes mu, push, inv_mass_i, inv_mass_j;
    Lanes inv_inertia_i[6], inv_inertia_j[6];  // in that frame, as lanes::turn() takes them
    int size;
    bool has_friction;
    bool has_axes;                 // of revolution
    std::size_t normal, friction;  // its first rows
    std::size_t region;
  };
  /// How the bodies of a bundle lay when its points were found, in its frame.
  struct Start {
    Lanes turned_i[3], turned_j[3];  // the surfaces
    Lanes shift;                     // along n, of j against i, m
  };
  /// A bundle while a pass solves it, in the frames of its contacts but for what is read from bodies and written to them.
  struct InPass {
    Lanes v[6], w_W[6];            // velocities and spins of i and j, m/s, rad/s
    Lanes u[3], w_i[3], w_j[3];    // of the centre of j against that of i; the spins
    Lanes first_i[3], first_j[3];  // the spins as they came
    Lanes total[3];                // of the changes of all impulses, N s
    Lanes inv_mass;                // of both, 1/kg
  };
  /// Softness, and the inverse of the length of a sub-step, 1/s.
  struct SoftLanes {
    Lanes bias, mass, impulse, per_second;
  };
  /// Axes of revolution, in the frame of their bundle.
  struct Axes {
    Lanes i[3], j[3];
  };

  /// Where the points of a block are.
  struct Place {
    Index bundle = kNone;  // kNone: it has none
    int lane = 0;
    int room = 0;  // most points that it can take: those that it had when it was placed
  };

 public:
  /// Their memory, which the next solve takes over.
  struct Stores {
    std::vector<Place> places;
    std::vector<Bundle> bundles;
    std::vector<Start> starts;  // by bundle
    std::vector<Axes> axes;     // by bundle
    std::vector<NormalRow> normal;
    std::vector<FrictionRow> friction;
    std::vector<SumRow> sums;  // beside `normal`
    PassRegions regions;
    // while they are scheduled
    std::vector<Index> level_of_body, level, key, first, ordered;
    std::vector<std::array<Index, 2>> before;  // by block: the last blocks before it that have its bodies
    std::vector<Index> last_of_body;
  };

  ContactLanes(SolverContacts& contacts, Stores& stores, Workers& workers)
      : contacts_(contacts),
        workers_(workers),
        stores_(stores),
        places_(stores.places),
        bundles_(stores.bundles),
        starts_(stores.starts),
        axes_(stores.axes),
        regions_(stores.regions),
        normal_(stores.normal),
        friction_(stores.friction),
        sums_(stores.sums) {
    for (Vec3* zero :
         {&nobody_.v, &nobody_.w, &nobody_.moved, &nobody_.turned, &nobody_.surface_turned, &nobody_.axis_W})
      zero->setZero();
    nobody_.inv_inertia_W.setZero();
  }
  ContactLanes(const ContactLanes&) = delete;
  ContactLanes& operator=(const ContactLanes&) = delete;

  /// Takes over the points of the contacts, when they have been found.
  void take();
  /// Has the points of the pairs found anew that have drifted since theirs were found. A pair that has more
  /// of them than when it got its place goes behind all others.
  void refresh(double now, double left);
  /// Gives the points of all blocks their impulses, their gaps and what resists there; or those of one.
  void writePoints();
  void writePoints(Index block);

  /// Gives the bodies the impulses of the last sub-step again.
  void warmStart();
  /// Multiplies the impulses of this sub-step by what `share` says of their block.
  void scaleImpulses(const std::function<double(const SolverBlock&)>& share);
  /// One pass over the pairs in a sub-step of length h, each with its friction first and its normal impulses
  /// then.
  void solve(Pass pass, const Softness& soft, double h);
  /// Measures, after the last sub-step, how far the points of each block are from the law of contact. `unit` is the speed of which
  /// residuals are shares, m/s.
  void measure(double unit);
  /// Calls `what` for each body, on the threads that have them in their caches.
  template <class What>
  void forBodies(const What& what) {
    if (regions_.count() == 1) {
      for (SolverBody& s : contacts_.bodies) what(s);
    } else {
      regions_.each(workers_, [&](std::size_t region) {
        for (const Index s : regions_.bodies(region)) what(contacts_.bodies[s]);
      });
    }
  }

 private:
  void schedule();
  void connectRegions();
  void append(std::size_t bundle, Index block, std::size_t region);
  bool accepts(const Bundle& bundle, const SolverBlock& block) const;
  void takeBundle(std::size_t bundle);
  void takeBlock(Place place);
  void findTurns(std::size_t bundle);
  void findMasses(std::size_t bundle, const std::array<bool, kLanes>& found);
  /// Calls `body` for all bundles, from `begin` to before `end`, in any order.
  void forBundles(const std::function<void(std::size_t begin, std::size_t end)>& body);
  /// The same for each bundle after those before it with which it shares a body that impulses move.
  void inOrder(const PassRegions::Body& body);
  void warmStart(std::size_t begin, std::size_t end);
  template <Pass kPass, bool kFriction>
  void solveBundles(std::size_t begin, std::size_t end, const Softness& soft, double h);
  void follow(std::size_t bundle);
  void read(const Bundle& bundle, InPass& pairs) const;
  void write(const Bundle& bundle, InPass& pairs) const;
  template <bool kMarks, bool kAgain>
  void solveFriction(const Bundle& bundle, InPass& pairs, LaneMask* slides);
  template <Pass kPass>
  void solveNormals(const Bundle& bundle, const Axes& axes, const SoftLanes& soft, InPass& pairs);
  void addToSums(const Bundle& bundle, bool has_friction);
  void measure(std::size_t bundle, double unit);

  SolverContacts& contacts_;
  Workers& workers_;
  Stores& stores_;
  SolverBody nobody_{};            // in empty lanes
  std::vector<SolverBody> sinks_;  // by region: get what is written to nobody
  std::vector<Place>& places_;     // by block
  std::vector<Bundle>& bundles_;
  std::vector<Start>& starts_;
  std::vector<Axes>& axes_;
  PassRegions& regions_;
  std::vector<NormalRow>& normal_;
  std::vector<FrictionRow>& friction_;
  std::vector<SumRow>& sums_;
};

}  // namespace rbs
