#include <cmath>

#include "b_bodies.h"
#include "cases.h"
#include "images.h"
#include "palpate/core/error.h"
#include "palpate/mesh/generators.h"

// Problem: overlap volume of a sphere and a plane at the depth delta0.
//
// Exact answer for the sphere (spherical cap):
//     V = pi delta0^2 (3 R - delta0)/3.
// Exact answer for the facets: each triangle is clipped at the plane, and the depth, linear on the triangle,
// is integrated over the rest.
//
// Measured: the sum of depth x dA. Against the facets only the pixels contribute an error (limit 1e-4 at 256
// pixels, order at least 1.9); against the sphere the facets contribute it with order 2 (accepted: 1.9 to
// 2.1).

namespace palpate::validation {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kRadius = 1.0, kDepth = 0.2;
const Vec3 kCentre(0.013, -0.021, kRadius - kDepth);

TriMesh placed_sphere(int subdivisions, int orientation) {
  TriMesh mesh = mesh::sphere(kRadius, subdivisions);
  const Eigen::AngleAxisd turn(0.37 + 1.1 * orientation, Vec3(1, 2 - orientation, 3).normalized());
  mesh.vertices = ((turn.toRotationMatrix() * mesh.vertices).colwise() + kCentre).eval();
  return mesh;
}

double sampled(const TriMesh& mesh, int pixels, const GridShift& shift, const std::string& fault) {
  SurfaceBody body(mesh);
  TriMesh slab = mesh::box_surface(Vec3(6, 6, 1), {6, 6, 1});
  slab.vertices.row(2).array() -= 0.5;
  contact::ImageOptions options;
  options.pixels = pixels;
  options.candidate_gap = 1e-3;
  options.shift_u = shift.u;
  options.shift_v = shift.v;
  const auto source = contact::make_image_source(body.surface, slab, 0, contact::fixed_frame(), options);
  std::vector<contact::ContactSample> samples = pixels_of(*source, body.state.view());
  // "pixels-lost": one pixel in a hundred is dropped; "radial-depth": depth from the plane's point to the
  // nearest point on the sphere, as a distance query returns it.
  std::size_t i = 0;
  if (fault == "pixels-lost") std::erase_if(samples, [&](const auto&) { return ++i % 100 == 0; });
  if (fault == "radial-depth")
    for (auto& s : samples) s.gap = (s.b.offset - kCentre).norm() - kRadius;
  return overlap_volume(samples);
}

std::vector<Measurement> run(const std::string& fault) {
  std::vector<Measurement> out;
  const TriMesh mesh = placed_sphere(32, 0);
  const double facets = volume_below_plane(mesh),
               cap = kPi * kDepth * kDepth * (3.0 * kRadius - kDepth) / 3.0;
  if (!images_work()) {
    say_what_is_skipped(out);
    return out;
  }
  out.push_back(
      over_pixels({.quantity = "sum of depth x dA against the facets at 256 pixels, RMS over 20 shifts [m^3]",
                   .exact = facets,
                   .bar = 1e-4,
                   .order_low = 1.9,
                   .order_high = 3.5},
                  {64, 128, 256},
                  [&](int pixels, const GridShift& shift) { return sampled(mesh, pixels, shift, fault); }));
  std::vector<double> h, error;
  double mean = 0.0;
  constexpr int kOrientations = 6;
  for (const int subdivisions : {12, 17, 24, 34, 48}) {
    mean = 0.0;
    for (int i = 0; i < kOrientations; ++i)
      mean += sampled(placed_sphere(subdivisions, i), 128, {0.0, 0.0}, fault) / kOrientations;
    h.push_back(1.0 / subdivisions);
    error.push_back(std::abs(mean / cap - 1.0));
  }
  out.push_back(
      {.quantity = "sum of depth x dA against the true sphere, finest facets, mean of 6 orientations [m^3]",
       .computed = mean,
       .exact = cap,
       .error = error.back(),
       .bar = 5e-3,
       .order = fitted_order(h, error),
       .order_low = 1.9,
       .order_high = 2.1,
       .note = "order in facet size over 12 to 48 subdivisions of the icosahedron",
       .refinement = {"facet / edge of the icosahedron", h, error}});
  return out;
}

}  // namespace

ValidationCase volume_on_plane() {
  return {
      .name = "volume-on-plane",
      .section = "A",
      .summary = "overlap volume of a sphere and a plane: pixels against facets, facets against the sphere",
      .why = "the simplest overlap (closed form of a spherical cap)",
      .quick = true,
      .run = run,
      .faults = {{"pixels-lost", "against the facets"}, {"radial-depth", "against the true sphere"}}};
}

}  // namespace palpate::validation
