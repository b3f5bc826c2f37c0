#pragma once
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace palpate::bench {

/// Beam of the soft-body benchmarks: 1.0 x 0.25 x 0.25 m, five tetrahedra per cell, one end held, nu = 0.4,
/// density 1000 kg/m^3, lumped mass, warped tangent.
struct BeamSize {
  std::string name;
  int along, across;  ///< Number of cells.
};
/// Returns the sizes. S 3,700 nodes, 14,580 tetrahedra; M 11,172, 47,320; L 32,400, 144,400; XL 99,238,
/// 458,640.
const std::vector<BeamSize>& beam_sizes();
/// Returns the size of this name. @throws Error if there is none
const BeamSize& size_named(const std::string& name);

/// One way to compute a motion: cost of 10 ms of it, and distance of its end from the exact end for the same
/// mesh and material.
struct AccuracyPoint {
  std::string program;
  double step_s = 0.0, tolerance = 0.0;  ///< 0: not applicable to the program.
  /// Run time [ms] of 10 ms of the motion, one thread, without one-time work per mesh.
  double ms_of_ten_ms = 0.0;
  double error = 0.0;   ///< |q - exact|_M / |exact - rest|_M
  bool quoted = false;  ///< Not measured in this run.
  /// Run time [ms] of a first step, including one-time work per mesh (pattern, maps, orderings); 0: unknown.
  double setup_ms = 0.0;
};
/// Median time [ms] of another program's step of 10 ms and of 1 ms on the beam, E = 1e5.
struct PublishedStepTime {
  std::string program, size;
  double ten_ms, one_ms;  ///< NaN: not measured.
  std::string tolerance;
};

/// Timings of other programs, from a data file with the source of each; quoted, never measured here.
struct PublishedTimings {
  /// Copy bandwidth [GB/s] of the machine that they were measured on, by number of threads, ascending:
  /// arrays of 67 MB.
  std::vector<std::pair<int, double>> reference_copy_gb_s;
  std::vector<PublishedStepTime> step_times;
  std::vector<std::pair<std::string, AccuracyPoint>> accuracy;  ///< With the beam's size.
  /// Returns the copy bandwidth measured with the largest number of threads up to `threads`; NaN if there is
  /// none.
  double reference_bandwidth_gb_s(int threads) const;
};
/// Reads the timings. @throws Error if the file is missing or is not a file of published timings
PublishedTimings read_published_timings(const std::string& path);

struct FemBenchOptions {
  std::vector<std::string> sizes = {"S", "M"};
  std::vector<double> youngs_moduli_pa = {1e5, 1e6};
  std::vector<double> steps_s = {1e-2, 1e-3};
  std::vector<double> linear_rtols = {1e-6, 1e-3};
  std::vector<int> threads = {1, 2};
  std::vector<std::string> linear_solvers = {"auto"};
  int steps = 20;           ///< Timed steps, of 10 ms each.
  bool same_motion = true;  ///< More of the shorter steps, for the same motion; false: the same number.
  double element_s = 0.3;   ///< Time for which each evaluation over the elements is repeated.
  /// Number of timed steps whose solution is compared with a direct one (above 12,000 nodes with an iterative
  /// one at linear_rtol 1e-10).
  int checks = 3;
  PublishedTimings published = {};  ///< For `scaled_ms`.
};

/// Bandwidth of repeated passes over a working set of this size: caches hold the small ones.
struct Bandwidth {
  double bytes = 0.0, read_gb_s = 0.0, write_gb_s = 0.0;
};

/// Speed of this machine, measured in the same run, for one number of threads.
struct MachineLimits {
  int threads = 1;
  /// Copy bandwidth [GB/s] of arrays of 8 MB and of 67 MB, read and write counted.
  double small_copy_gb_s = 0.0, large_copy_gb_s = 0.0;
  /// Multiply-adds in registers, single and double precision, two operations each.
  double gflop_s = 0.0, double_gflop_s = 0.0;
  /// large_copy_gb_s of the machine of the published timings; NaN: unknown.
  double reference_copy_gb_s = std::numeric_limits<double>::quiet_NaN();
  std::vector<Bandwidth> bandwidths;           ///< Ascending working sets.
  double read_gb_s(double working_set) const;  ///< Interpolated between them.
  double write_gb_s(double working_set) const;
};

/// Least work of a stage in one step: data that it must read and write once, and its operations.
struct StageWork {
  double read_bytes = 0.0, written_bytes = 0.0;
  double single_flops = 0.0, double_flops = 0.0;
  /// Returns max(time of the bytes at the bandwidth of this working set, time of the operations) [ms].
  double limit_ms(const MachineLimits& limits, double working_set) const;
};

/// One kind of step: medians over a motion with large rotation [ms].
struct FemBenchRow {
  std::string size, linear_solver;
  int nodes = 0, tetrahedra = 0, blocks = 0, threads = 1, steps = 0;
  double youngs_modulus_pa = 0.0, step_s = 0.0, linear_rtol = 0.0;
  /// Forces, the product K u and the tangent are assembled together (fused assembly), timed as matrix_ms.
  bool fused_assembly = false;
  /// Forces and the product K u; with fused assembly the rest of the right-hand side; if most steps use a
  /// lagged matrix, the residual.
  double force_ms = 0.0;
  double matrix_ms = 0.0;  ///< Tangent, mass and held directions.
  double factor_ms = 0.0;  ///< Factor or preconditioner, and the copy of the matrix.
  double solve_ms = 0.0;
  double step_ms = 0.0;  ///< The whole step.
  double step_mean_ms = 0.0;
  double lagged_share = 0.0;  ///< Fraction of the steps solved by refinement with an earlier matrix.
  /// The shortest timed step: close to the time on an idle machine.
  double step_least_ms = 0.0, solve_least_ms = 0.0;
  /// Median CPU time of the stepping thread; with several threads it includes time spent spinning while
  /// waiting.
  double step_cpu_ms = 0.0;
  double solver_cpu_ms = 0.0;           ///< Part of it for factor and solve.
  double iterations = 0.0;              ///< Mean per step.
  double squared_courant_number = 0.0;  ///< 1 + h^2 tr K / tr M
  double error = 0.0;         ///< Largest of the checks: |du - du_direct| / |du_direct| in the energy norm.
  double mass_error = 0.0;    ///< Largest of the checks, in the norm of mass.
  double rotation_rad = 0.0;  ///< Rotation of the beam's end at the last step.
  /// Least time of each stage by memory and arithmetic, measured in the same run.
  double force_limit_ms = 0.0, matrix_limit_ms = 0.0, factor_limit_ms = 0.0, solve_limit_ms = 0.0;
  double step_limit_ms = 0.0;  ///< Their sum.
  /// step_ms x this machine's bandwidth / bandwidth of the machine of the published timings; NaN: unknown.
  double scaled_ms = 0.0;
  double needed_bytes = 0.0;  ///< Sum of the data that must be stored.
  double body_bytes = 0.0;    ///< Part of the soft body: elements, maps, scratch.
  /// Peak memory of the process above its memory before the beam was made, without the checks; NaN: unknown.
  double peak_bytes = 0.0;
};

/// One evaluation over the elements of the bent beam alone, repeated [ms].
struct ElementTiming {
  std::string size;
  /// "force", "force, damped", "residual", "fused assembly", "matrix set to zero", "tangent, warped",
  /// "tangent, exact".
  std::string stage;
  int nodes = 0, tetrahedra = 0, threads = 1, runs = 0;
  double least_ms = 0.0;  ///< Close to the time on an idle machine.
  double median_ms = 0.0;
  double limit_ms = 0.0;  ///< Least time by memory and arithmetic, measured in the same run.
};

struct FemBenchReport {
  std::vector<MachineLimits> limits;
  std::vector<FemBenchRow> rows;
  std::vector<ElementTiming> elements;  ///< Each stage at each size and number of threads.
};

FemBenchReport run_fem_bench(const FemBenchOptions& options, bool (*stop)() = nullptr);
MachineLimits measure_limits(int threads);
/// Times force, residual, tangents and fused assembly of one beam, on as many workers as core has; limits are
/// set by run_fem_bench().
/// @param size size of the beam
/// @param time_s time for each stage [s]
std::vector<ElementTiming> time_elements(const BeamSize& size, double time_s);

/// Returns the slope of ln y over ln x by least squares over pairs (x, y) with y > 0; NaN for fewer than two.
double scaling_exponent(const std::vector<std::pair<double, double>>& points);
/// Returns the slope of ln(a figure of a row) over ln(nodes), by least squares, for rows that differ only in
/// size; NaN for fewer than two.
double scaling_exponent(const std::vector<const FemBenchRow*>& rows,
                        const std::function<double(const FemBenchRow&)>& figure);

/// Measures the fall of the beam, E = 1e5, from rest for 0.2 s, for steps and tolerances.
std::vector<AccuracyPoint> run_accuracy(const std::string& size, bool (*stop)() = nullptr);
std::string to_json(const std::vector<AccuracyPoint>& points);

std::string to_json(const FemBenchReport& report);

}  // namespace palpate::bench
