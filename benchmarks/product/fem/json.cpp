#include <fmt/format.h>

#include <cmath>

#include "product/fem.h"

namespace palpate::bench {
namespace {

std::string number(double value) { return std::isfinite(value) ? fmt::format("{:.4g}", value) : "null"; }

}  // namespace

std::string to_json(const FemBenchReport& report) {
  std::string out = "{\n  \"limits\": [";
  for (std::size_t i = 0; i < report.limits.size(); ++i) {
    const MachineLimits& l = report.limits[i];
    out += fmt::format(
        "{}\n    {{\"threads\": {}, \"copy_8mb_gb_s\": {:.4g}, \"copy_67mb_gb_s\": {:.4g}, \"gflop_s\": "
        "{:.4g}, \"double_gflop_s\": {:.4g}, \"reference_copy_67mb_gb_s\": {}, \"bandwidths\": [",
        i ? "," : "", l.threads, l.small_copy_gb_s, l.large_copy_gb_s, l.gflop_s, l.double_gflop_s,
        number(l.reference_copy_gb_s));
    for (std::size_t k = 0; k < l.bandwidths.size(); ++k)
      out +=
          fmt::format("{}{{\"bytes\": {:.0f}, \"read_gb_s\": {:.4g}, \"write_gb_s\": {:.4g}}}", k ? ", " : "",
                      l.bandwidths[k].bytes, l.bandwidths[k].read_gb_s, l.bandwidths[k].write_gb_s);
    out += "]}";
  }
  out += "\n  ],\n  \"rows\": [";
  for (std::size_t i = 0; i < report.rows.size(); ++i) {
    const FemBenchRow& r = report.rows[i];
    out += fmt::format(
        "{}\n    {{\"size\": \"{}\", \"nodes\": {}, \"tetrahedra\": {}, \"youngs_modulus_pa\": {:g}, "
        "\"step_s\": {:g}, \"linear_rtol\": {:g}, \"linear_solver\": \"{}\", "
        "\"threads\": {}, \"fused_assembly\": {}, \"force_ms\": {:.4g}, \"matrix_ms\": {:.4g}, "
        "\"factor_ms\": "
        "{:.4g}, \"solve_ms\": {:.4g}, \"step_ms\": {:.4g}, \"mean_step_ms\": {:.4g}, \"lagged_share\": "
        "{:.3g}, "
        "\"scaled_step_ms\": {}, \"least_step_ms\": {:.4g}, \"least_solve_ms\": {:.4g}, \"step_cpu_ms\": "
        "{:.4g}, \"solver_cpu_ms\": {:.4g}, "
        "\"iterations\": {:.4g}, \"squared_courant_number\": {:.4g}, \"energy_error\": {:.3g}, "
        "\"mass_error\": "
        "{:.3g}, \"end_rotation_rad\": {:.3g}, \"force_limit_ms\": {:.4g}, \"matrix_limit_ms\": {:.4g}, "
        "\"factor_limit_ms\": {:.4g}, \"solve_limit_ms\": {:.4g}, "
        "\"needed_bytes\": {:.0f}, \"body_bytes\": {:.0f}, \"peak_bytes\": {:.0f}}}",
        i ? "," : "", r.size, r.nodes, r.tetrahedra, r.youngs_modulus_pa, r.step_s, r.linear_rtol,
        r.linear_solver, r.threads, r.fused_assembly, r.force_ms, r.matrix_ms, r.factor_ms, r.solve_ms,
        r.step_ms, r.step_mean_ms, r.lagged_share, number(r.scaled_ms), r.step_least_ms, r.solve_least_ms,
        r.step_cpu_ms, r.solver_cpu_ms, r.iterations, r.squared_courant_number, r.error, r.mass_error,
        r.rotation_rad, r.force_limit_ms, r.matrix_limit_ms, r.factor_limit_ms, r.solve_limit_ms,
        r.needed_bytes, r.body_bytes, std::isfinite(r.peak_bytes) ? r.peak_bytes : 0.0);
  }
  out += "\n  ],\n  \"elements\": [";
  for (std::size_t i = 0; i < report.elements.size(); ++i) {
    const ElementTiming& t = report.elements[i];
    out += fmt::format(
        "{}\n    {{\"size\": \"{}\", \"nodes\": {}, \"tetrahedra\": {}, \"threads\": {}, \"stage\": \"{}\", "
        "\"runs\": {}, \"least_ms\": {:.4g}, \"median_ms\": {:.4g}, \"limit_ms\": {:.4g}}}",
        i ? "," : "", t.size, t.nodes, t.tetrahedra, t.threads, t.stage, t.runs, t.least_ms, t.median_ms,
        t.limit_ms);
  }
  return out + "\n  ]\n}\n";
}

std::string to_json(const std::vector<AccuracyPoint>& points) {
  std::string out = "{\n  \"points\": [";
  for (std::size_t i = 0; i < points.size(); ++i) {
    const AccuracyPoint& p = points[i];
    out += fmt::format(
        "{}\n    {{\"program\": \"{}\", \"step_s\": {:g}, \"tolerance\": {:g}, \"ms_of_ten_ms\": {:.4g}, "
        "\"error\": {:.4g}, \"setup_ms\": {:.4g}, \"quoted\": {}}}",
        i ? "," : "", p.program, p.step_s, p.tolerance, p.ms_of_ten_ms, p.error, p.setup_ms, p.quoted);
  }
  return out + "\n  ]\n}\n";
}

}  // namespace palpate::bench
