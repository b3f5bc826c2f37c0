#include <cmath>

#include "a_reference_image.h"
#include "b_bodies.h"
#include "cases.h"
#include "image_backends.h"
#include "palpate/mesh/generators.h"

// Samples at the vertices of a sphere (radius R, centre at height c) in a plane z = 0, the normal along z.  A
// vertex's gap is its own height: exact.  Galoppo et al. (2007) read it from their images instead: the
// difference of two depths at the middles of pixels of edge h, interpolated between four of them.  With the
// gap over the plane
//     g(r) = c - sqrt(R^2 - r^2),     L = g_uu + g_vv = R^2/s^3 + 1/s,     s = sqrt(R^2 - r^2),
// a chord over h lies above g by h^2/12 g'' on average, bilinear interpolation by h^2/12 L, and the sphere's
// own facets, of edge l, by l^2/16 L (the mean of (l^2/3 - rho^2)/2 over an equilateral triangle is l^2/8,
// rho from its middle).  The sum is what that reading errs on average; its order in h is two.

namespace palpate::validation {
namespace {

constexpr double kRadius = 1.0, kDepth = 0.2, kInner = 0.45;  // the patch reaches to 0.6
constexpr int kSubdivisions = 120;

struct Scene {
  TriMesh sphere = mesh::sphere(kRadius, kSubdivisions), slab = mesh::box_surface(Vec3(6, 6, 1), {6, 6, 1});
  Scene() {
    sphere.vertices.row(2).array() += kRadius - kDepth;
    slab.vertices.row(2).array() -= 0.5;
  }
};

std::vector<contact::ContactSample> samples_of(const Scene& scene, contact::DepthBackend backend, int pixels,
                                               contact::SampleRule rule, contact::DepthReading depths,
                                               const std::string& fault) {
  SurfaceBody body(scene.sphere);
  contact::ImageOptions options;
  options.backend = backend;
  options.pixels = pixels;
  options.candidate_gap = 1e-3;
  options.samples = rule;
  options.depths = fault == "reads-triangles" ? contact::DepthReading::kTriangles : depths;
  std::vector<contact::ContactSample> samples;
  spoiled(contact::make_image_source(body.surface, scene.slab, 0, contact::fixed_frame(), options),
          [&](auto& all) {
            if (fault == "neighbours-depth")
              for (std::size_t i = 1; i < all.size(); ++i) all[i - 1].gap = all[i].gap;
          })
      ->query(body.state.view(), samples);
  return samples;
}

struct DepthError {
  double largest = 0.0, rms = 0.0, mean = 0.0;  ///< [R]
  double curvature = 0.0;                       ///< mean of L
  int count = 0;
};

DepthError error_of(const Scene& scene, const std::vector<contact::ContactSample>& samples) {
  DepthError out;
  for (const auto& s : samples) {
    const Vec3 x = sample_at(s, scene.sphere.vertices).a;
    const double r2 = x.head<2>().squaredNorm();
    if (r2 > kInner * kInner) continue;
    const double error = s.gap - x.z() / s.normal.z(), s1 = std::sqrt(kRadius * kRadius - r2);
    out.largest = std::max(out.largest, std::abs(error));
    out.rms += error * error;
    out.mean += error;
    out.curvature += kRadius * kRadius / (s1 * s1 * s1) + 1.0 / s1;
    ++out.count;
  }
  out.rms = std::sqrt(out.rms / out.count) / kRadius;
  out.mean /= out.count * kRadius;
  out.curvature /= out.count;
  out.largest /= kRadius;
  return out;
}

std::vector<Measurement> run(const std::string& fault) {
  using contact::DepthReading;
  std::vector<Measurement> out;
  const Scene scene;
  const double area = 4.0 * M_PI * kRadius * kRadius / static_cast<double>(scene.sphere.faces.cols()),
               edge_squared = 4.0 * area / std::sqrt(3.0);
  for (const contact::DepthBackend backend : image_backends(fault)) {
    const std::string name(contact::backend_name(backend));
    const DepthError own = error_of(
        scene, samples_of(scene, backend, 64, contact::SampleRule::kVertex, DepthReading::kTriangles, fault));
    out.push_back({.quantity = name + ": depth of vertices on the triangle opposite, largest error/R",
                   .computed = own.largest,
                   .error = own.count > 1500 ? own.largest : std::nan(""),
                   .bar = 1e-12,
                   .note = fmt::format("{} vertices; RMS {:.1e}", own.count, own.rms)});
    std::vector<double> h, rms;
    DepthError last;
    for (const int pixels : {16, 24, 32, 48}) {
      const auto middles =
          samples_of(scene, backend, pixels, contact::SampleRule::kPixel, DepthReading::kTriangles, fault);
      h.push_back(std::sqrt(middles.at(0).area));
      last = error_of(scene, samples_of(scene, backend, pixels, contact::SampleRule::kVertex,
                                        DepthReading::kInterpolated, fault));
      rms.push_back(last.rms);
    }
    const double theory = (h.back() * h.back() / 12.0 + edge_squared / 16.0) * last.curvature;
    out.push_back({.quantity = name + ": depth of vertices as the paper reads it, mean error/R",
                   .computed = last.mean,
                   .exact = theory,
                   .error = std::abs(last.mean - theory) / theory,
                   .bar = 0.03,
                   .order = fitted_order(h, rms),
                   .order_low = 1.8,
                   .order_high = 2.1,
                   .note = fmt::format("48 pixels an edge; RMS/R {:.1e}, largest {:.1e}; order of the RMS "
                                       "error over 16 to 48 pixels",
                                       last.rms, last.largest)});
  }
  say_what_is_skipped(out);
  return out;
}

}  // namespace

ValidationCase paper_depths() {
  return {.name = "paper-depths",
          .section = "A",
          .summary =
              "depths of vertices: on the triangle opposite, and interpolated between pixels as in the paper",
          .why =
              "what the paper's reading of its images costs in accuracy, beside the exact depth at the same "
              "vertices (mean error of bilinear interpolation, in closed form)",
          .quick = true,
          .run = run,
          .faults = {{"reads-triangles", "as the paper reads it"},
                     {"neighbours-depth", "on the triangle opposite"}}};
}

}  // namespace palpate::validation
