#include "bench_contact_ratios.h"

#include <fmt/format.h>

#include "cli/stop.h"
#include "report/table.h"

namespace palpate::cli {
namespace {

using Rows = std::vector<std::vector<std::string>>;

/// Returns "2.31 (0.87)": a time and its ratio to another; "-" if one was not measured.
std::string over(double ms, double other_ms) {
  return ms > 0.0 && other_ms > 0.0 ? fmt::format("{:.2f} ({:.2f})", ms, ms / other_ms) : "-";
}
std::string percent(double share) { return fmt::format("{:.3g}", 100.0 * share); }

void add_rows(const bench::ContactCost& p, Rows& rows, Rows& solves, Rows& tangents) {
  const bench::ContactBenchRow& c = p.row;
  const bench::FrictionPrice& f = p.friction;
  const std::string samples = fmt::format("{}", c.samples);
  rows.push_back({p.scene, samples, fmt::format("{:.2f}", c.elements_ms), over(c.assembly_ms, c.elements_ms),
                  fmt::format("{:.2f}", p.one_body_ms), over(c.to_forces.median, p.one_body_ms)});
  solves.push_back({p.scene, samples, fmt::format("{:.2f}", p.bodies_ms),
                    fmt::format("{:.2f}", p.contact_free_ms), over(c.step.median, p.bodies_ms),
                    over(c.step.median, p.contact_free_ms), over(f.symmetric_ms, c.step.median)});
  if (f.full_ms > 0.0)
    tangents.push_back({p.scene, fmt::format("{:.2f}", f.symmetric_ms), over(f.full_ms, f.symmetric_ms),
                        percent(f.left_out), percent(f.force_change)});
}

}  // namespace

void print_contact_prices(const std::vector<bench::ContactCost>& prices) {
  Rows rows, solves, tangents;
  for (const bench::ContactCost& p : prices) add_rows(p, rows, solves, tangents);
  fmt::print(
      "Cost of contact relative to a step: nearest points, one thread, medians [ms]\n"
      "  elements: forces and matrix of all elements of the first body in one pass; samples: contact "
      "samples, and their ratio to elements\n"
      "  step: a step of the first body without contact, linear_rtol 1e-3; query: contact query up to nodal "
      "forces, "
      "and its ratio to step\n"
      "{}\n",
      report::format_table({"scene", "samples", "elements", "samples (ratio)", "step", "query (ratio)"},
                           rows));
  fmt::print(
      "A step without its query, medians [ms]\n"
      "  apart: sum of separate steps of each body, without contact; free: a step of all bodies together, "
      "without contact;\n"
      "  contact: a step of the scene, and its ratios to apart and free; friction: with friction 0.3, ratio "
      "to contact\n"
      "  without contact the bodies fall under gravity, because a step at rest requires no solution\n"
      "{}\n",
      report::format_table({"scene", "samples", "apart", "free", "contact (/ apart)", "contact (/ free)",
                            "friction (/ contact)"},
                           solves));
  if (tangents.empty()) return;
  fmt::print(
      "A step with friction 0.3, without its query, medians [ms]\n"
      "  symmetric: friction lags the pressure by one step, friction_tangent = \"secant\", the default of "
      "such steps; full: unsymmetric tangent, ratio to symmetric\n"
      "  left out: largest neglected friction of a step, relative to the largest friction; force: largest "
      "difference of the contact force\n"
      "  between both runs at equal times, relative to the largest force [%]\n"
      "{}\n",
      report::format_table({"scene", "symmetric", "full (/ symmetric)", "left out [%]", "force [%]"},
                           tangents));
}

std::vector<bench::ContactGrowth> run_contact_growth() {
  constexpr int kSkin = 100000, kSteps = 6;
  constexpr double kFactor = 30.0;
  return {{"skin", bench::bench_skin_growth({10000, 30000, 100000, 300000, 1000000}, &stop_flag())},
          {"area", bench::bench_patch_growth(kSkin, kFactor, kSteps, &stop_flag())}};
}

void print_contact_growth(const std::vector<bench::ContactGrowth>& growth) {
  for (const bench::ContactGrowth& g : growth) {
    Rows rows;
    for (const bench::ContactGrowthRow& r : g.rows)
      rows.push_back({fmt::format("{}", r.skin_vertices), fmt::format("{:.4g}", 1e4 * r.area_m2),
                      fmt::format("{}", r.samples),
                      fmt::format("{:.2f} / {:.2f} / {:.2f}", r.query.least, r.query.median, r.query.p99)});
    const bool area = g.with == "area";
    fmt::print("{}\n{}\n  the query time grows with {} to the power {:.2f}\n\n",
               area ? "Contact regions of increasing area on one skin"
                    : "One contact region on skins of increasing size",
               report::format_table(
                   {"vertices", "region [cm^2]", "samples", "query: least / median / p99 [ms]"}, rows),
               area ? "the area of the region" : "the number of skin vertices", g.exponent());
  }
}

bool print_contact_bars(const std::vector<bench::ContactBar>& bars) {
  Rows rows;
  std::size_t missed = 0;
  for (const bench::ContactBar& b : bars) {
    if (!b.is_met()) ++missed;
    rows.push_back({b.scene.empty() ? "-" : b.scene, b.what, fmt::format("{:.3g}", b.value),
                    fmt::format("{} {:.3g}", b.at_least ? ">=" : "<=", b.bar),
                    b.is_met() ? "met" : "missed"});
  }
  fmt::print(
      "Acceptance limits: nearest points, one thread unless stated otherwise\n"
      "{}\n{} of {} limits met\n",
      report::format_table({"scene", "figure", "measured", "limit", ""}, rows), bars.size() - missed,
      bars.size());
  return missed == 0;
}

}  // namespace palpate::cli
