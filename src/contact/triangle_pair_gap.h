#pragma once
#include <vector>

#include "contact/contact_view.h"

namespace palpate::contact {

/// Gap between two triangles along the normal: two points, one above the other.
struct TrianglePairGap {
  double u, v, w_a, w_b;      ///< Place in the plane, and heights of the two points [m].
  Vec3 weights_a, weights_b;  ///< Barycentric weights of the points.
  double gap() const { return w_a - w_b; }
};

/// Triangles of a patch as functions of (u, v); each is prepared at its first evaluation.
class FacePlanes {
 public:
  void start(const Patch& patch);  ///< Starts a new patch and discards prepared triangles.
  /// Computes the corners' weights and the height w of triangle `visible` at (u, v). Returns false where the
  /// triangle is seen edge-on, or where (u, v) lies outside by more than a quarter of the triangle: the plane
  /// would be extrapolated too far.
  bool at(int visible, double u, double v, Vec3& weights, double& w);

 private:
  struct Plane {
    double u0, v0;          ///< Corner 0.
    double u1, v1, u2, v2;  ///< Gradients of the weights of corners 1 and 2.
    double w0, w1, w2;      ///< Height of corner 0, and heights of the others relative to it.
  };
  enum class Kind : unsigned char { kUnknown, kEdgeOn, kPlain };
  Kind prepare(Plane& plane, int face) const;

  const Patch* patch_ = nullptr;
  std::vector<Plane> planes_;
  /// Separate from the planes: for triangles that are never evaluated only this is written.
  std::vector<Kind> kinds_;
};

}  // namespace palpate::contact
