#include <algorithm>
#include <cmath>

#include "b_bodies.h"
#include "cases.h"
#include "image_backends.h"
#include "palpate/core/clock.h"
#include "palpate/core/error.h"
#include "palpate/mesh/generators.h"

// What pixels and facets cost, against the true sphere: radius R, held delta0 deep in a fixed plane,
//     F = k V,     V = pi delta0^2 (3 R - delta0)/3.
//
// Facets.  They lie inside the sphere by about h^2/(8 R) at each place of the patch: order 2, for any rule of
// samples.  A vertex's third of its triangles' area is the integral of the linear depth, but for triangles
// that the border of the patch crosses, where the depth is of order h over a part h of the patch: order 2
// again.
//
// Pixels.  A midpoint rule on a grid of edge h, shifted by s pixels, errs by what its lattice sees of the
// depth's transform g (Poisson's sum), and the mean square over all shifts is
//     sum over the integers m of the plane, m != 0, of g(2 pi |m|/h)^2.
// The depth falls to zero on the border, the circle of radius a, with slope sigma = a/(R - delta0), and is
// smooth inside, so that for large k
//     g(k) = 2 pi sigma a sqrt(2/(pi k a)) cos(k a - 5 pi/4)/k^2.
// The wave is the circle's own.  With an image just as wide as the circle and n pixels along it, the nearest
// lattice points, 4/5 of the sum, have k a = pi n: some n err by a third of what others do, and how many
// pixels an edge there are decides nothing.  So the mean is taken over kPhases equal parts of a pixel as
// well, by which the image is wider (a larger candidate gap), and cos^2 is 1/2:
//     RMS / V = 2 pi sigma a sqrt(S/(pi a)) (h/(2 pi))^(5/2) / V,
//     S = sum |m|^-5 = 4 zeta(5/2) beta(5/2) = 5.0903.
// Order 5/2, and a size that is known.  (A disc of constant depth, which jumps, has 3/2: flat-punch.)
//
// Both are measured on every backend with the other one small: 256 pixels under the facets' ladder; under the
// pixels' the volume is that of the facets, whose creases add some hundredths.  A ladder's time is that of a
// query whose image exists.

namespace palpate::validation {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kRadius = 0.02, kDepth = 0.004, kStiffness = 5e7;
constexpr double kVolume = kPi * kDepth * kDepth * (3.0 * kRadius - kDepth) / 3.0;
constexpr double kForce = kStiffness * kVolume;
constexpr double kCandidates = 1e-6;

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
  double pixel = 0.0;    ///< edge, of the rule kPixel [m]
  double seconds = 0.0;  ///< of a second query, where it is timed
};

struct Way {
  contact::DepthBackend backend;
  contact::SampleRule rule = contact::SampleRule::kPixel;
  int pixels = 256;
  GridShift shift{0.0, 0.0};
  double candidate_gap = kCandidates;  ///< [m]
  std::string name() const {
    return std::string(contact::backend_name(backend)) +
           (rule == contact::SampleRule::kPixel ? ", pixel" : ", vertex");
  }
};

Seen see(const Way& way, const TriMesh& mesh, bool timed, const std::string& fault) {
  SurfaceBody body(mesh);
  const auto frame = contact::fixed_frame();
  TriMesh slab = mesh::box_surface(Vec3(6 * kRadius, 6 * kRadius, kRadius), {6, 6, 1});
  slab.vertices.row(2).array() -= 0.5 * kRadius;
  contact::ImageOptions options;
  options.backend = way.backend;
  options.samples = way.rule;
  options.pixels = way.pixels;
  options.candidate_gap = way.candidate_gap;
  options.shift_u = way.shift.u;
  options.shift_v = way.shift.v;
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
  out.pixel = std::sqrt(term.samples().front().area);
  return out;
}

