#pragma once
#include <atomic>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "experiments/engine.h"
#include "palpate/dynamics/stepper.h"

/// The stability matrix (docs/theory/verification.md): stiff and extreme cases against every integrator. The
/// expectation for each cell is derived from theory, as a function of the registry's properties of the
/// method; the cell is then run and compared with it.
namespace palpate::stability {

/// End of a cell, best first. The first four are acceptable; the others are failures, except for growth where
/// theory provides no bound for the method.
enum class Verdict {
  kAccurate,   ///< Within the error that theory allows relative to an exact answer.
  kStable,     ///< Less accurate, but its energy (or motion) never exceeded the input.
  kBounded,    ///< Exceeded the input, within a bound.
  kError,      ///< Ended early, with a message that gives the reason.
  kGrew,       ///< Exceeded every bound and reported success.
  kNotFinite,  ///< Returned NaN or infinity as a result.
  kSilent,     ///< Failed without a reason, or omitted a required report.
  kTooSlow,    ///< Stopped at the time limit of the cell.
  kWrong,      ///< Disagrees with physics or with the method's formula, or ended too early.
};
inline constexpr int kVerdicts = 9;
const char* to_string(Verdict verdict);  ///< "accurate", "stable", ..., "too slow", "wrong".

/// Set of verdicts: the expectation for a cell.
class Verdicts {
 public:
  Verdicts() = default;
  Verdicts(std::initializer_list<Verdict> verdicts) {
    for (const Verdict v : verdicts) add(v);
  }
  bool has(Verdict verdict) const { return bits_ >> static_cast<unsigned>(verdict) & 1u; }
  void add(Verdict verdict) { bits_ |= 1u << static_cast<unsigned>(verdict); }
  bool empty() const { return bits_ == 0; }
  std::string text() const;  ///< "accurate or stable".
  void archive(Archive& a) { a("bits", bits_); }

 private:
  unsigned bits_ = 0;
};

/// Result of one case under one integrator.
struct StabilityCell {
  std::string row, sub_case, integrator;
  Verdict verdict = Verdict::kSilent;
  Verdicts expected;
  std::string figure;  ///< Measured quantities as text: "energy +3e-07, error 2e-4 of 5e-3".
  /// Largest relative rise of the energy over the available energy; NaN: not measured in this case.
  double gain = std::numeric_limits<double>::quiet_NaN();
  /// Relative error against an exact answer; NaN: the case has none.
  double error = std::numeric_limits<double>::quiet_NaN();
  std::string reason;  ///< Why it ended, or why the verdict is not a better one.
  long steps = 0;      ///< Steps of the integrator.
  double cpu_s = 0.0;
  bool as_expected() const { return expected.has(verdict); }
  void archive(Archive& a);
};

struct StabilityRow {
  std::string name, summary;
  std::vector<std::string> sub_cases;
  bool slow = false;  ///< Takes minutes: only on request.
};
/// Returns the rows in the order of the matrix.
std::vector<StabilityRow> stability_rows();

constexpr double kLongerInSlowRows = 10.0;

struct StabilityOptions {
  std::vector<std::string> rows;         ///< Empty: all that are not slow.
  std::vector<std::string> integrators;  ///< By the registry's name; empty: all.
  bool slow = false;                     ///< Also the slow rows.
  bool core = false;  ///< One sub-case per row, for all rows that are not slow or are named.
  int seeds = 10;     ///< Number of random starts of a cell that uses them.
  int jobs = 1;       ///< Number of processes.
  /// CPU time limit of a cell [s]; for a slow row multiplied by kLongerInSlowRows.
  double limit_s = 20.0;
  /// Also called in the process of each cell; null: integrate::stepper_registry.
  const dynamics::StepperRegistry& (*registry)() = nullptr;
  std::function<void(double fraction, const std::string& what)> progress;
  const std::atomic<bool>* stop = nullptr;  ///< Set from outside: active cells are ended.
  experiments::Place place;  ///< Where results are kept; cells with another `registry` are not.
};

struct StabilityMatrix {
  std::vector<StabilityCell> cells;  ///< Rows in order, then sub-cases, then integrators.
  experiments::EngineOutcome outcome;
  double wall_s = 0.0;
  long unexpected() const;
};
/// Runs the matrix. Each cell runs in a separate process (experiments/engine.h).
/// @throws Error for a row or an integrator that does not exist, with the nearest name
StabilityMatrix run(const StabilityOptions& options);

/// Writes stability.csv, stability.json, and summary.json (versions, machine, command) into `folder`.
/// @param command command line, as a user would type it
void write(const StabilityMatrix& matrix, const std::string& folder, const std::string& command);

}  // namespace palpate::stability
