#include <cmath>

#include "b_bodies.h"
#include "cases.h"
#include "images.h"
#include "palpate/core/error.h"
#include "palpate/mesh/generators.h"

// Problem: a corner of a box reaches the depth t below a plane. The plane's normal, in the axes of the box,
// is (n1, n2, n3), all components positive.
//
// Exact answer (right-angled tetrahedron): the three edges meet the plane at the distances t/n1, t/n2, t/n3
// from the corner, so
//     V = t^3/(6 n1 n2 n3),        area of the section, 3 V/t:   A = t^2/(2 n1 n2 n3).
//
// Measured: volume and area from the pixels, as RMS over shifts of the grid. The faces are flat, so that
// facets add no error. Pixels add one: the depth has kinks along the three edges and at the border (volume:
// order h^2.5), and the area is a pixel count (order h^1.5). The orders set the limits: volume at least 1.9
// and 1e-3 at 256 pixels, area at least 0.9.

namespace palpate::validation {
namespace {

constexpr double kReach = 0.3;
const Vec3 kSize(1.0, 1.2, 1.4);
const Vec3 kNormal = Vec3(0.55, 0.65, 0.5).normalized();  // Plane normal in the axes of the box.

struct Sum {
  double volume = 0.0, area = 0.0;
};

Sum sampled(int pixels, const GridShift& shift, const std::string& fault) {
  TriMesh box = mesh::box_surface(kSize, {3, 3, 3}), slab = mesh::box_surface(Vec3(6, 6, 1), {4, 4, 1});
  slab.vertices.row(2).array() -= 0.5;
  const Vec3 corner = -0.5 * kSize;
  const Mat3 turn = Quat::FromTwoVectors(kNormal, Vec3::UnitZ()).toRotationMatrix();
  box.vertices = ((turn * (box.vertices.colwise() - corner)).colwise() + Vec3(0.03, -0.04, -kReach)).eval();
  SurfaceBody body(box);
  contact::ImageOptions options;
  options.pixels = pixels;
  options.candidate_gap = 0.02;
  options.shift_u = shift.u;
  options.shift_v = shift.v;
  const auto source = contact::make_image_source(body.surface, slab, 0, contact::fixed_frame(), options);
  std::vector<contact::ContactSample> samples = pixels_of(*source, body.state.view());
  // "gaps-as-depths": separated surfaces count as touching; "conservative-pixels": every pixel that the
  // section touches counts as covered.
  for (auto& s : samples) {
    if (fault == "gaps-as-depths") s.gap = -std::abs(s.gap);
    if (fault == "conservative-pixels" && s.gap < 0.75 * std::sqrt(s.area)) s.gap = std::min(s.gap, -1e-12);
  }
  Sum sum;
  for (const auto& s : samples) {
    if (s.gap >= 0.0) continue;
    sum.volume -= s.gap * s.area;
    sum.area += s.area;
  }
  return sum;
}

std::vector<Measurement> run(const std::string& fault) {
  const double product = kNormal.prod(), volume = std::pow(kReach, 3) / (6.0 * product),
               area = kReach * kReach / (2.0 * product);
  std::vector<Measurement> out;
  if (images_work()) {
    const std::vector<int> pixels{32, 64, 128, 256};
    out.push_back(over_pixels(
        {.quantity = "volume of the corner at 256 pixels, RMS over 20 shifts [m^3]",
         .exact = volume,
         .bar = 1e-3,
         .order_low = 1.9,
         .order_high = 3.5},
        pixels, [&](int count, const GridShift& shift) { return sampled(count, shift, fault).volume; }));
    out.push_back(over_pixels(
        {.quantity = "area of the section at 256 pixels, RMS over 20 shifts [m^2]",
         .exact = area,
         .bar = 1e-2,
         .order_low = 0.9,
         .order_high = 2.0},
        pixels, [&](int count, const GridShift& shift) { return sampled(count, shift, fault).area; }));
  }
  say_what_is_skipped(out);
  return out;
}

}  // namespace

ValidationCase box_corner() {
  return {
      .name = "box-corner",
      .section = "A",
      .summary = "volume and area of a tilted box's corner in a plane, by the image's pixels",
      .why =
          "corners and edges cause kinks in an image; with flat facets, only the pixels contribute error "
          "(tetrahedron with a right-angled corner)",
      .quick = true,
      .run = run,
      .faults = {{"gaps-as-depths", "volume of the corner"}, {"conservative-pixels", "area of the section"}}};
}

}  // namespace palpate::validation
