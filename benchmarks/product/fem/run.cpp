#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <type_traits>

#include "core/clock.h"
#include "dynamics/mixed_precision_step.h"
#include "palpate/core/error.h"
#include "palpate/core/workers.h"
#include "palpate/integrate/integrators.h"
#include "palpate/linear/solvers.h"
#include "product/fem.h"
#include "product/fem/beam.h"
#include "product/fem/peak_memory.h"
#include "product/fem/stage_work.h"

namespace palpate::bench {
namespace {

using namespace dynamics;

constexpr int kDirectNodes = 12000;  ///< Above: the direct factor costs seconds and gigabytes.
constexpr double kTight = 1e-10;
/// Motion before the timed steps, which produces large rotation.
constexpr double kWarmTo = 0.2, kWarmStep = 1e-2;

/// Timed solver, with a direct solver for the checked steps, which uses the step's matrix reassembled in
/// double precision and measures the error of the solution.
class CheckedSolver final : public LinearSolver, public MixedPrecisionSolver {
 public:
  CheckedSolver(std::unique_ptr<LinearSolver> solver, Beam& beam, const IntegratorSpec& spec)
      : solver_(std::move(solver)),
        mixed_(dynamic_cast<MixedPrecisionSolver*>(solver_.get())),
        beam_(beam),
        spec_(spec) {}
  std::string name() const override { return solver_->name(); }
  bool supports_unsymmetric() const override { return solver_->supports_unsymmetric(); }
  SolveStatus factor(const BorderedMatrix& A) override {
    return timed([&] { return solver_->factor(A); });
  }
  ZeroRowSumMatrix* step_matrix(const BlockSparse& pattern) override {
    return mixed_ ? mixed_->step_matrix(pattern) : nullptr;
  }
  StepMatrixUse factor_step_matrix() override {
    ++step_matrices;
    return timed([&] { return mixed_->factor_step_matrix(); });
  }
  ZeroRowSumMatrix* lagged_matrix() override { return mixed_ ? mixed_->lagged_matrix() : nullptr; }
  void renew_points() override { mixed_->renew_points(); }
  std::optional<SolveStatus> solve_by_refinement(ResidualFunction& residual, VecX& x) override {
    if (!mixed_) return {};
    const long before = solver_->counters().lagged;
    const std::optional<SolveStatus> status = timed([&] { return mixed_->solve_by_refinement(residual, x); });
    if (status != SolveStatus::kOk) return status;
    lagged += static_cast<int>(solver_->counters().lagged - before);
    if (!check_next) return status;
    const double start = wall_seconds(), start_cpu = thread_cpu_seconds();
    VecX rhs;
    residual.at(VecX::Zero(x.size()), rhs);
    check(rhs, x);
    checking_s += wall_seconds() - start;
    checking_cpu_s += thread_cpu_seconds() - start_cpu;
    return status;
  }
  SolveStatus solve(const MatX& B, MatX& X) override { return solver_->solve(B, X); }
  SolveStatus solve(const VecX& b, VecX& x) override {
    VecX rhs;
    if (check_next) rhs = b;
    const SolveStatus status = timed([&] { return solver_->solve(b, x); });
    if (!check_next) return status;
    const double start = wall_seconds(), start_cpu = thread_cpu_seconds();
    if (status == SolveStatus::kOk) check(rhs, x);
    checking_s += wall_seconds() - start;
    checking_cpu_s += thread_cpu_seconds() - start_cpu;
    return status;
  }
  const SolverCounters& counters() const override { return solver_->counters(); }

  bool check_next = false;
  double cpu_s = 0.0, checking_s = 0.0, checking_cpu_s = 0.0, error = 0.0, mass_error = 0.0;
  int checks = 0, step_matrices = 0, lagged = 0;
  /// Returns the matrix of the step that begins now.
  const BorderedMatrix& matrix() {
    const double h = spec_.step_s, t1 = beam_.state.time() + h;
    beam_.system.step_matrix(beam_.state.view(t1, beam_.state.q().data(), beam_.state.u().data()), 1.0, h,
                             h * h, matrix_);
    return matrix_;
  }

