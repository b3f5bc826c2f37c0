#include "bench_continuity.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "palpate/bench/continuity.h"
#include "palpate/report/table.h"
#include "scene_of.h"
#include "stop.h"

namespace palpate::cli {
namespace {

constexpr double kJump = 0.02;     // what is counted as one
constexpr double kPieces = 12800;  // of a path: the length that halvings end at

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
  for (int i = 0; i < bench::kJumpCauses; ++i) {
    const auto cause = static_cast<bench::JumpCause>(i);
    row.push_back(fmt::format("{} / {:.3f}", r.count(cause, kJump), r.largest(cause)));
  }
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
      fmt::print("{}: the largest jump, {:.3f} ({}), is on path {} at {:.5f} of its length\n",
                 short_name(description), worst->force, bench::name_of(worst->cause), worst->path, worst->at);
  }
  std::vector<std::string> head{"scene", "paths", "steps", "halved", "force [N]",
                                "p50",   "p99",   "max",   "moment"};
  for (int i = 0; i < bench::kJumpCauses; ++i)
    head.emplace_back(bench::name_of(static_cast<bench::JumpCause>(i)));
  fmt::print(
      "\n{}\nOne body moves past the other along random smooth paths of {} steps; a step across which the "
      "force "
      "changes by\nmore than {:g} of itself is halved {} times.  p50, p99, max: what is left then, each "
      "path's largest, over the\nforce; moment: the same of the moment; causes: jumps above {:g} / the "
      "largest.\n",
      report::format_table(head, rows), options.steps, options.threshold, options.halvings, kJump);
}

}  // namespace palpate::cli
