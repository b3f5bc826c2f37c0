#include "bench_contact.h"

#include <fmt/format.h>

#include "palpate/bench/contact.h"
#include "palpate/core/error.h"
#include "palpate/report/table.h"
#include "scene_of.h"
#include "stop.h"

namespace palpate::cli {
namespace {

std::vector<std::string> row_of(const bench::ContactBenchRow& r) {
  const auto ms = [](double value) { return fmt::format("{:.2f}", value); };
  return {r.variant.method,
          r.variant.pixels > 0 ? fmt::format("{}", r.variant.pixels) : "wanted",
          fmt::format("{}", r.variant.threads),
          fmt::format("{}", r.samples),
          fmt::format("{:.2f} / {:.2f} / {:.2f}", r.query.least, r.query.median, r.query.p99),
          ms(r.positions_ms),
          ms(r.regions_ms),
          ms(r.patches_ms),
          ms(r.images_ms),
          ms(r.gaps_ms),
          ms(r.grouping_ms),
          ms(r.force_ms),
          ms(r.tangent_ms),
          ms(r.linearise_ms),
          ms(r.solve_ms),
          fmt::format("{:.1f} / {:.1f}", r.period.median, r.period.p99),
          fmt::format("{:.2f}", r.real_time_factor())};
}

}  // namespace

void bench_contact(const BenchArguments& arguments) {
  const std::vector<std::string> scenes =
      arguments.scenes.empty() ? std::vector<std::string>{"touch-head", "touch-human", "two-pumpkins",
                                                          "two-heads", "scrape-pumpkin"}
                               : arguments.scenes;
  const std::vector<int> pixels = arguments.pixels.empty() ? std::vector<int>{0, 256} : arguments.pixels,
                         threads = arguments.threads.empty() ? std::vector<int>{1, 2} : arguments.threads;
  for (const std::string& scene : scenes) {
    const scene::Description description = scene_of({scene, {}, ""});
    std::vector<std::vector<std::string>> rows;
    bench::ContactBenchRow last;
    for (const std::string& method : arguments.methods)
      for (const int edge : pixels)
        for (const int count : threads) {
          if (stop_flag()) return;
          last = bench::bench_contact(description, {method, edge, count}, &stop_flag());
          rows.push_back(row_of(last));
        }
    fmt::print(
        "{}: {} tetrahedra, skin of {} vertices; medians of the {} exchange periods of {:g} ms in which "
        "something touches [ms]\n{}\n",
        short_name(description), last.tetrahedra, last.skin_vertices, last.periods, 1e3 * last.period_s,
        report::format_table({"method", "pixels", "threads", "samples", "query: least / median / p99",
                              "skins", "regions", "patches", "images", "gaps", "groups", "force", "tangent",
                              "linearise", "solve", "period: median / p99", "real time"},
                             rows));
  }
  fmt::print(
      "A query is skins + regions + patches + images + gaps + groups.  force and tangent are the contact's "
      "own,\n"
      "once; solve is the factorisation and solution of a period's steps; real time is simulated over run "
      "time.\n");
}

}  // namespace palpate::cli
