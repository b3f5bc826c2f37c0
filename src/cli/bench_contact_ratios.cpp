#include "bench_contact_ratios.h"

#include <fmt/format.h>

#include "palpate/bench/contact.h"
#include "palpate/bench/fem.h"
#include "palpate/report/table.h"
#include "stop.h"

namespace palpate::cli {
namespace {

using Rows = std::vector<std::vector<std::string>>;

/// "2.31 (0.87)": a time and how much of another it is; "-" where one was not measured.
std::string over(double ms, double other_ms) {
  return ms > 0.0 && other_ms > 0.0 ? fmt::format("{:.2f} ({:.2f})", ms, ms / other_ms) : "-";
}

void print_growth(const std::string& what, const std::string& of,
                  const std::vector<bench::ContactGrowthRow>& growth,
                  double (*size)(const bench::ContactGrowthRow&)) {
  Rows rows;
  std::vector<std::pair<double, double>> points;
  for (const bench::ContactGrowthRow& r : growth) {
    rows.push_back({fmt::format("{}", r.skin_vertices), fmt::format("{:.4g}", 1e4 * r.area_m2),
                    fmt::format("{}", r.samples),
                    fmt::format("{:.2f} / {:.2f} / {:.2f}", r.query.least, r.query.median, r.query.p99)});
    points.emplace_back(size(r), r.query.median);
  }
  fmt::print("{}\n{}\n  the query's time grows with {} to the power {:.2f}\n\n", what,
             report::format_table(
                 {"vertices", "region [cm^2]", "samples", "query: least / median / p99 [ms]"}, rows),
             of, bench::scaling_exponent(points));
}

}  // namespace

void print_contact_prices(const std::vector<scene::Description>& descriptions) {
  Rows rows, solves;
  for (const scene::Description& description : descriptions) {
    if (stop_flag()) return;
    const bench::ContactPrice p = bench::bench_contact_price(description, &stop_flag());
    const bench::ContactBenchRow& c = p.contact;
    const std::string of = fmt::format("{} / {:.1f}", c.samples, c.regions);
    rows.push_back({description.name, of, fmt::format("{:.2f}", c.elements_ms),
                    over(c.assembly_ms, c.elements_ms), fmt::format("{:.2f}", p.one_body_ms),
                    over(c.query.median, p.one_body_ms)});
    solves.push_back({description.name, of, fmt::format("{:.2f}", p.bodies_ms),
                      fmt::format("{:.2f}", p.contact_free_ms), over(c.step.median, p.bodies_ms),
                      over(c.step.median, p.contact_free_ms), over(p.friction_ms, c.step.median)});
  }
  fmt::print(
      "Contact beside the rest of a step: one thread, pixels as the scene wants them, medians [ms]\n"
      "  elements: forces and matrix over the first body's elements in one pass; samples: those of the "
      "contact, and over the elements'\n"
      "  step: a step of the first body without contact, 1e-3; query: the contact's, and over that "
      "step\n{}\n",
      report::format_table(
          {"scene", "samples / regions", "elements", "samples (ratio)", "step", "query (ratio)"}, rows));
  fmt::print(
      "A step without its query, medians [ms]\n"
      "  apart: the sum of steps of each body by itself, without contact; free: a step of all bodies "
      "together, without contact;\n"
      "  contact: the scene's own step, over apart and over free; friction: with friction 0.3, over contact\n"
      "  without contact the bodies fall under their weight: at rest there is nothing to solve\n{}\n",
      report::format_table({"scene", "samples / regions", "apart", "free", "contact (/ apart)",
                            "contact (/ free)", "friction (/ contact)"},
                           solves));
}

void print_contact_growth() {
  print_growth("A contact region on larger and larger skins, 256 pixels", "the skin's vertices",
               bench::bench_skin_growth({10000, 30000, 100000, 300000, 1000000}, &stop_flag()),
               [](const bench::ContactGrowthRow& r) { return static_cast<double>(r.skin_vertices); });
  const auto area = [](const bench::ContactGrowthRow& r) { return r.area_m2; };
  print_growth("Larger and larger regions of one skin, pixels for an error of 1e-3", "the region's area",
               bench::bench_patch_growth(100000, 30.0, 6, 0, &stop_flag()), area);
  print_growth("Larger and larger regions of one skin, 256 pixels", "the region's area",
               bench::bench_patch_growth(100000, 30.0, 6, 256, &stop_flag()), area);
}

}  // namespace palpate::cli
