// Why no direction near that of a stationary depth is shallower: what lets EPA stop at a round surface
// without covering it with chords.
//
// Let h(n) be the largest n.w over the points w of A - B. Along n*, at the depth U, the nearest features are
// spanned by points w_j of A - B with n*.w_j = U and weights l_j, sum l_j w_j = U n*. Where A is a solid of
// revolution about u, w_j lies on a circle of A - B, of the radius r_j of its point of A about u; likewise B.
// Let n turn by the angle t from n* towards the unit vector e, and b = n* x e. Along this great circle the
// support function of a circle satisfies h'' + h = k with
//   k = r (u.b)^2 / sin^3(n, u)  >=  r (u.b)^2 / sin^3(n*, u) turned by t,
// so that, with K_j the sum of this bound over both shapes and T = tan(t / 2),
//   h(n) - U  >=  sin t (max_j (e.w_j + K_j T) - U T).
// The bracket says: where the ball of radius U that touches the surface from inside rolls freely, nothing is
// shallower. At t = 0 this is the second-order condition for a minimum, so that it fails at no true minimum
// but those that tie. It is tested for all e at once:
// - one point: K(b) is a quadratic form on the plane across n*; its least value is at least U;
// - two points, at -x_1 and x_2 along the unit vector p across n*, S the smaller: with s = e.p, and the
//   least K of the two, s S + K(b) T >= U T for all s, or, with K weighted by l, K(b) >= U where s S < U T;
// - three points: with S the distance from U n* to the boundary of their triangle, S >= U T.
#pragma once

#include "narrowphase/gjk.h"

namespace rbs {

/// Whether no direction within `angle` (below pi) of `finished.n` is shallower than `depth`, by more than
/// `rounding`; false where that is not known. `finished.nearest` is reduced.
bool provesDepth(const Finished& finished, double depth, double angle, double rounding);

}  // namespace rbs
