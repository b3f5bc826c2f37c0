#include "bench_contact.h"

#include <fmt/format.h>

#include <cmath>
#include <map>

#include "bench_contact_ratios.h"
#include "palpate/bench/contact.h"
#include "palpate/bench/fem.h"
#include "palpate/core/error.h"
#include "palpate/report/table.h"
#include "scene_of.h"
#include "stop.h"

namespace palpate::cli {
namespace {

/// The paper's pairs; of the human at rest nothing touches, which is what its row is about.
const std::vector<std::string> kScenes = {"touch-head", "touch-human", "two-pumpkins",
                                          "two-heads",  "gears",       "scrape-pumpkin"};
const char* const kAtRest = "touch-human";
/// Nine pumpkins, so near that each overlaps the next: eight regions or more in one solve.
const char* const kInARow = "two-pumpkins";
constexpr int kRow = 9;
constexpr double kSpacing = 0.28;

/// Bandwidths of the machine, measured when they are first asked for.
class Machine {
 public:
  double copy_gb_s(int threads) {
    const auto [at, is_new] = copy_.try_emplace(threads, 0.0);
    if (is_new) at->second = bench::measure_limits(threads).large_copy_gb_s;
    return at->second;
  }
  const std::map<int, double>& measured() const { return copy_; }

 private:
  std::map<int, double> copy_;
};

std::vector<std::string> row_of(const bench::ContactBenchRow& r, double copy_gb_s) {
  const auto ms = [](double value) { return fmt::format("{:.2f}", value); };
  return {r.variant.method,
          r.variant.pixels > 0 ? fmt::format("{}", r.variant.pixels) : "wanted",
          fmt::format("{}", r.variant.threads),
          fmt::format("{}", r.samples),
          fmt::format("{:.1f}", r.regions),
          fmt::format("{:.2f} / {:.2f} / {:.2f}", r.query.least, r.query.median, r.query.p99),
          fmt::format("{:.0f}", 1e-4 * r.query_bytes / copy_gb_s / r.query.median),
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

void print_scene(const scene::Description& description, const BenchArguments& arguments, Machine& machine) {
  const std::vector<int> pixels = arguments.all              ? std::vector<int>{0, 64, 128, 256, 512, 1024}
                                  : arguments.pixels.empty() ? std::vector<int>{0, 256}
                                                             : arguments.pixels,
                         threads = arguments.threads.empty() ? std::vector<int>{1, 2} : arguments.threads;
  const std::vector<std::string> methods =
      arguments.all ? std::vector<std::string>{"cpu", "gpu", "exact"} : arguments.methods;
  std::vector<std::vector<std::string>> rows;
  bench::ContactBenchRow last;
  for (const std::string& method : methods)
    for (const int edge : pixels)
      for (const int count : threads) {
        if (stop_flag()) return;
        last = bench::bench_contact(description, {method, edge, count}, &stop_flag());
        rows.push_back(row_of(last, machine.copy_gb_s(count)));
      }
  fmt::print(
      "{}: {} tetrahedra, skin of {} vertices; medians of the {} exchange periods of {:g} ms {} [ms]\n"
      "{}\n",
      description.name, last.tetrahedra, last.skin_vertices, last.periods, 1e3 * last.period_s,
      last.touches ? "in which something touches" : "(nothing touches)",
      report::format_table(
          {"method", "pixels", "threads", "samples", "regions", "query: least / median / p99", "copy [%]",
           "skins", "regions", "patches", "images", "gaps", "groups", "force", "tangent", "linearise",
           "solve", "period: median / p99", "real time"},
          rows));
}

}  // namespace

void bench_contact(const BenchArguments& arguments) {
  if (arguments.growth) return print_contact_growth();
  Machine machine;
  std::vector<scene::Description> descriptions;
  for (const std::string& scene : arguments.scenes.empty() ? kScenes : arguments.scenes)
    descriptions.push_back(scene_of({scene, {}, ""}));
  if (arguments.scenes.empty()) descriptions.push_back(bench::against_itself(scene_of({kAtRest, {}, ""})));
  for (const scene::Description& description : descriptions) {
    if (stop_flag()) return;
    print_scene(description, arguments, machine);
  }
  fmt::print(
      "A query is skins + regions + patches + images + gaps + groups.  force and tangent are the contact's "
      "own,\nonce; solve is the factorisation and solution of a period's steps; real time is simulated over "
      "run time.\ncopy: the time that a query's bytes, each once, take at the bandwidth of copying, as a "
      "share of its time;");
  for (const auto& [threads, gb_s] : machine.measured())
    fmt::print(" {:.1f} GB/s with {} thread{}", gb_s, threads, threads > 1 ? "s," : ",");
  fmt::print(" arrays of 67 MB.\n\n");
  if (arguments.scenes.empty())
    descriptions.push_back(bench::row_of_bodies(scene_of({kInARow, {}, ""}), kRow, kSpacing));
  print_contact_prices(descriptions);
}

}  // namespace palpate::cli
