#include "bench_fem.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <set>

#include "cli/stop.h"
#include "palpate/core/error.h"
#include "product/fem.h"
#include "report/table.h"
#include "store/atomic_file.h"

namespace palpate::cli {
namespace {

namespace fs = std::filesystem;
using bench::FemBenchReport;
using bench::FemBenchRow;
using Rows = std::vector<std::vector<std::string>>;

bench::PublishedTimings published_timings() {
  return bench::read_published_timings(PALPATE_PUBLISHED_TIMINGS);
}

std::string shown_ms(double value) { return std::isfinite(value) ? fmt::format("{:.3g}", value) : "-"; }

void print_limits(const FemBenchReport& report) {
  Rows rows;
  for (const bench::MachineLimits& l : report.limits)
    rows.push_back({fmt::format("{}", l.threads), fmt::format("{:.1f}", l.small_copy_gb_s),
                    fmt::format("{:.1f}", l.large_copy_gb_s), shown_ms(l.reference_copy_gb_s),
                    fmt::format("{:.0f}", l.gflop_s), fmt::format("{:.0f}", l.double_gflop_s)});
  fmt::print(
      "measured limits of this machine\n{}\n",
      report::format_table({"threads", "copy 8 MB [GB/s]", "copy 67 MB [GB/s]", "reference machine [GB/s]",
                            "float multiply-adds [GFLOP/s]", "double [GFLOP/s]"},
                           rows));
  Rows sizes;
  for (const bench::MachineLimits& l : report.limits)
    for (const bench::Bandwidth& b : l.bandwidths)
      sizes.push_back({fmt::format("{}", l.threads), fmt::format("{:.3g}", b.bytes / 1048576.0),
                       fmt::format("{:.1f}", b.read_gb_s), fmt::format("{:.1f}", b.write_gb_s)});
  fmt::print("repeated passes over one working set\n{}\n",
             report::format_table({"threads", "MiB", "read [GB/s]", "write [GB/s]"}, sizes));
}

void print_steps(const FemBenchReport& report) {
  Rows rows;
  for (const FemBenchRow& r : report.rows)
    rows.push_back({r.size,
                    fmt::format("{}", r.nodes),
                    fmt::format("{:g}", r.youngs_modulus_pa),
                    fmt::format("{:g}", 1e3 * r.step_s),
                    fmt::format("{:g}", r.linear_rtol),
                    r.linear_solver,
                    fmt::format("{}", r.threads),
                    shown_ms(r.force_ms),
                    shown_ms(r.matrix_ms) + (r.fused_assembly ? "*" : ""),
                    shown_ms(r.factor_ms),
                    shown_ms(r.solve_ms),
                    shown_ms(r.step_ms),
                    shown_ms(r.step_mean_ms),
                    shown_ms(r.step_least_ms),
                    shown_ms(r.step_cpu_ms),
                    shown_ms(r.solver_cpu_ms),
                    shown_ms(r.scaled_ms),
                    fmt::format("{:.0f}", 100.0 * r.lagged_share),
                    fmt::format("{:.1f}", r.iterations),
                    r.error > 0.0 ? fmt::format("{:.1e}", r.error) : "-",
                    r.mass_error > 0.0 ? fmt::format("{:.1e}", r.mass_error) : "-",
                    fmt::format("{:.1f}", r.rotation_rad)});
  fmt::print(
      "one linearly implicit step, median over a motion with large rotation\n"
      "  *: fused assembly of forces, product and matrix; scaled: step x measured copy bandwidth / that of "
      "the reference machine;\n"
      "  lagged: steps solved with the matrix of an earlier step, by iterative refinement; the residuals of "
      "the current equations are timed as force;\n"
      "  error: error of the velocity change against a direct solution, maximum of the checks, in the energy "
      "and mass norms\n\n"
      "{}\n",
      report::format_table(
          {"size",   "nodes",      "E [Pa]", "h [ms]",    "rtol", "solver",        "thr", "force",
           "matrix", "factor",     "solve",  "step [ms]", "mean", "least",         "CPU", "solver CPU",
           "scaled", "lagged [%]", "iter",   "error",     "mass", "rotation [rad]"},
          rows));
}

std::string share(double limit, double time) {
  return time > 0.0 ? fmt::format("{:.0f}", 100.0 * limit / time) : "-";
}

void print_shares(const FemBenchReport& report) {
  Rows rows;
  for (const FemBenchRow& r : report.rows)
    rows.push_back({r.size, fmt::format("{:g}", r.youngs_modulus_pa), fmt::format("{:g}", 1e3 * r.step_s),
                    fmt::format("{:g}", r.linear_rtol), r.linear_solver, fmt::format("{}", r.threads),
                    share(r.force_limit_ms, r.force_ms), share(r.matrix_limit_ms, r.matrix_ms),
                    share(r.factor_limit_ms, r.factor_ms), share(r.solve_limit_ms, r.solve_ms),
                    share(r.step_limit_ms, r.step_ms), shown_ms(r.step_limit_ms)});
  fmt::print(
      "share of the limit [%]: time for the necessary reads and writes of a stage at the bandwidth of the "
      "working set of the step (of the solve), or for its operations, whichever is longer\n"
      "{}\n",
      report::format_table({"size", "E [Pa]", "h [ms]", "rtol", "solver", "thr", "force", "matrix", "factor",
                            "solve", "step", "limit [ms]"},
                           rows));
}

void print_elements(const FemBenchReport& report) {
  Rows rows;
  std::map<std::pair<std::string, int>, std::vector<const bench::ElementTiming*>> kinds;
  for (const bench::ElementTiming& t : report.elements) {
    rows.push_back({t.size, fmt::format("{}", t.threads), t.stage, shown_ms(t.least_ms),
                    shown_ms(t.median_ms), fmt::format("{:.1f}", 1e6 * t.least_ms / t.tetrahedra),
                    share(t.limit_ms, t.least_ms), fmt::format("{}", t.runs)});
    kinds[{t.stage, t.threads}].push_back(&t);
  }
  fmt::print(
      "one evaluation over the elements, repeated: bent beam, E = 1e6; limit: time for its bytes and "
      "operations at the bandwidth of a working set of that size\n"
      "  residual: forces minus K w; fused assembly: residual and warped matrix in single precision; "
      "tangents are stored in double, overwriting the matrix\n\n"
      "{}\n",
      report::format_table(
          {"size", "thr", "stage", "least [ms]", "median [ms]", "least [ns/tet]", "limit [%]", "runs"},
          rows));
  Rows growth;
  for (const auto& [kind, timings] : kinds) {
    const auto exponent = [&](auto size, double bench::ElementTiming::*figure) {
      std::vector<std::pair<double, double>> points;
      for (const bench::ElementTiming* t : timings) points.emplace_back(t->*size, t->*figure);
      return bench::scaling_exponent(points);
    };
    const double grows = exponent(&bench::ElementTiming::tetrahedra, &bench::ElementTiming::least_ms);
    if (std::isfinite(grows))
      growth.push_back(
          {kind.first, fmt::format("{}", kind.second), fmt::format("{:.3f}", grows),
           fmt::format("{:.3f}", exponent(&bench::ElementTiming::nodes, &bench::ElementTiming::least_ms)),
           fmt::format("{:.3f}",
                       exponent(&bench::ElementTiming::tetrahedra, &bench::ElementTiming::limit_ms))});
  }
  if (!growth.empty())
    fmt::print(
        "growth of the minimum time: exponent in the number of tetrahedra, in the number of nodes; growth of "
        "the limit in the number of tetrahedra\n"
        "{}\n",
        report::format_table({"stage", "thr", "tetrahedra", "nodes", "limit"}, growth));
}

void print_memory(const FemBenchReport& report) {
  Rows rows;
  std::set<std::string> sizes;
  for (const FemBenchRow& r : report.rows) {
    if (!sizes.insert(r.size + r.linear_solver).second) continue;
    const auto each = [&](double bytes) {
      return std::isfinite(bytes) ? fmt::format("{:.0f}", bytes / r.tetrahedra) : "-";
    };
    rows.push_back({r.size, r.linear_solver, fmt::format("{}", r.tetrahedra), each(r.needed_bytes),
                    each(r.body_bytes), each(r.peak_bytes), fmt::format("{:.1f}", r.peak_bytes / 1048576.0)});
  }
  fmt::print(
      "memory [bytes per tetrahedron]: necessary storage; storage of the soft body; increase of the peak "
      "memory of the process\n"
      "{}\n",
      report::format_table({"size", "solver", "tetrahedra", "necessary", "soft body", "peak", "peak [MiB]"},
                           rows));
}

/// Returns groups of rows that differ only in size.
std::map<std::string, std::vector<const FemBenchRow*>> by_kind(const FemBenchReport& report) {
  std::map<std::string, std::vector<const FemBenchRow*>> kinds;
  for (const FemBenchRow& r : report.rows)
    kinds[fmt::format("E {:g} Pa, {:g} ms, {:g}, {}, {} thread{}", r.youngs_modulus_pa, 1e3 * r.step_s,
                      r.linear_rtol, r.linear_solver, r.threads, r.threads > 1 ? "s" : "")]
        .push_back(&r);
  return kinds;
}

void print_exponents(const FemBenchReport& report) {
  struct Stage {
    double FemBenchRow::*time;
    double FemBenchRow::*limit;
  };
  constexpr Stage kStages[] = {{&FemBenchRow::force_ms, &FemBenchRow::force_limit_ms},
                               {&FemBenchRow::matrix_ms, &FemBenchRow::matrix_limit_ms},
                               {&FemBenchRow::factor_ms, &FemBenchRow::factor_limit_ms},
                               {&FemBenchRow::solve_ms, &FemBenchRow::solve_limit_ms},
                               {&FemBenchRow::step_ms, &FemBenchRow::step_limit_ms}};
  Rows rows;
  double tetrahedra = 0.0, blocks = 0.0;
  for (const auto& [kind, members] : by_kind(report)) {
    if (members.size() < 2) continue;
    tetrahedra = bench::scaling_exponent(members, [](const FemBenchRow& r) { return r.tetrahedra; });
    blocks = bench::scaling_exponent(members, [](const FemBenchRow& r) { return r.blocks; });
    std::vector<std::string> row{kind};
    for (const Stage& stage : kStages) {
      const double grows = bench::scaling_exponent(members, stage.time);
      row.push_back(std::isfinite(grows)
                        ? fmt::format("{:.2f} ({:.2f})", grows, bench::scaling_exponent(members, stage.limit))
                        : "-");
    }
    rows.push_back(row);
  }
  if (rows.empty()) return;
  fmt::print(
      "growth with the number of nodes n: exponent e of ms ~ n^e, and in brackets the exponent of the limit\n"
      "{}\n"
      "  large bodies have more tetrahedra per node: tetrahedra grow with exponent {:.3f}, blocks of the "
      "matrix with {:.3f}\n\n",
      report::format_table({"kind", "force", "matrix", "factor", "solve", "step"}, rows), tetrahedra, blocks);
}

void print_published(const FemBenchReport& report, const bench::PublishedTimings& published) {
  std::set<std::string> sizes;
  for (const FemBenchRow& r : report.rows) sizes.insert(r.size);
  Rows rows;
  for (const bench::PublishedStepTime& p : published.step_times)
    if (sizes.contains(p.size))
      rows.push_back({p.program, p.size, shown_ms(p.ten_ms), shown_ms(p.one_ms), p.tolerance});
  if (!rows.empty())
    fmt::print(
        "other programs on this beam at E = 1e5, one thread, quoted (measured once on the reference "
        "machine): compare with \"scaled\"\n"
        "{}\n",
        report::format_table({"program", "size", "10 ms step [ms]", "1 ms step [ms]", "tolerance"}, rows));
}

void write_json(const std::string& json, const fs::path& file) {
  fs::create_directories(file.parent_path());
  store::write_atomically(file, json);
  fmt::print("written: {}; `palpate report {}` makes a page of it\n", file.string(),
             file.parent_path().string());
}

void bench_accuracy(const BenchArguments& arguments) {
  const std::string size = arguments.sizes.empty() ? "S" : arguments.sizes.front();
  const bench::PublishedTimings published = published_timings();
  std::vector<bench::AccuracyPoint> points =
      bench::run_accuracy(size, [] { return static_cast<bool>(stop_flag()); });
  for (const auto& [of_size, point] : published.accuracy)
    if (of_size == size) points.push_back(point);
  Rows rows;
  for (const bench::AccuracyPoint& p : points)
    rows.push_back({p.program, p.step_s > 0.0 ? fmt::format("{:g}", 1e3 * p.step_s) : "-",
                    p.tolerance > 0.0 ? fmt::format("{:g}", p.tolerance) : "-",
                    fmt::format("{:.3g}", p.ms_of_ten_ms), fmt::format("{:.2e}", p.error),
                    p.setup_ms > 0.0 ? fmt::format("{:.3g}", p.setup_ms) : "-", p.quoted ? "quoted" : ""});
  fmt::print(
      "{}, E = 1e5 Pa: fall from rest for 0.2 s; error of the final state against the exact motion of the "
      "same mesh and material, relative to the distance fallen (mass norm)\n"
      "  set-up: first step, once per mesh, not included in the run time\n"
      "{}\n",
      size,
      report::format_table({"program", "h [ms]", "tolerance", "ms of 10 ms", "error", "set-up [ms]", ""},
                           rows));
  if (!arguments.folder.empty())
    write_json(bench::to_json(points), fs::path(arguments.folder) / "bench-fem-accuracy.json");
}

}  // namespace

void bench_fem_sizes(const BenchArguments& arguments) {
  if (arguments.accuracy) return bench_accuracy(arguments);
  bench::FemBenchOptions options;
  if (!arguments.sizes.empty()) options.sizes = arguments.sizes;
  if (!arguments.threads.empty()) options.threads = arguments.threads;
  if (!arguments.linear_rtols.empty()) options.linear_rtols = arguments.linear_rtols;
  if (!arguments.youngs_moduli_pa.empty()) options.youngs_moduli_pa = arguments.youngs_moduli_pa;
  options.linear_solvers = arguments.linear_solvers;
  options.steps = arguments.steps;
  options.published = published_timings();
  const FemBenchReport report = bench::run_fem_bench(options, [] { return static_cast<bool>(stop_flag()); });
  print_limits(report);
  print_steps(report);
  print_shares(report);
  print_elements(report);
  print_exponents(report);
  print_memory(report);
  print_published(report, options.published);
  if (!arguments.folder.empty() && !report.rows.empty())
    write_json(bench::to_json(report), fs::path(arguments.folder) / "bench-fem.json");
}

}  // namespace palpate::cli
