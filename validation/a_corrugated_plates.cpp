#include <cmath>

#include "b_bodies.h"
#include "cases.h"
#include "images.h"
#include "palpate/core/error.h"
#include "plates.h"

// Problem: overlap of two corrugated plates, a patch with six lobes that no single dent produces.
//
// Exact answer: volume and area in closed form (plates.h), for the sines and for their facets, so that the
// errors of pixels and of facets are measured separately.
//
// Measured: against the facets, the pixels: the volume has kinks only along facet edges and the border (order
// above 2 as RMS over shifts of the grid), the area is a pixel count (order 1.5). Against the sines, the
// facets: order 2 (accepted: 1.9 to 2.1), as the amplitude of a chord is the sine's times 1 - (q h)^2/12.

namespace palpate::validation {
namespace {

constexpr double kShiftOfWave = 0.3;  // x0 [wavelengths]: a whole number of cells.

struct Sum {
  double volume = 0.0, area = 0.0;
};

Sum sampled(const Plates& plates, int pixels, const GridShift& shift, const std::string& fault) {
  const double x0 = kShiftOfWave * plates.wavelength;
  const double h = 0.2 * plates.overlap_amplitude(x0);
  SurfaceBody body(plates.upper(x0, h));
  contact::ImageOptions options;
  options.pixels = pixels;
  options.candidate_gap = 2e-3;
  options.shift_u = shift.u;
  options.shift_v = shift.v;
  const auto source =
      contact::make_image_source(body.surface, plates.lower(), 0, contact::fixed_frame(), options);
  std::vector<contact::ContactSample> samples = pixels_of(*source, body.state.view());
  // "gaps-as-depths": separated surfaces count as touching; "sixteen-steps": depths are quantised to 16 steps
  // per amplitude, rounded down.
  for (auto& s : samples) {
    if (fault == "gaps-as-depths") s.gap = -std::abs(s.gap);
    if (fault == "sixteen-steps")
      s.gap = std::ceil(s.gap * 16.0 / plates.amplitude) * plates.amplitude / 16.0;
  }
  Sum sum;
  for (const auto& s : samples) {
    if (s.gap >= 0.0) continue;
    sum.area += s.area;
    sum.volume -= s.gap * s.area;
  }
  return sum;
}

std::vector<Measurement> run(const std::string& fault) {
  std::vector<Measurement> out;
  const Plates plates;
  const double x0 = kShiftOfWave * plates.wavelength, h0 = 0.2 * plates.overlap_amplitude(x0);
  const double volume = plates.facet_volume(x0, h0), area = plates.facet_area(x0, h0);
  if (!images_work()) {
    say_what_is_skipped(out);
    return out;
  }
  out.push_back(over_pixels(
      {.quantity = "overlap volume against the facets' at 256 pixels, RMS over 20 shifts [m^3]",
       .exact = volume,
       .bar = 1e-3,
       .order_low = 1.9,
       .order_high = 3.5},
      {64, 128, 256},
      [&](int pixels, const GridShift& shift) { return sampled(plates, pixels, shift, fault).volume; }));
  out.push_back(over_pixels(
      {.quantity = "overlap area against the facets' at 256 pixels, RMS over 20 shifts [m^2]",
       .exact = area,
       .bar = 1e-2,
       .order_low = 0.9,
       .order_high = 2.5},
      {64, 128, 256},
      [&](int pixels, const GridShift& shift) { return sampled(plates, pixels, shift, fault).area; }));
  std::vector<double> cell, error;
  double last = 0.0;
  const double exact = plates.volume(x0, h0);
  for (const int cells : {20, 40, 80}) {
    Plates refined = plates;
    refined.cells = cells;
    last = sampled(refined, 512, {0.0, 0.0}, fault).volume;
    cell.push_back(1.0 / cells);
    error.push_back(std::abs(last / exact - 1.0));
  }
  out.push_back({.quantity = "overlap volume against the sines, 80 cells per wavelength [m^3]",
                 .computed = last,
                 .exact = exact,
                 .error = error.back(),
                 .bar = 5e-3,
                 .order = fitted_order(cell, error),
                 .order_low = 1.9,
                 .order_high = 2.1,
                 .note = "order in facet size over 20 to 80 cells per wavelength",
                 .refinement = {"cell / wavelength", cell, error}});
  return out;
}

}  // namespace

ValidationCase corrugated_plates() {
  return {
      .name = "corrugated-plates",
      .section = "A",
      .summary = "overlap volume and area of two corrugated plates, by the image's pixels",
      .why =
          "contact of two rough surfaces has several islands in one image; none may be lost or merged "
          "(closed form of the sines and of their facets)",
      .quick = true,
      .run = run,
      .faults = {{"gaps-as-depths", "overlap area against"}, {"sixteen-steps", "overlap volume against"}}};
}

}  // namespace palpate::validation
