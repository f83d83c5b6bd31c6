// SPDX-License-Identifier: BSD-3-Clause
// Proof that no direction near a refined one is shallower than a depth U. It lets EPA stop at a round surface
// without covering it with chords.
//
// Let h(n) be the largest n.w over the points w of A - B, and n a direction along which features of A - B lie
// at H = h(n), H >= U, with points w_j on them. Where A is a solid of revolution about u, w_j lies on a
// circle of A - B, of the radius r_j of its point of A about u; likewise B. Let the direction turn by the
// angle t from n towards the unit vector e across it, and b = n x e. Along this great circle the support
// function of a circle satisfies h'' + h = k with
//   k = r (u.b)^2 / sin^3(n, u)  >=  r (u.b)^2 / sin^3(n, u) turned by t,
// so that, with K_j the sum of this bound over both shapes and T = tan(t / 2),
//   (1 + T^2) (h - U)  >=  H - U + 2 T max_j (e.w_j + K_j T) - (H + U) T^2.
// Where U n is spanned by the points this says: where the ball of radius U that touches the surface from
// inside rolls freely, nothing is shallower. For T = 0 it is the second-order condition for a minimum, so
// that it fails at no true minimum but those that tie; and where directions around an axis tie, it holds
// beside the least of them too. It is tested for all e at once:
// - a flat side of which the disc of radius S about U n is part: e.w is at least S for some w;
// - one point, at w: K(b) is a quadratic form on the plane across n, and e.w is at least -g, g its distance
// from the
//   line along n;
// - two points, at -x_1 and x_2 along the unit vector p across n, S the smaller, at most g off it: with s =
// |e.p|
//   the largest e.w_j is at least s S - g, with the least K of the two; or at least -g with K weighted so
//   that the points span nothing along p, which is asked for small s only.
#pragma once

#include "narrowphase/gjk.h"

namespace rbs {

/// Whether no direction within `angle` (below pi) of `finished.n`, along which A - B reaches `height`, is
/// shallower than `depth`, by more than `rounding`; false where that is not known. `finished.nearest` is
/// reduced.
bool provesDepth(const Finished& finished, double height, double depth, double angle, double rounding);

/// How far from the circle of the belt, in rad, no direction is shallower than `depth`, by more than
/// `rounding`; 0 where that is not known. With t that angle and h >= H cos t + S sin t, it is the case of the
/// disc.
double provenWidth(const Belt& belt, double depth, double rounding);

}  // namespace rbs
