#include <algorithm>
#include <cmath>

#include "b_bodies.h"
#include "cases.h"
#include "image_backends.h"
#include "palpate/core/clock.h"
#include "palpate/core/error.h"
#include "palpate/mesh/generators.h"

// What pixels and facets cost, against the true sphere: radius R, held delta0 deep in a fixed plane,
//     F = k pi delta0^2 (3 R - delta0)/3.
//
// Facets.  They lie inside the sphere by about h^2/(8 R) at each place of the patch: order 2, for any rule of
// samples.  A vertex's third of its triangles' area is the integral of the linear depth, but for triangles
// that the border of the patch crosses, where the depth is of order h over a part h of the patch: order 2
// again.
//
// Pixels.  Inside, where the depth is smooth, the midpoint rule errs by h^2 or less.  On the border the depth
// has a kink and no jump: each of about 1/h pixels there errs by its area, h^2, times h, with a sign that
// depends on where its middle falls, so that the root mean square over shifts of the grid is h^3 h^-1/2:
// order 5/2.  (A disc of constant depth, which jumps, has 3/2: flat-punch.)  A circle is no random border:
// the errors' size goes up and down with R/h about that line, so that the slope is fitted to eight sizes.
//
// Both are measured on every backend with the other one small: 256 pixels under the facets' ladder, facets of
// R/200 under the pixels'.  A ladder's time is that of a query whose image exists.

