#include <cmath>

#include "b_bodies.h"
#include "cases.h"
#include "image_backends.h"
#include "palpate/core/error.h"
#include "plates.h"

// The force between two skins is k V along n, V their overlap: it has no part along the plates, though V
// changes when they slide.  So it has no potential.  Moved around a loop the upper plate gains
//     W = closed integral of F.dx = k closed integral of V dh,
// for the loop  (x1, h1) -> (x1, h2) -> (x2, h2) -> (x2, h1) -> (x1, h1):
//     W = k int_{h1}^{h2} (V(x1, h) - V(x2, h)) dh,
// V(x0, h) from plates.h.  This is a property of the law, not an error: a scene that rubs rough on rough may
// not count on contact energy.  Against a plane with a fixed normal V depends on h alone, and W is zero.

namespace palpate::validation {
namespace {

constexpr double kStiffness = 1e6;
constexpr double kSlideFrom = 0.1, kSlideTo = 0.45;  // x1, x2 in wavelengths
// Gauss-Legendre, six points on [-1, 1]
constexpr int kGauss = 6;
constexpr double kPoint[kGauss] = {-0.932469514203152, -0.661209386466265, -0.238619186083197,
                                   0.238619186083197,  0.661209386466265,  0.932469514203152};
constexpr double kWeight[kGauss] = {0.171324492379170, 0.360761573048139, 0.467913934572691,
                                    0.467913934572691, 0.360761573048139, 0.171324492379170};

/// Force on the upper plate at (x0, h), per unit stiffness: from an image of both, or over the plane z = 0.
/// Fault "skin-normals": along the lower skin's own normals instead of the common one.
Vec3 force_at(const Plates& plates, contact::DepthBackend backend, bool plane, double x0, double h,
              const std::string& fault) {
  SurfaceBody body(plates.upper(x0, h));
  const auto frame = contact::fixed_frame();
  contact::ImageOptions options;
  options.backend = backend;
  options.pixels = 192;
  options.candidate_gap = 1e-4;
  auto source = plane ? contact::make_plane_source(body.surface, 0, frame, Vec3::Zero(), Vec3::UnitZ(), 1e-4)
                      : contact::make_image_source(body.surface, plates.lower(), 0, frame, options);
  if (fault == "skin-normals")
    source = spoiled(std::move(source), [&](auto& samples) {
      const double q = plates.wave_number();
      for (auto& s : samples)
        s.normal = Vec3(-plates.amplitude * q * std::cos(q * s.b.offset.x()), 0.0, 1.0).normalized();
    });
  contact::ContactForce term;
  term.add_frame(frame);
  ContactSpec law;
  law.stiffness_pa_m = kStiffness;
  term.add_pair(std::move(source), law);
  term.refresh(body.state.view());
  return -term.frame_wrench(body.state.view(), 0).force;
}

std::vector<Measurement> run(const std::string& fault) {
  std::vector<Measurement> out;
  Plates plates;
  plates.cells = 80;
  const double x1 = kSlideFrom * plates.wavelength, x2 = kSlideTo * plates.wavelength;
  const double h1 = 0.45 * plates.overlap_amplitude(x1), h2 = 0.05 * plates.overlap_amplitude(x1);
  const auto along = [](double from, double to, const auto& f) {
    double sum = 0.0;
    for (int i = 0; i < kGauss; ++i)
      sum += 0.5 * (to - from) * kWeight[i] * f(0.5 * (from + to) + 0.5 * (to - from) * kPoint[i]);
    return sum;
  };
  const double exact =
      kStiffness * along(h1, h2, [&](double h) { return plates.volume(x1, h) - plates.volume(x2, h); });
  const auto work = [&](contact::DepthBackend backend, bool plane) {
    const auto lift = [&](double x0) {
      return [&, x0](double h) { return force_at(plates, backend, plane, x0, h, fault).z(); };
    };
    const auto slide = [&](double h) {
      return [&, h](double x0) { return force_at(plates, backend, plane, x0, h, fault).x(); };
    };
    return along(h1, h2, lift(x1)) + along(x1, x2, slide(h2)) + along(h2, h1, lift(x2)) +
           along(x2, x1, slide(h1));
  };
  for (const contact::DepthBackend backend : image_backends(fault)) {
    const double net = work(backend, false);
    out.push_back({.quantity = std::string(contact::backend_name(backend)) +
                               ": net work around the loop, plate on plate [J]",
                   .computed = net,
                   .exact = exact,
                   .error = std::abs(net / exact - 1.0),
                   .bar = 1e-2,
                   .note = "not zero by the law: the force has no part along the plates"});
  }
  const double net = work(contact::DepthBackend::kCpu, true);
  out.push_back({.quantity = "net work around the same loop over a plane, over that between the plates",
                 .computed = net / std::abs(exact),
                 .exact = 0.0,
                 .error = std::abs(net / exact),
                 .bar = 1e-10});
  say_what_is_skipped(out);
  return out;
}

}  // namespace

ValidationCase closed_loop() {
  return {
      .name = "closed-loop",
      .section = "B",
      .summary = "net work of contact around a closed loop: corrugated plates, and one of them over a plane",
      .why =
          "force along a common normal is conservative against a plane, not between two rough skins; how "
          "much it is not has a closed form (k times the loop integral of V dh)",
      .quick = true,
      .run = run,
      .faults = {{"skin-normals", "net work"}}};
}

}  // namespace palpate::validation
