#include <cmath>
#include <limits>

#include "a_reference_image.h"
#include "b_bodies.h"
#include "cases.h"
#include "images.h"
#include "palpate/core/error.h"
#include "palpate/mesh/generators.h"

// Problem: depth field along the contact normal n on the line p + t n, for a sphere on a plane and for two
// spheres.
//
// Exact answer (line and sphere, closed form): the line crosses a sphere (centre c, radius R) at
//     t = (c - p).n -/+ sqrt(R^2 - |c - p|^2 + ((c - p).n)^2),
// where it enters with the lower sign and leaves with the upper. With a above and b below, depth = t_b - t_a:
//     sphere on a plane, depth delta0:   sqrt(R^2 - r^2) - (R - delta0),
//     two spheres, centres d apart:      sqrt(R1^2 - r^2) + sqrt(R2^2 - r^2) - d,
// r measured from the line of centres, if n is along it. The contact region determines n, so the form for
// arbitrary n is used.
//
// Measured against the facets: the largest difference, at most 1e-6 R. The field has only rounding error, as
// the image decides which triangles face each other and their depth is computed in double precision. Where a
// single-precision image selects the neighbour of the right triangle, it does so within rounding of their
// common edge, where the surface is continuous, so that no accuracy is lost. Measured against the spheres:
// facet error. Vertices lie on the sphere, facets inside it by up to h^2/(8 R) per surface, hence order 2.
// The RMS over the patch excludes its rim, where a line along n is nearly tangent to the border of the
// overlap.