 private:
  template <class Work>
  std::invoke_result_t<Work> timed(Work&& work) {
    const double start = thread_cpu_seconds();
    const auto status = work();
    cpu_s += thread_cpu_seconds() - start;
    return status;
  }

  void check(const VecX& b, const VecX& x) {
    const BorderedMatrix& A = matrix();
    if (!direct_) {
      IntegratorSpec tight = spec_;
      tight.linear_rtol = kTight;
      direct_ = linear::make_linear_solver(A.body.block_rows() <= kDirectNodes ? "cholmod" : "pcg", tight);
    }
    VecX exact, product;
    if (direct_->factor(A) != SolveStatus::kOk || direct_->solve(b, exact) != SolveStatus::kOk)
      fail("bench fem: the step has no direct solution to compare with");
    const VecX wrong = x - exact;
    const auto energy = [&](const VecX& v) {
      A.multiply(v, product);
      return std::sqrt(v.dot(product));
    };
    const auto mass = [&](const VecX& v) {
      double sum = 0.0;
      for (Eigen::Index i = 0; i < v.size(); ++i) sum += beam_.masses[i / 3] * v[i] * v[i];
      return std::sqrt(sum);
    };
    error = std::max(error, energy(wrong) / energy(exact));
    mass_error = std::max(mass_error, mass(wrong) / mass(exact));
    ++checks;
  }

