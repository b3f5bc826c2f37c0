#pragma once
#include <vector>

#include "contact/contact_view.h"

namespace palpate::contact {

/// Two points of triangles, one above the other along the normal.
struct Facing {
  double u, v, w_a, w_b;      ///< [m]
  Vec3 weights_a, weights_b;  ///< of their corners
  double gap() const { return w_a - w_b; }
};

/// The triangles of a patch as functions of (u, v): each is prepared when a pixel first asks for it.
class FacePlanes {
 public:
  void start(const Patch& patch);  ///< forgets what was prepared
  /// Weights of the corners and height w of triangle `visible` at (u, v).  False where it is seen edge-on, or
  /// where (u, v) lies outside by more than a quarter of the triangle: the plane would be extrapolated too
  /// far.
  bool at(int visible, double u, double v, Vec3& weights, double& w);

 private:
  struct Plane {
    double u0, v0;          ///< corner 0
    double u1, v1, u2, v2;  ///< gradients of the weights of corners 1 and 2
    double w0, w1, w2;      ///< heights: of corner 0, of the others against it
  };
  enum class Kind : unsigned char { kUnknown, kEdgeOn, kPlain };
  Kind prepare(Plane& plane, int face) const;

  const Patch* patch_ = nullptr;
  std::vector<Plane> planes_;
  std::vector<Kind> kinds_;  ///< apart from the planes: it alone is written for faces that nobody asks for
};

}  // namespace palpate::contact