namespace palpate::validation {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kRadius = 0.02, kDepth = 0.004, kStiffness = 5e7;
const double kForce = kStiffness * kPi * kDepth * kDepth * (3.0 * kRadius - kDepth) / 3.0;

/// The part of a sphere's facets that may touch the plane z = 0, off every symmetry of the mesh.
TriMesh low_facets(int subdivisions, int orientation) {
  TriMesh all = mesh::sphere(kRadius, subdivisions), out;
  const Quat rotation(Eigen::AngleAxisd(0.37 + 1.1 * orientation, Vec3(1, 2 - orientation, 3).normalized()));
  all.vertices =
      (rotation.toRotationMatrix() * all.vertices).colwise() + Vec3(0.011, -0.007, kRadius - kDepth);
  std::vector<int> number(static_cast<std::size_t>(all.vertices.cols()), -1), vertices;
  std::vector<Eigen::Vector3i> faces;
  for (const auto& face : all.faces.colwise()) {
    const auto low = [&](int v) { return all.vertices(2, v) < 0.3 * kDepth; };
    if (!low(face[0]) && !low(face[1]) && !low(face[2])) continue;
    Eigen::Vector3i& renumbered = faces.emplace_back();
    for (int k = 0; k < 3; ++k) {
      int& n = number[static_cast<std::size_t>(face[k])];
      if (n < 0) {
        n = static_cast<int>(vertices.size());
        vertices.push_back(face[k]);
      }
      renumbered[k] = n;
    }
  }
  out.vertices = all.vertices(Eigen::all, vertices);
  out.faces =
      Eigen::Map<const Eigen::Matrix3Xi>(faces.front().data(), 3, static_cast<Eigen::Index>(faces.size()));
  return out;
}

struct Seen {
  double force = 0.0;    ///< [N]
  double seconds = 0.0;  ///< of a second query, where it is timed
};

Seen see(contact::DepthBackend backend, contact::SampleRule rule, const TriMesh& mesh, int pixels,
         const GridShift& shift, bool timed, const std::string& fault) {
  SurfaceBody body(mesh);
  const auto frame = contact::fixed_frame();
  TriMesh slab = mesh::box_surface(Vec3(6 * kRadius, 6 * kRadius, kRadius), {6, 6, 1});
  slab.vertices.row(2).array() -= 0.5 * kRadius;
  contact::ImageOptions options;
  options.backend = backend;
  options.samples = rule;
  options.pixels = pixels;
  options.candidate_gap = 1e-6;
  options.shift_u = shift.u;
  options.shift_v = shift.v;
  auto source =
      spoiled(contact::make_image_source(body.surface, slab, 0, frame, options), [&](auto& samples) {
        if (fault == "skin-area")
          for (auto& s : samples) s.area /= 1.0 - (kDepth + std::min(0.0, s.gap)) / kRadius;
        if (fault == "shallow-lost")
          std::erase_if(samples, [](const auto& s) { return s.gap > -0.05 * kDepth; });
      });
  contact::ContactForce term;
  term.add_frame(frame);
  ContactSpec law;
  law.stiffness_pa_m = kStiffness;
  term.add_pair(std::move(source), law);
  term.refresh(body.state.view());
  Seen out;
  if (timed) {
    const ScopedTimer timer(out.seconds);
    term.refresh(body.state.view());
  }
  out.force = -term.frame_wrench(body.state.view(), 0).force.z();
  return out;
}

/// Mean of six orientations of the facets.
Measurement facets(contact::DepthBackend backend, contact::SampleRule rule, const std::string& fault) {
  constexpr int kOrientations = 6;
  std::vector<double> h, error, wall_s;
  double mean = 0.0;
  for (const int n : {16, 24, 32, 48}) {
    mean = 0.0;
    double seconds = 0.0;
    for (int i = 0; i < kOrientations; ++i) {
      const Seen seen = see(backend, rule, low_facets(n, i), 256, {0.0, 0.0}, true, fault);
      mean += seen.force / kOrientations;
      seconds += seen.seconds / kOrientations;
    }
    h.push_back(1.0 / n);
    error.push_back(std::abs(mean / kForce - 1.0));
    wall_s.push_back(seconds);
  }
  return {.quantity = std::string(contact::backend_name(backend)) +
                      (rule == contact::SampleRule::kPixel ? ", pixel" : ", vertex") +
                      ": force, finest facets, mean of 6 orientations [N]",
          .computed = mean,
          .exact = kForce,
          .error = error.back(),
          .bar = 2e-3,
          .order = fitted_order(h, error),
          .order_low = 1.9,
          .order_high = 2.1,
          .note = "order in facet size over 16 to 48 subdivisions of the icosahedron",
          .refinement = {"facet / edge of the icosahedron", h, error, wall_s}};
}

/// RMS over shifts of the grid, on fine facets.
Measurement pixels(contact::DepthBackend backend, const TriMesh& mesh, const std::string& fault) {
  constexpr int kTimed = 4;
  std::vector<double> h, error, wall_s;
  double last = 0.0;
  for (const int pixels : {16, 18, 20, 22, 24, 27, 30, 34}) {
    double squares = 0.0, seconds = 0.0;
    for (int i = 0; i < kGridShifts; ++i) {
      const Seen seen =
          see(backend, contact::SampleRule::kPixel, mesh, pixels, grid_shift(i), i < kTimed, fault);
      last = seen.force;
      squares += std::pow(last / kForce - 1.0, 2) / kGridShifts;
      seconds += seen.seconds / kTimed;
    }
    h.push_back(1.0 / pixels);
    error.push_back(std::sqrt(squares));
    wall_s.push_back(seconds);
  }
  return {.quantity =
              std::string(contact::backend_name(backend)) + ", pixel: force, 34 pixels, RMS of 20 shifts [N]",
          .computed = last,
          .exact = kForce,
          .error = error.back(),
          .bar = 1e-3,
          .order = fitted_order(h, error),
          .order_low = 2.1,
          .order_high = 2.9,
          .note = "order in pixel size over eight sizes, 16 to 34",
          .refinement = {"pixel / edge of the image", h, error, wall_s}};
}

std::vector<Measurement> run(const std::string& fault) {
  std::vector<Measurement> out;
  const TriMesh fine = low_facets(224, 0);
  for (const contact::DepthBackend backend : image_backends()) {
    if (!fault.empty() && backend != contact::DepthBackend::kCpu) continue;
    out.push_back(facets(backend, contact::SampleRule::kPixel, fault));
    out.push_back(facets(backend, contact::SampleRule::kVertex, fault));
    out.push_back(pixels(backend, fine, fault));
  }
  say_what_is_skipped(out);
  return out;
}

}  // namespace

ValidationCase true_sphere() {
  return {
      .name = "true-sphere",
      .section = "B",
      .summary = "force of a sphere in a plane against the true sphere's: facets and pixels, each backend",
      .why =
          "a finer image of coarse facets, and a coarse image of fine ones, are no gain: both errors stand "
          "beside each other with their orders and times (volume of a spherical cap)",
      .slow = true,
      .run = run,
      .faults = {"skin-area", "shallow-lost"}};
}

}  // namespace palpate::validation