namespace palpate::validation {
namespace {

constexpr double kR1 = 1.0, kR2 = 0.8, kDistance = 1.5;  // The first sphere, above, is soft.
constexpr double kDepth = 0.2;                           // Depth of the first sphere in the plane.

/// Both surfaces of a pair. The true shape of the second is a sphere, or the plane z = 0.
struct Pair {
  std::string name;
  bool plane = false;
  TriMesh a, b;
  Vec3 centre_a, centre_b = Vec3::Zero();
};

Pair make_pair(bool plane, int subdivisions, int orientation) {
  Pair pair;
  pair.plane = plane;
  pair.name = plane ? "sphere on plane" : "two spheres";
  const auto rotated = [](TriMesh mesh, double angle, const Vec3& axis) {
    mesh.vertices = (Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix() * mesh.vertices).eval();
    return mesh;
  };
  pair.a = rotated(mesh::sphere(kR1, subdivisions), 0.4 + 0.9 * orientation, Vec3(1, 2, 3 - orientation));
  pair.centre_a = Vec3(0.013, -0.021, plane ? kR1 - kDepth : kDistance);
  if (plane) {
    pair.b = mesh::box_surface(Vec3(6, 6, 1), {6, 6, 1});
    pair.b.vertices.row(2).array() -= 0.5;
  } else {
    pair.b = rotated(mesh::sphere(kR2, subdivisions), 1.3 - 0.7 * orientation, Vec3(2 + orientation, -1, 1));
  }
  pair.a.vertices.colwise() += pair.centre_a;
  return pair;
}

/// Returns the depth of the true surfaces along n at the line through p; NaN where the line misses one of
/// them.
double true_depth(const Pair& pair, const Vec3& p, const Vec3& n) {
  const auto cut = [&](const Vec3& centre, double radius, double sign) {
    const Vec3 d = centre - p;
    const double along = d.dot(n);
    return along + sign * std::sqrt(radius * radius - d.squaredNorm() + along * along);
  };
  const double top = pair.plane ? -p.z() / n.z() : cut(pair.centre_b, kR2, 1.0);
  return top - cut(pair.centre_a, kR1, -1.0);
}

/// Applies a defect to an image: depths quantised to 16 bits of the slab, a row of pixels lost, or each pixel
/// with the depth of its neighbour.
void seed_defect(std::vector<contact::ContactSample>& samples, const std::string& fault) {
  if (fault == "sixteen-bits")
    for (auto& s : samples) s.gap = std::round(s.gap * 65536.0 / kDepth) * kDepth / 65536.0;
  if (fault == "neighbours-depth")
    for (std::size_t i = 1; i < samples.size(); ++i) samples[i - 1].gap = samples[i].gap;
  if (fault == "lost-samples") {
    std::size_t i = 0;
    std::erase_if(samples, [&](const auto&) { return ++i % 50 == 0; });
  }
}

std::vector<contact::ContactSample> samples_of(const Pair& pair, int pixels, const std::string& fault) {
  SurfaceBody body(pair.a);
  contact::ImageOptions options;
  options.pixels = pixels;
  options.candidate_gap = 1e-3;
  const auto source = contact::make_image_source(body.surface, pair.b, 0, contact::fixed_frame(), options);
  std::vector<contact::ContactSample> samples = pixels_of(*source, body.state.view());
  seed_defect(samples, fault);
  return samples;
}

/// Returns the RMS difference to the true field over the inner part of the patch, divided by R1.
double true_error(const Pair& pair, const std::vector<contact::ContactSample>& samples) {
  constexpr double kRim = 0.2;  // Fraction of the greatest depth.
  double deepest = 0.0, squares = 0.0;
  for (const auto& s : samples) deepest = std::max(deepest, -s.gap);
  int count = 0;
  for (const auto& s : samples) {
    const double exact = true_depth(pair, sample_at(s, pair.a.vertices).b, s.normal);
    if (!(exact > kRim * deepest)) continue;
    squares += std::pow(-s.gap - exact, 2);
    ++count;
  }
  return count > 0 ? std::sqrt(squares / count) / kR1 : std::nan("");
}

void measure(bool plane, const std::string& fault, std::vector<Measurement>& out) {
  {
    const Pair pair = make_pair(plane, 40, 0);
    const auto samples = samples_of(pair, 256, fault);
    const FieldError field = compare_fields(samples, pair.a, pair.b);
    out.push_back({.quantity = pair.name + ": depth field against the facets, largest difference/R",
                   .computed = field.inside / kR1,
                   .error = field.compared > 10000 ? field.inside / kR1 : std::nan(""),
                   .bar = 1e-6,
                   .note = fmt::format("{} pixels", field.compared)});
    out.push_back(
        {.quantity = pair.name + ": pixels missed or extra, more than one from the silhouette [count]",
         .computed = static_cast<double>(field.missed + field.extra),
         .error = static_cast<double>(field.missed + field.extra),
         .bar = 0.0,
         .note = fmt::format("{} missed, {} extra", field.missed, field.extra)});
  }
  std::vector<double> h, error;
  constexpr int kOrientations = 6;
  for (const int subdivisions : {12, 17, 24, 34, 48}) {
    double mean = 0.0;
    for (int i = 0; i < kOrientations; ++i) {
      const Pair pair = make_pair(plane, subdivisions, i);
      mean += true_error(pair, samples_of(pair, 128, fault)) / kOrientations;
    }
    h.push_back(1.0 / subdivisions);
    error.push_back(mean);
  }
  out.push_back({.quantity = std::string(plane ? "sphere on plane" : "two spheres") +
                             ": depth field against the true spheres, RMS/R, mean of 6 orientations",
                 .computed = error.back(),
                 .error = error.back(),
                 .bar = 1e-3,
                 .order = fitted_order(h, error),
                 .order_low = 1.9,
                 .order_high = 2.1,
                 .note = "order in facet size over 12 to 48 subdivisions of the icosahedron",
                 .refinement = {"facet / edge of the icosahedron", h, error}});
}

std::vector<Measurement> run(const std::string& fault) {
  std::vector<Measurement> out;
  if (images_work()) {
    measure(true, fault, out);
    measure(false, fault, out);
  }
  say_what_is_skipped(out);
  return out;
}

}  // namespace

ValidationCase spheres_field() {
  return {.name = "spheres-field",
          .section = "A",
          .summary =
              "depth fields of a sphere on a plane and of two spheres: facets to rounding, spheres to "
              "order 2",
          .why =
              "every force is computed from this field; a pixel that reads its neighbour, or a depth of few "
              "bits, causes spurious texture in the force (line and sphere, in closed form)",
          .quick = true,
          .run = run,
          .faults = {{"sixteen-bits", "against the facets"},
                     {"neighbours-depth", "depth field against"},
                     {"lost-samples", "missed or extra"}}};
}

}  // namespace palpate::validation
