#include "head.h"

#include <algorithm>
#include <cmath>

#include "contour.h"
#include "face.h"
#include "solids.h"

// Skull, face and jaw are smooth unions of ellipsoids and limbs; the details of face.cpp are added in a
// sculptor's order, from the sockets to the skin.
namespace palpate::shapes {
namespace {

constexpr double kScale = 1e-3;  // metres per millimetre: 0.24 m from chin to crown

double skull(const Vec3& p) {
  double d = ellipsoid(p, {0, 12, 34}, {75.5, 95, 81});               // cranium
  d = join(d, ellipsoid(p, {0, -36, 40}, {61, 51, 52}), 12.0);        // forehead
  d = join(d, ellipsoid(p, {0, 44, 0}, {58, 58, 54}), 12.0);          // back of the head
  d = join(d, ellipsoid(p, {0, -41, -30}, {57, 48, 66}), 14.0);       // face
  d = join(d, limb(p, {45, -61, -22}, {62, -20, -14}, 12, 8), 18.0);  // cheekbone
  d = join(d, ellipsoid(p, {40, -44, -46}, {20, 28, 30}), 16.0);      // cheek
  // jaw: branch, body, chin
  d = join(d, limb(p, {53, 4, -25}, {45, -4, -70}, 13, 12), 16.0);
  d = join(d, limb(p, {45, -4, -70}, {13, -72, -103}, 12, 12.5), 16.0);
  d = join(d, ellipsoid(p, {0, -79, -103}, {19, 14, 16}), 12.0);
  d = join(d, ellipsoid(p, {0, -30, -84}, {42, 48, 27}), 12.0);     // below the mouth
  return join(d, ellipsoid(p, {0, -71, -66}, {33, 25, 33}), 14.0);  // muzzle
}

double neck(const Vec3& p) {
  double d = limb(p, {0, 26, -60}, {0, 32, -200}, 49, 53);
  // sternocleidomastoid
  d = join(d, limb(p, {54, 30, -45}, {14, -20, -200}, 9, 11), 16.0);
  d = join(d, limb(p, {26, 58, -60}, {46, 58, -200}, 12, 24), 24.0);  // trapezius
  return join(d, ellipsoid(p, {0, -25, -138}, {9, 9, 15}), 14.0);     // larynx
}

}  // namespace

double head_mm(const Vec3& place, const HeadParts& parts) {
  const Vec3 p(std::abs(place.x()), place.y(), place.z());
  double d = skull(p);
  if (parts.neck) d = join(d, neck(p), 14.0);
  d = join(d, limb(p, {11, -88, 15}, {45, -75, 18}, 6.5, 5.0), 14.0);  // brow ridge
  d = with_eye(d, p, parts.fine);
  d = with_nose(d, p, parts.fine);
  d = with_mouth(d, p, parts.fine);
  if (parts.fine) {
    d -= eyebrow(p, parts.wavelength);
    if (parts.wavelength > 0.0 && std::abs(d) < 8.0) d -= skin_relief(p, parts.wavelength);
    d = with_hair(d, p, parts.wavelength);
  } else {
    d = join(d, ellipsoid(p, {0, 14, 37}, {79.0, 98.5, 82.5}), 10.0);
  }
  d = with_ear(d, p, parts.fine);
  if (parts.neck) d = meet(d, -186.0 - p.z(), 8.0);
  return d;
}

double head_size_mm(const Vec3& place) {
  const Vec3 p(std::abs(place.x()), place.y(), place.z());
  const auto near = [&](const Vec3& centre, double inner, double outer) {
    return 1.0 - ramp((p - centre).norm(), inner, outer);
  };
  double size = 1.0;
  size = std::min(size, 1.0 - 0.68 * near({32, -90, 0}, 17, 50));
  size = std::min(size, 1.0 - 0.40 * near({0, -98, -42}, 18, 45));
  size = std::min(size, 1.0 - 0.45 * near({12, -95, -68}, 18, 45));
  size = std::min(size, 1.0 - 0.50 * near({76, 19, -10}, 34, 60));
  return size;
}

Shape make_head(const Resolution& resolution) {
  const auto body = [](const HeadParts& parts) {
    return [parts](const Vec3& x) { return kScale * head_mm(x / kScale, parts); };
  };
  Shape shape;
  shape.name = "head";
  shape.tetrahedra = 10000;
  shape.inside = body({false, true, 0.0});
  Blueprint plan;
  plan.inside = shape.inside;
  plan.low = Vec3(-0.13, -0.14, -0.20);
  plan.high = Vec3(0.13, 0.14, 0.14);
  plan.lattice = 0.003;
  plan.symmetric = true;
  shape.base = contour(plan, resolution.base_vertices);
  // The shortest wavelength of the relief is three edges.  The factor 0.30 is 0.19 m^2 of surface plus about
  // half as much for the refinement.
  const double edge_mm = std::sqrt(2.0 / std::sqrt(3.0) * 0.30 / resolution.skin_vertices) / kScale;
  plan.inside = body({true, true, 3.0 * edge_mm});
  plan.size = [](const Vec3& x) { return head_size_mm(x / kScale); };
  plan.lattice = std::min(0.0018, 0.65 * kScale * edge_mm);  // a finer mesh resolves narrower gaps
  plan.lipschitz = 2.0;
  shape.skin = contour(plan, resolution.skin_vertices);
  return shape;
}

}  // namespace palpate::shapes
