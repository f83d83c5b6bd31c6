// SPDX-License-Identifier: BSD-3-Clause
// Which routine finds the manifold of which pair of shapes is a matter of overloads: pairs.h has those of the
// pairs with a method of their own, convex.h and half_space.h the general ones. Each pair is written down in
// one order of its kinds, that of their names in Shape; in the other order A and B are swapped.
#include "narrowphase/collide.h"

#include "narrowphase/convex.h"
#include "narrowphase/half_space.h"
#include "narrowphase/pairs.h"

#include <utility>
#include <variant>

namespace rbs {

namespace {

template <class Kind, std::size_t index = 0>
constexpr std::size_t orderOf() {
  if constexpr (std::is_same_v<std::variant_alternative_t<index, Shape>, Kind>)
    return index;
  else
    return orderOf<Kind, index + 1>();
}

bool keepsAxis(const Shape& a, const Shape& b) {
  const auto keeps = [](const auto& kind_a, const auto& kind_b) {
    using A = std::decay_t<decltype(kind_a)>;
    using B = std::decay_t<decltype(kind_b)>;
    return orderOf<A>() <= orderOf<B>() ? kKeepsAxis<A, B> : kKeepsAxis<B, A>;
  };
  return std::visit(keeps, a, b);
}

}  // namespace

Manifold collide(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB, double margin) {
  const auto meet = [&](const auto& kind_a, const auto& kind_b) {
    using A = std::decay_t<decltype(kind_a)>;
    using B = std::decay_t<decltype(kind_b)>;
    if constexpr (orderOf<A>() <= orderOf<B>()) {
      return collidePair(kind_a, X_WA, kind_b, X_WB, margin);
    } else {
      Manifold manifold = collidePair(kind_b, X_WB, kind_a, X_WA, margin);
      manifold.n_W = -manifold.n_W;
      return manifold;
    }
  };
  return std::visit(meet, a, b);
}

Manifold collideAlong(const Gap& normal, const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB,
                      double margin) {
  const Vec3 middle_W = 0.5 * (normal.p_WA + normal.p_WB);
  const auto meet = [&](const auto& kind_a, const auto& kind_b) -> Manifold {
    using A = std::decay_t<decltype(kind_a)>;
    using B = std::decay_t<decltype(kind_b)>;
    if constexpr (std::is_same_v<A, Plane> || std::is_same_v<B, Plane>) {
      return {};
    } else if constexpr (orderOf<A>() <= orderOf<B>()) {
      const Quat q_AW = X_WA.q_WB.conjugate();
      const ConvexGap gap{normal.distance, q_AW * normal.n_W, q_AW * (middle_W - X_WA.p_WB)};
      return collideAlongPair(gap, kind_a, X_WA, kind_b, X_WB, margin);
    } else {
      const Quat q_BW = X_WB.q_WB.conjugate();
      const ConvexGap gap{normal.distance, q_BW * -normal.n_W, q_BW * (middle_W - X_WB.p_WB)};
      Manifold manifold = collideAlongPair(gap, kind_b, X_WB, kind_a, X_WA, margin);
      manifold.n_W = -manifold.n_W;
      return manifold;
    }
  };
  return std::visit(meet, a, b);
}

Manifold collide(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB, double margin,
                 SeparatingAxis& axis) {
  if (!keepsAxis(a, b)) return collide(a, X_WA, b, X_WB, margin);
  if (axis.separates(a, X_WA, b, X_WB, margin)) return {};
  Manifold manifold = collide(a, X_WA, b, X_WB, margin);
  if (manifold.size > 0) return manifold;
  axis.set(X_WA, manifold.n_W);
  return {};  // as if the axis had been known before
}

namespace {

Gap gapOf(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB, const Search& search) {
  const auto measure = [&](const auto& first, const Pose& X_WF, const auto& second, const Pose& X_WS) {
    if constexpr (kSearched<std::decay_t<decltype(first)>, std::decay_t<decltype(second)>>)
      return gapPair(first, X_WF, second, X_WS, search);
    else
      return gapPair(first, X_WF, second, X_WS);
  };
  const auto meet = [&](const auto& kind_a, const auto& kind_b) {
    using A = std::decay_t<decltype(kind_a)>;
    using B = std::decay_t<decltype(kind_b)>;
    if constexpr (orderOf<A>() <= orderOf<B>()) {
      return measure(kind_a, X_WA, kind_b, X_WB);
    } else {
      Gap gap = measure(kind_b, X_WB, kind_a, X_WA);
      gap.n_W = -gap.n_W;
      std::swap(gap.p_WA, gap.p_WB);
      return gap;
    }
  };
  return std::visit(meet, a, b);
}

}  // namespace

Gap gap(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB) {
  return gapOf(a, X_WA, b, X_WB, {});
}

Gap gap(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB, Simplex& kept) {
  return gapOf(a, X_WA, b, X_WB, {std::numeric_limits<double>::infinity(), &kept});
}

namespace {

bool areWithin(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB, double margin, Vec3& n_W) {
  const auto meet = [&](const auto& kind_a, const auto& kind_b) {
    using A = std::decay_t<decltype(kind_a)>;
    using B = std::decay_t<decltype(kind_b)>;
    if constexpr (orderOf<A>() <= orderOf<B>()) {
      return withinPair(kind_a, X_WA, kind_b, X_WB, margin, n_W);
    } else {
      const bool within = withinPair(kind_b, X_WB, kind_a, X_WA, margin, n_W);
      n_W = -n_W;
      return within;
    }
  };
  return std::visit(meet, a, b);
}

}  // namespace

bool areWithin(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB, double margin) {
  Vec3 n_W = Vec3::Zero();
  return areWithin(a, X_WA, b, X_WB, margin, n_W);
}

bool areWithin(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB, double margin,
               SeparatingAxis& axis) {
  if (!keepsAxis(a, b)) return areWithin(a, X_WA, b, X_WB, margin);
  if (axis.separates(a, X_WA, b, X_WB, margin)) return false;
  Vec3 n_W = Vec3::Zero();
  const bool within = areWithin(a, X_WA, b, X_WB, margin, n_W);
  if (!within) axis.set(X_WA, n_W);
  return within;
}

}  // namespace rbs
