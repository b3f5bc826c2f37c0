#include <algorithm>
#include <cmath>
#include <limits>

#include "b_bodies.h"
#include "cases.h"
#include "images.h"
#include "palpate/core/error.h"
#include "plates.h"

// Problem: contact by nearest points is the gradient of an energy (docs/theory/contact.md), so it does no
// work around a closed loop, for any two skins. The upper of two corrugated plates follows
//     (x1, h1) -> (x1, h2) -> (x2, h2) -> (x2, h1) -> (x1, h1).
//
// Exact answer: zero net work. Measured: net work over the largest force times the length of the loop, limit
// 1e-4, the quadrature error along the loop. Against a plane with a fixed normal the overlap V depends on h
// alone, and the work is zero up to rounding (limit 1e-10).
//
// Reported without a limit: an image has one normal n and the force k V along it. The force has no component
// along the plates although V changes as they slide, so it has no potential and does the work
//     W = k int_{h1}^{h2} (V(x1, h) - V(x2, h)) dh,     V from plates.h,
// up to the resolution of its vertices.

namespace palpate::validation {
namespace {

constexpr double kStiffness = 1e6;
constexpr double kSlideFrom = 0.1, kSlideTo = 0.45;  // x1, x2 [wavelengths].
constexpr int kParts = 24;                           // Parts per edge, each with two Gauss points.

enum class Way { kPoints, kImage, kPlane };

/// Returns the force on the upper plate at (x0, h) [N]. Fault "skin-normals": along the normals of the lower
/// skin instead of the lines through the points.
Vec3 force_at(const Plates& plates, Way way, double x0, double h, const std::string& fault) {
  const TriMesh upper = plates.upper(x0, h);
  SurfaceBody body(upper);
  const auto frame = contact::fixed_frame();
  std::unique_ptr<contact::SampleSource> source;
  if (way == Way::kPlane)
    source = contact::make_plane_source(body.surface, 0, frame, Vec3::Zero(), Vec3::UnitZ(), 1e-4);
  if (way == Way::kImage)
    source = contact::make_image_source(body.surface, plates.lower(), 0, frame,
                                        {.pixels = 192, .candidate_gap = 1e-4});
  if (way == Way::kPoints)
    source = contact::make_distance_source(body.surface, upper.vertices,
                                           contact::FrameSurface{plates.lower(), 0, frame},
                                           {.candidate_gap = 1e-4});
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

struct Loop {
  double work = 0.0, scale = 0.0;  ///< [J]; scale is the largest force times the length of the loop.
};

Loop around(const Plates& plates, Way way, const std::string& fault) {
  const double x1 = kSlideFrom * plates.wavelength, x2 = kSlideTo * plates.wavelength,
               h1 = 0.45 * plates.overlap_amplitude(x1), h2 = 0.05 * plates.overlap_amplitude(x1);
  const Eigen::Vector2d corner[5] = {{x1, h1}, {x1, h2}, {x2, h2}, {x2, h1}, {x1, h1}};
  Loop out;
  double largest = 0.0, length = 0.0;
  for (int edge = 0; edge < 4; ++edge) {
    const Eigen::Vector2d way_along = corner[edge + 1] - corner[edge];
    length += way_along.norm();
    for (int part = 0; part < kParts; ++part)
      for (const double at : {-std::sqrt(1.0 / 3.0), std::sqrt(1.0 / 3.0)}) {
        const Eigen::Vector2d p = corner[edge] + (part + 0.5 + 0.5 * at) / kParts * way_along;
        const Vec3 force = force_at(plates, way, p.x(), p.y(), fault);
        largest = std::max(largest, force.norm());
        out.work += 0.5 / kParts * (force.x() * way_along.x() + force.z() * way_along.y());
      }
  }
  out.scale = largest * length;
  return out;
}

std::vector<Measurement> run(const std::string& fault) {
  std::vector<Measurement> out;
  const Plates plates;
  const auto add = [&](const std::string& quantity, Way way, double bar, const std::string& note) {
    const Loop loop = around(plates, way, fault);
    out.push_back({.quantity = quantity,
                   .computed = loop.work / loop.scale,
                   .exact = 0.0,
                   .error = std::abs(loop.work / loop.scale),
                   .bar = bar,
                   .note = note});
  };
  add("nearest points: net work around the loop, over force x length", Way::kPoints, 1e-4, "");
  add("vertices over a plane: net work around the loop, over force x length", Way::kPlane, 1e-10, "");
  if (images_work() && fault.empty())
    add("image: net work around the loop, over force x length", Way::kImage,
        std::numeric_limits<double>::infinity(),
        "reported without acceptance limit: a force along one normal has no potential");
  say_what_is_skipped(out);
  return out;
}

}  // namespace

ValidationCase closed_loop() {
  return {.name = "closed-loop",
          .section = "B",
          .summary = "net work of contact around a closed loop: two corrugated plates, and one over a plane",
          .why =
              "contact that does net work around a loop drives rubbing bodies; the gradient of an energy "
              "does none (conservation of energy)",
          .quick = true,
          .run = run,
          .faults = {{"skin-normals", "nearest points: net work"}}};
}

}  // namespace palpate::validation