  std::unique_ptr<LinearSolver> solver_, direct_;
  MixedPrecisionSolver* mixed_;  ///< Capability of solver_; null: not available.
  Beam& beam_;
  IntegratorSpec spec_;
  BorderedMatrix matrix_;
};

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Returns the squared Courant-type number 1 + h^2 tr K / tr M, from the rows of the step matrix (each row
/// sums to its mass).
double squared_courant_number(const BlockSparse& A, const VecX& masses) {
  double own = 0.0, mass = 0.0;
  for (int i = 0; i < A.block_rows(); ++i) {
    const double* block = A.block(A.diagonal(i));
    if (block[1] == 0.0 && block[0] == 1.0) continue;  // Held.
    own += block[0] + block[4] + block[8];
    mass += 3.0 * masses[i];
  }
  return own / mass;
}

/// State of the beam at the start of the timed steps; the same for every kind of step of one beam.
struct Warm {
  VecX q, u;
};

/// Returns the number of timed steps of length h: enough for the same motion, or a constant number.
int timed_steps(const FemBenchOptions& options, double h) {
  return options.same_motion ? static_cast<int>(std::lround(options.steps * std::max(1.0, kWarmStep / h)))
                             : options.steps;
}

/// Moves a new beam to the start of the timed steps, or computes that.
void warm_up(Beam& beam, Warm& start_from) {
  if (start_from.q.size() == beam.rest.size()) {
    beam.state.q() = start_from.q;
    beam.state.u() = start_from.u;
    beam.state.set_time(kWarmTo);
  } else {
    IntegratorSpec warm{.name = "linearly-implicit-euler",
                        .step_s = kWarmStep,
                        .linear_solver = "pcg-two-level",
                        .linear_rtol = 1e-4};
    const auto stepper = integrate::make_stepper(beam.system, beam.state, warm);
    if (const StepResult r = stepper->advance_to(kWarmTo); !r.ok()) fail("bench fem: {}", r.message);
    start_from = {beam.state.q(), beam.state.u()};
  }
}

/// Times of the stages of each timed step.
struct StepTimes {
  /// Force, matrix, factor, solve, step; CPU time of the step's thread and of the solver [ms].
  std::array<std::vector<double>, 7> ms;
  long iterations = 0, lagged = 0;
  double peak_bytes = 0.0;
};

StepTimes timed(Beam& beam, dynamics::Stepper& stepper, CheckedSolver& solver, const IntegratorSpec& spec,
                const FemBenchOptions& options, const PeakMemory& memory) {
  constexpr int kUntimed = 4;  // Symbolic analysis, and the solutions used for initial guesses.
  StepTimes out;
  const int steps = timed_steps(options, spec.step_s);
  for (int k = 0; k < kUntimed + steps; ++k) {
    if (k == kUntimed) out.peak_bytes = memory.bytes();  // Before the first check, which stores a factor.
    solver.check_next = options.checks > 0 && k >= kUntimed &&
                        (k - kUntimed) % std::max(1, steps / options.checks) == 0 &&
                        solver.checks < options.checks;
    const double checking = solver.checking_s, checking_cpu = solver.checking_cpu_s,
                 solver_cpu = solver.cpu_s;
    const StepperCounters before = stepper.counters();
    const double start = wall_seconds(), start_cpu = thread_cpu_seconds();
    if (const StepResult r = stepper.advance_to(beam.state.time() + spec.step_s); !r.ok())
      fail("bench fem: {}", r.message);
    const double wall = wall_seconds() - start - (solver.checking_s - checking);
    const double cpu = thread_cpu_seconds() - start_cpu - (solver.checking_cpu_s - checking_cpu);
    if (k < kUntimed) continue;
    const StepperCounters step = stepper.counters() - before;
    const SolverCounters& solved = step.solver;
    out.ms[0].push_back(1e3 * step.force_s);
    out.ms[1].push_back(1e3 * step.tangent_s);
    out.ms[2].push_back(1e3 * (solved.factor_s + solved.symbolic_s));
    out.ms[3].push_back(1e3 * solved.solve_s);
    out.ms[4].push_back(1e3 * wall);
    out.ms[5].push_back(1e3 * cpu);
    out.ms[6].push_back(1e3 * (solver.cpu_s - solver_cpu));
    out.iterations += solved.iterations;
    out.lagged += solved.lagged;
  }
  return out;
}

FemBenchRow time_steps(const BeamSize& size, const IntegratorSpec& spec, double youngs_modulus,
                       const FemBenchOptions& options, Warm& start_from) {
  const PeakMemory memory;
  Beam beam(size.along, size.across, youngs_modulus);
  warm_up(beam, start_from);
  auto checked =
      std::make_unique<CheckedSolver>(linear::make_linear_solver(spec.linear_solver, spec), beam, spec);
  CheckedSolver& solver = *checked;
  const auto stepper = find(integrate::stepper_registry(), spec.name, "integrator")
                           .make(beam.system, beam.state, spec, std::move(checked));
  const StepTimes times = timed(beam, *stepper, solver, spec, options, memory);
  const int steps = timed_steps(options, spec.step_s);
  FemBenchRow row;
  row.size = size.name;
  row.linear_solver = spec.linear_solver;
  row.nodes = static_cast<int>(beam.rest.size() / 3);
  row.tetrahedra = beam.tetrahedra;
  row.blocks = solver.matrix().body.slot_count();
  row.threads = spec.threads;
  row.steps = steps;
  row.youngs_modulus_pa = youngs_modulus;
  row.step_s = spec.step_s;
  row.linear_rtol = spec.linear_rtol;
  row.fused_assembly = solver.step_matrices + solver.lagged >= steps;
  row.force_ms = median(times.ms[0]);
  row.matrix_ms = median(times.ms[1]);
  row.factor_ms = median(times.ms[2]);
  row.solve_ms = median(times.ms[3]);
  row.step_ms = median(times.ms[4]);
  row.step_cpu_ms = median(times.ms[5]);
  row.solver_cpu_ms = median(times.ms[6]);
  row.step_least_ms = *std::min_element(times.ms[4].begin(), times.ms[4].end());
  row.solve_least_ms = *std::min_element(times.ms[3].begin(), times.ms[3].end());
  row.step_mean_ms = std::accumulate(times.ms[4].begin(), times.ms[4].end(), 0.0) / steps;
  row.iterations = static_cast<double>(times.iterations) / steps;
  row.lagged_share = static_cast<double>(times.lagged) / steps;
  row.squared_courant_number = squared_courant_number(solver.matrix().body, beam.masses);
  row.error = solver.error;
  row.mass_error = solver.mass_error;
  row.rotation_rad = beam.end_rotation();
  row.peak_bytes = times.peak_bytes;
  row.body_bytes = beam.body_bytes();
  return row;
}

void set_limits(FemBenchRow& row, const MachineLimits& limits) {
  const StepCounts counts{static_cast<double>(row.nodes),
                          static_cast<double>(row.tetrahedra),
                          static_cast<double>(row.blocks),
                          row.iterations,
                          row.linear_rtol < 1e-4 ? 5.0 : 3.0,
                          row.fused_assembly,
                          row.lagged_share > 0.5};
  const StepWork work = work_of(counts);
  row.scaled_ms = row.step_ms * limits.large_copy_gb_s / limits.reference_copy_gb_s;
  row.force_limit_ms = work.force.limit_ms(limits, work.working_set);
  row.matrix_limit_ms = work.matrix.limit_ms(limits, work.working_set);
  row.factor_limit_ms = work.factor.limit_ms(limits, work.working_set);
  row.solve_limit_ms = work.solve.limit_ms(limits, work.solve_working_set);
  row.step_limit_ms = row.force_limit_ms + row.matrix_limit_ms + row.factor_limit_ms + row.solve_limit_ms;
  row.needed_bytes = bytes_to_store(counts);
}

}  // namespace

FemBenchReport run_fem_bench(const FemBenchOptions& options, bool (*stop)()) {
  if (options.steps < 3) fail("bench fem: --steps {} is too small; use at least 3", options.steps);
  FemBenchReport report;
  for (const std::string& size : options.sizes)
    for (const double E : options.youngs_moduli_pa) {
      Warm warm;
      for (const double h : options.steps_s)
        for (const double rtol : options.linear_rtols)
          for (const std::string& solver : options.linear_solvers)
            for (std::size_t t = 0; t < options.threads.size(); ++t) {
              if (stop && stop()) break;
              const workers::Count elements_too(options.threads[t]);
              const IntegratorSpec spec{.name = "linearly-implicit-euler",
                                        .step_s = h,
                                        .linear_solver = solver,
                                        .linear_rtol = rtol,
                                        .threads = options.threads[t]};
              report.rows.push_back(time_steps(size_named(size), spec, E, options, warm));
            }
    }
  for (const std::string& size : options.sizes)  // Last, so that their memory is not in the peaks.
    for (const int threads : options.threads) {
      if (stop && stop()) break;
      const workers::Count count(threads);
      for (ElementTiming& timing : time_elements(size_named(size), options.element_s)) {
        timing.threads = threads;
        report.elements.push_back(timing);
      }
    }
  for (const int threads : options.threads) {
    report.limits.push_back(measure_limits(threads));
    report.limits.back().reference_copy_gb_s = options.published.reference_bandwidth_gb_s(threads);
  }
  for (FemBenchRow& row : report.rows)
    for (const MachineLimits& limits : report.limits)
      if (limits.threads == row.threads) set_limits(row, limits);
  for (ElementTiming& timing : report.elements)
    for (const FemBenchRow& row : report.rows) {
      if (row.size != timing.size) continue;
      const StepCounts counts{.nodes = static_cast<double>(row.nodes),
                              .tetrahedra = static_cast<double>(row.tetrahedra),
                              .blocks = static_cast<double>(row.blocks)};
      const StageWork work = element_work(timing.stage, counts);
      for (const MachineLimits& limits : report.limits)
        if (limits.threads == timing.threads)
          timing.limit_ms = work.limit_ms(limits, work.read_bytes + work.written_bytes);
    }
  return report;
}

double scaling_exponent(const std::vector<const FemBenchRow*>& rows,
                        const std::function<double(const FemBenchRow&)>& figure) {
  std::vector<std::pair<double, double>> points;
  for (const FemBenchRow* row : rows) points.emplace_back(row->nodes, figure(*row));
  return scaling_exponent(points);
}

double scaling_exponent(const std::vector<std::pair<double, double>>& points) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (const auto& [size, figure] : points) {
    if (!(figure > 0.0)) continue;
    const double a = std::log(size), b = std::log(figure);
    n += 1;
    x += a;
    y += b;
    xx += a * a;
    xy += a * b;
  }
  const double spread = n * xx - x * x;
  return n >= 2 && spread > 1e-12 ? (n * xy - x * y) / spread : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace palpate::bench