/// Mean of six orientations of the facets.
Measurement facets(const Way& way, const std::string& fault) {
  constexpr int kOrientations = 6;
  std::vector<double> h, error, wall_s;
  double mean = 0.0;
  for (const int n : {16, 24, 32, 48}) {
    mean = 0.0;
    double seconds = 0.0;
    for (int i = 0; i < kOrientations; ++i) {
      const Seen seen = see(way, low_facets(n, i), true, fault);
      mean += seen.force / kOrientations;
      seconds += seen.seconds / kOrientations;
    }
    h.push_back(1.0 / n);
    error.push_back(std::abs(mean / kForce - 1.0));
    wall_s.push_back(seconds);
  }
  return {.quantity = way.name() + ": force, finest facets, mean of 6 orientations [N]",
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

/// Of pixels of the given edge, relative: the formula above.
double pixels_rms(double pixel) {
  constexpr double kLattice = 5.0903;  // S
  const double a = std::sqrt(2.0 * kRadius * kDepth - kDepth * kDepth), slope = a / (kRadius - kDepth);
  return 2.0 * kPi * slope * a * std::sqrt(kLattice / (kPi * a)) * std::pow(pixel / (2.0 * kPi), 2.5) /
         kVolume;
}

/// Candidate gap by which n pixels are as wide as the circle and `part` of a pixel.
double gap_of_phase(int n, double part) {
  const double a = std::sqrt(2.0 * kRadius * kDepth - kDepth * kDepth), wider = a * (n - 1) / (n - 1 - part);
  return kCandidates + kRadius - kDepth - std::sqrt(kRadius * kRadius - wider * wider);
}

/// RMS over shifts and phases of the grid, against the facets' own volume.
std::vector<Measurement> pixels(contact::DepthBackend backend, const TriMesh& mesh,
                                const std::string& fault) {
  constexpr int kPhases = 4;
  const double exact = kStiffness * volume_below_plane(mesh);
  std::vector<double> h, error, wall_s;
  double last = 0.0, theory = 0.0;
  for (const int n : {16, 24, 36, 54, 81}) {
    double squares = 0.0, expected = 0.0, pixel = 0.0, seconds = 0.0;
    for (int phase = 0; phase < kPhases; ++phase)
      for (int i = 0; i < kGridShifts; ++i) {
        const Seen seen = see({.backend = backend,
                               .pixels = n,
                               .shift = grid_shift(i),
                               .candidate_gap = gap_of_phase(n, static_cast<double>(phase) / kPhases)},
                              mesh, i == 0, fault);
        constexpr double kShare = 1.0 / (kPhases * kGridShifts);
        last = seen.force;
        squares += kShare * std::pow(last / exact - 1.0, 2);
        expected += kShare * std::pow(pixels_rms(seen.pixel), 2);
        pixel += kShare * seen.pixel;
        seconds += seen.seconds / kPhases;
      }
    h.push_back(pixel / kRadius);
    error.push_back(std::sqrt(squares));
    theory = std::sqrt(expected);
    wall_s.push_back(seconds);
  }
  const std::string name = Way{.backend = backend}.name();
  return {{.quantity = name + ": force, 81 pixels, RMS of 20 shifts and 4 phases [N]",
           .computed = last,
           .exact = exact,
           .error = error.back(),
           .bar = 1e-4,
           .order = fitted_order(h, error),
           .order_low = 2.4,
           .order_high = 2.6,
           .note = "order in pixel size over 16, 24, 36, 54, 81 along the edge: 5/2",
           .refinement = {"pixel / radius", h, error, wall_s}},
          {.quantity = name + ": that RMS, over the force",
           .computed = error.back(),
           .exact = theory,
           .error = std::abs(error.back() / theory - 1.0),
           .bar = 0.15,
           .note = "by the lattice sum; twenty shifts leave some hundredths of it"}};
}

std::vector<Measurement> run(const std::string& fault) {
  std::vector<Measurement> out;
  const TriMesh fine = low_facets(100, 0);
  for (const contact::DepthBackend backend : image_backends(fault)) {
    if (!fault.empty() && backend != contact::DepthBackend::kCpu) continue;
    for (const auto rule : {contact::SampleRule::kPixel, contact::SampleRule::kVertex})
      out.push_back(facets({.backend = backend, .rule = rule}, fault));
    for (Measurement& m : pixels(backend, fine, fault)) out.push_back(std::move(m));
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
      .faults = {{"skin-area", ": force, finest facets"}, {"shallow-lost", ": force, 81 pixels"}},
      .about_s = 30,
  };
}

}  // namespace palpate::validation
