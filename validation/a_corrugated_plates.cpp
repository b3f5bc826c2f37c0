#include <cmath>

#include "b_bodies.h"
#include "cases.h"
#include "images.h"
#include "palpate/core/error.h"
#include "plates.h"

// Overlap of two corrugated plates: six lobes of a patch that no single dent makes.  Volume and area in
// closed form stand in plates.h, those of the facets too, so that the pixels and the facets are each held
// against their own truth.  Pixels: the volume has kinks along facets and border only (order above 2 as RMS
// over shifts of the grid), the area is counted (order 1.5).  Facets: order 2, as a chord has the sine's
// amplitude times 1 - (q h)^2/12.

namespace palpate::validation {
namespace {

constexpr double kShiftOfWave = 0.3;  // x0 in wavelengths: a whole number of cells

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
  // "gaps-as-depths": what is only near counts as touching; "sixteen-steps": a depth of few bits, cut off
  // downwards
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
  out.push_back({.quantity = "overlap volume against the sines, 80 cells a wavelength [m^3]",
                 .computed = last,
                 .exact = exact,
                 .error = error.back(),
                 .bar = 5e-3,
                 .order = fitted_order(cell, error),
                 .order_low = 1.9,
                 .order_high = 2.1,
                 .note = "order in facet size over 20 to 80 cells a wavelength",
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
          "rough on rough is the contact that images are for: several islands in one image, none of them "
          "lost or merged (closed form of the sines and of their facets)",
      .quick = true,
      .run = run,
      .faults = {{"gaps-as-depths", "overlap area against"}, {"sixteen-steps", "overlap volume against"}}};
}

}  // namespace palpate::validation
