// A box against a half-space: the heights of its corners.
#include "narrowphase/pairs.h"

namespace rbs {

namespace {

// Height of the box's centre over the plane, and of its three half edges.
struct Heights {
  Mat3 half_edges_W;  // as columns
  Vec3 up_W, edges;
  double centre;

  Heights(const Box& box, const Pose& X_WA, const Pose& X_WP)
      : half_edges_W(X_WA.q_WB.toRotationMatrix() * (0.5 * box.size).asDiagonal()),
        up_W(X_WP.q_WB * Vec3::UnitZ()),
        edges(half_edges_W.transpose() * up_W),
        centre(up_W.dot(X_WA.p_WB - X_WP.p_WB)) {}
  double lowest() const { return centre - edges.cwiseAbs().sum(); }
};

}  // namespace

Gap gapBoxPlane(const Box& a, const Pose& X_WA, const Plane& /*b*/, const Pose& X_WB) {
  const Heights heights(a, X_WA, X_WB);
  const double lowest = heights.lowest();
  const Vec3 corner_W = X_WA.p_WB + heights.half_edges_W * -heights.edges.cwiseSign();
  return {lowest, -heights.up_W, corner_W, corner_W - lowest * heights.up_W};
}

Manifold collideBoxPlane(const Box& a, const Pose& X_WA, const Plane& /*b*/, const Pose& X_WB,
                         double margin) {
  const Heights heights(a, X_WA, X_WB);
  Manifold manifold;
  manifold.n_W = -heights.up_W;
  if (heights.lowest() > margin) return manifold;
  for (std::uint32_t corner = 0; corner < 8; ++corner) {
    const Vec3 signs(corner & 1 ? 1.0 : -1.0, corner & 2 ? 1.0 : -1.0, corner & 4 ? 1.0 : -1.0);
    const double height = heights.centre + signs.dot(heights.edges);
    if (height <= margin)
      manifold.add(X_WA.p_WB + heights.half_edges_W * signs - 0.5 * height * heights.up_W, height, corner);
  }
  return manifold;
}

}  // namespace rbs
