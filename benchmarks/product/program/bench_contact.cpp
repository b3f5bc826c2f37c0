#include "bench_contact.h"

#include <fmt/format.h>

#include <map>

#include "bench_contact_ratios.h"
#include "cli/scene_of.h"
#include "cli/stop.h"
#include "palpate/core/error.h"
#include "product/contact.h"
#include "report/table.h"
#include "store/atomic_file.h"

namespace palpate::cli {
namespace {

using Row = std::vector<std::string>;

/// The paper's pairs; nothing touches the human at rest, which is the purpose of its row.
const std::vector<std::string> kScenes = {"touch-head", "touch-human", "two-pumpkins",
                                          "two-heads",  "gears",       "scrape-pumpkin"};
const char* const kAtRest = "touch-human";
/// Nine pumpkins, so close that each overlaps the next: eight contacts in one solve.
const char* const kInARow = "two-pumpkins";
constexpr int kRow = 9;
constexpr double kSpacing = 0.28;

std::string ms(double value) { return fmt::format("{:.2f}", value); }
std::string ms(const bench::Spread& s) {
  return fmt::format("{:.2f} / {:.2f} / {:.2f}", s.least, s.median, s.p99);
}

Row variant_of(const bench::ContactBenchRow& r) {
  return {r.variant.method, fmt::format("{}", r.variant.threads)};
}

Row row_of(const bench::ContactBenchRow& r, const bench::ContactBenchRow* points) {
  Row out = variant_of(r);
  const bool is_beside = points && points != &r && points->query.median > 0.0;
  out.insert(out.end(),
             {fmt::format("{}", r.samples), fmt::format("{:.1f}", r.regions), ms(r.query),
              is_beside ? ms(r.query.median / points->query.median) : "-", ms(r.linearise_ms), ms(r.solve_ms),
              fmt::format("{:.1f} / {:.1f} / {:.1f}", r.period.least, r.period.median, r.period.p99),
              ms(r.real_time_factor())});
  return out;
}

/// Returns medians, or also the least and the 99th percentile.
Row stages_of(const bench::ContactBenchRow& r, bool all) {
  Row out = variant_of(r);
  for (const bench::Spread& stage : r.stages) out.push_back(all ? ms(stage) : ms(stage.median));
  return out;
}

void print_scene(const bench::ContactBenchReport::Scene& scene, bool all) {
  if (scene.rows.empty()) return;
  std::vector<Row> rows, stages;
  std::map<std::string, std::string> devices;
  for (const bench::ContactBenchRow& r : scene.rows) {
    rows.push_back(row_of(r, scene.find("distance", r.variant.threads)));
    stages.push_back(stages_of(r, all));
    devices[r.variant.method] = r.device + (r.device_is_software ? ": software rasteriser" : "");
  }
  const bench::ContactBenchRow& last = scene.rows.back();
  fmt::print("{}: {} tetrahedra, skin of {} vertices; the {} exchange periods of {:g} ms {} [ms]\n",
             scene.name, last.tetrahedra, last.skin_vertices, last.periods, 1e3 * last.period_s,
             last.touches ? "with contact" : "(no contact)");
  for (const auto& [method, device] : devices) fmt::print("  {}: {}\n", method, device);
  fmt::print("{}\n", report::format_table(
                         {"method", "threads", "samples", "regions", "query: least / median / p99",
                          "/ distance", "linearise", "solve", "period: least / median / p99", "real time"},
                         rows));
  Row header = {"method", "threads"};
  for (int s = 0; s < bench::kContactStages; ++s)
    header.emplace_back(name_of(static_cast<bench::ContactStage>(s)));
  fmt::print("  stages, {}\n{}\n", all ? "least / median / p99" : "medians",
             report::format_table(header, stages));
}

bench::ContactBenchReport::Scene run_scene(const scene::Description& description,
                                           const std::vector<std::string>& methods,
                                           const BenchArguments& arguments) {
  const std::vector<int> threads = arguments.threads.empty() ? std::vector<int>{1, 2} : arguments.threads;
  bench::ContactBenchReport::Scene out{description.name, {}};
  for (const std::string& method : methods)
    for (const int count : threads) {
      if (stop_flag()) return out;
      out.rows.push_back(bench::bench_contact(description, {method, count}, &stop_flag()));
    }
  return out;
}

/// Returns the requested methods, or nearest points and, where OpenGL opens, images.
std::vector<std::string> methods_of(const BenchArguments& arguments, std::string& no_image) {
  if (!arguments.methods.empty()) return arguments.methods;
  std::vector<std::string> out = {"distance"};
  try {
    bench::device_of("image");
    out.emplace_back("image");
  } catch (const Error& error) {
    no_image = error.what();
    fmt::print("image is omitted: {}\n\n", no_image);
  }
  return out;
}

void print_legend() {
  fmt::print(
      "A query is the sum of the stages from skins to rest; forces and tangent are those of the contact, "
      "evaluated once.\n"
      "Images: skins: positions from nodes; regions: bounds and pruning; faces: in axes of their region; "
      "upload, passes,\n"
      "gather and readback: image passes, with passes and gather timed by the GPU; gaps: in double, with "
      "samples.\n"
      "Nearest points: the whole query is rest.  / distance: ratio to the same query by nearest points.  "
      "linearise: contact for the tool\n"
      "ticks; solve: factorisation and solution of the steps of a period; real time: simulated over run "
      "time.\n\n");
}

void run_scenes(const BenchArguments& arguments, bench::ContactBenchReport& report) {
  std::vector<scene::Description> descriptions;
  for (const std::string& scene : arguments.scenes.empty() ? kScenes : arguments.scenes)
    descriptions.push_back(scene_of({scene, {}, ""}));
  if (arguments.scenes.empty()) descriptions.push_back(bench::against_itself(scene_of({kAtRest, {}, ""})));
  const std::vector<std::string> methods = methods_of(arguments, report.no_image);
  for (const scene::Description& description : descriptions) {
    if (stop_flag()) return;
    const bool own = !description.contacts.empty() &&  // A body has no image of itself.
                     description.contacts.front().first == description.contacts.front().second;
    report.scenes.push_back(
        run_scene(description, own ? std::vector<std::string>{"distance"} : methods, arguments));
    print_scene(report.scenes.back(), arguments.all);
  }
  print_legend();
  if (arguments.scenes.empty())
    descriptions.push_back(bench::row_of_bodies(scene_of({kInARow, {}, ""}), kRow, kSpacing));
  for (const scene::Description& description : descriptions) {
    if (stop_flag()) return;
    report.prices.push_back(bench::bench_contact_price(description, &stop_flag()));
  }
  print_contact_prices(report.prices);
}

}  // namespace

int bench_contact(const BenchArguments& arguments) {
  bench::ContactBenchReport report;
  if (!arguments.growth) run_scenes(arguments, report);
  if (arguments.growth || (arguments.check && arguments.scenes.empty())) {
    report.growth = run_contact_growth();
    print_contact_growth(report.growth);
  }
  if (!arguments.folder.empty()) {
    const std::filesystem::path file = std::filesystem::path(arguments.folder) / "bench-contact.json";
    std::filesystem::create_directories(arguments.folder);
    store::write_atomically(file, bench::to_json(report));
    fmt::print("written: {}\n", file.string());
  }
  if (stop_flag()) return kExitStopped;
  return arguments.check && !print_contact_bars(bench::contact_bars(report)) ? kExitError : 0;
}

}  // namespace palpate::cli
