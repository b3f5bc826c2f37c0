#include "bench_continuity.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "cli/scene_of.h"
#include "cli/stop.h"
#include "product/continuity.h"
#include "report/table.h"

namespace palpate::cli {
namespace {

constexpr double kPieces = 12800;  // Number of pieces of a path at which bisection ends.

std::string quantile(std::vector<double> values, double share) {
  if (values.empty()) return "-";
  std::sort(values.begin(), values.end());
  const auto at = static_cast<std::size_t>(std::ceil(share * static_cast<double>(values.size()))) - 1;
  return fmt::format("{:.3f}", values[std::min(at, values.size() - 1)]);
}

std::vector<std::string> row_of(const std::string& scene, const bench::ContinuityRow& r) {
  double moment = 0.0;
  for (const bench::ForceJump& j : r.jumps) moment = std::max(moment, j.moment);
  std::vector<std::string> row{scene,
                               fmt::format("{}", r.worst_of_path.size()),
                               fmt::format("{}", r.steps),
                               fmt::format("{}", r.jumps.size()),
                               fmt::format("{:.3g}", r.force),
                               quantile(r.worst_of_path, 0.5),
                               quantile(r.worst_of_path, 0.99),
                               quantile(r.worst_of_path, 1.0),
                               fmt::format("{:.3f}", moment)};
  row.push_back(fmt::format("{}", std::count_if(r.jumps.begin(), r.jumps.end(),
                                                [](const bench::ForceJump& j) { return j.by_history; })));
  return row;
}

}  // namespace

void bench_continuity(const BenchArguments& arguments) {
  const std::vector<std::string> scenes =
      arguments.scenes.empty() ? std::vector<std::string>{"touch-head",   "touch-human", "two-heads",
                                                          "two-pumpkins", "gears",       "scrape-pumpkin"}
                               : arguments.scenes;
  bench::ContinuityOptions options;
  options.paths = arguments.paths;
  options.steps = arguments.path_steps;
  options.halvings = static_cast<int>(std::lround(std::log2(kPieces / options.steps)));
  if (!arguments.methods.empty()) options.method = arguments.methods.front();
  options.quadrature_error = arguments.quadrature_error;
  std::vector<std::vector<std::string>> rows;
  for (const std::string& scene : scenes) {
    if (stop_flag()) break;
    const scene::Description description = scene_of({scene, {}, ""});
    const bench::ContinuityRow row = bench::bench_continuity(description, options, &stop_flag());
    rows.push_back(row_of(short_name(description), row));
    const auto worst = std::max_element(row.jumps.begin(), row.jumps.end(),
                                        [](const auto& p, const auto& q) { return p.force < q.force; });
    if (worst != row.jumps.end())
      fmt::print("{}: the largest jump, {:.3f}, occurs on path {} at {:.5f} of its length\n",
                 short_name(description), worst->force, worst->path, worst->at);
  }
  const std::vector<std::string> head{"scene", "paths", "steps", "halved", "force [N]",
                                      "p50",   "p99",   "max",   "moment", "by history"};
  fmt::print(
      "\n{}\n"
      "One body moves past the other along random smooth paths of {} steps; a step with a relative change of "
      "the force\n"
      "above {:g} is halved {} times.  p50, p99, max: largest remaining jump of each path, relative to the "
      "force;\n"
      "moment: largest jump of the moment; by history: jumps between two histories with the same final "
      "pose.\n",
      report::format_table(head, rows), options.steps, options.threshold, options.halvings);
}

}  // namespace palpate::cli
