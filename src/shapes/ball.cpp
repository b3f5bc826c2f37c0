#include "ball.h"

#include "contour.h"

namespace palpate::shapes {

Shape make_ball(const Resolution& resolution) {
  constexpr double kRadius = 0.03;
  Shape shape;
  shape.name = "ball";
  shape.tetrahedra = 1500;
  shape.inside = [](const Vec3& p) { return p.norm() - kRadius; };
  Blueprint plan;
  plan.inside = shape.inside;
  plan.low = Vec3::Constant(-1.2 * kRadius);
  plan.high = Vec3::Constant(1.2 * kRadius);
  plan.lattice = 0.1 * kRadius;
  shape.base = contour(plan, resolution.base_vertices);
  shape.skin = contour(plan, resolution.skin_vertices);
  return shape;
}

}  // namespace palpate::shapes
