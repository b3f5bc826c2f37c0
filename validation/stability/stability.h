#pragma once
#include <atomic>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "palpate/dynamics/stepper.h"

/// The stability matrix (docs/theory/verification.md): stiff and extreme cases against every integrator. What
/// each cell must show is written down from theory, as a function of what the registry says of the method;
/// the cell is then run and held against it.
namespace palpate::stability {

/// How a cell ended, best first.  The first four are acceptable ends; the others are failures, but for growth
/// where theory says that a method has no bound.
enum class Verdict {
  kAccurate,   ///< within the error that theory allows of an exact answer
  kStable,     ///< less accurate, but its energy (or motion) never exceeded what was put in
  kBounded,    ///< more than was put in, within a bound
  kError,      ///< ended early, with a message that says why
  kGrew,       ///< went beyond every bound and called it success
  kNotFinite,  ///< returned NaN or infinity as a result
  kSilent,     ///< failed without a reason, or kept back what it had to report
  kTooSlow,    ///< cut off at the time limit of the cell
  kWrong,      ///< did not do what physics, or the method's own formula, says must happen; or gave up early
};
inline constexpr int kVerdicts = 9;
const char* to_string(Verdict verdict);  ///< "accurate", "stable", ..., "too slow", "wrong"

/// A set of verdicts: what theory expects of a cell.
class Verdicts {
 public:
  Verdicts() = default;
  Verdicts(std::initializer_list<Verdict> verdicts) {
    for (const Verdict v : verdicts) add(v);
  }
  bool has(Verdict verdict) const { return bits_ >> static_cast<unsigned>(verdict) & 1u; }
  void add(Verdict verdict) { bits_ |= 1u << static_cast<unsigned>(verdict); }
  bool empty() const { return bits_ == 0; }
  std::string text() const;  ///< "accurate or stable"
 private:
  unsigned bits_ = 0;
};

/// One case under one integrator.
struct StabilityCell {
  std::string row, sub_case, integrator;
  Verdict verdict = Verdict::kSilent;
  Verdicts expected;
  std::string figure;  ///< what was measured, in words: "energy +3e-07, error 2e-4 of 5e-3"
  /// largest rise of the energy over what was available, relative; NaN: not measured in this case
  double gain = std::numeric_limits<double>::quiet_NaN();
  /// error against an exact answer, relative; NaN: the case has none
  double error = std::numeric_limits<double>::quiet_NaN();
  std::string reason;  ///< why it ended, or why the verdict is not a better one
  long steps = 0;      ///< of the integrator
  double cpu_s = 0.0;
  bool as_expected() const { return expected.has(verdict); }
};

struct StabilityRow {
  std::string name, summary;
  std::vector<std::string> sub_cases;
  bool slow = false;  ///< minutes: only on request
};
/// Rows in the order of the matrix.
std::vector<StabilityRow> stability_rows();

constexpr double kLongerInSlowRows = 10.0;

struct StabilityOptions {
  std::vector<std::string> rows;         ///< empty: all that are not slow
  std::vector<std::string> integrators;  ///< by the registry's name; empty: all
  bool slow = false;                     ///< the slow rows too
  bool core = false;                     ///< of each row one sub-case, of all that are not slow or are named
  int seeds = 10;                        ///< random starts of a cell that has them
  int jobs = 1;                          ///< processes
  /// CPU time of a cell; of a slow row's, kLongerInSlowRows times that
  double limit_s = 20.0;
  /// Called in the process of each cell as well; null: integrate::stepper_registry
  const dynamics::StepperRegistry& (*registry)() = nullptr;
  std::function<void(double fraction, const std::string& what)> progress;
  const std::atomic<bool>* stop = nullptr;  ///< set from outside: no new cell begins
};

struct StabilityMatrix {
  std::vector<StabilityCell> cells;  ///< rows in order, then sub-cases, then integrators
  bool stopped = false;
  double wall_s = 0.0;
  long unexpected() const;
};
/// Each cell runs in a process of its own, from core's ProcessPool: a program that has started threads or
/// drawn a picture by now must have called ProcessPool::prepare() before.
/// @throws Error for a row or an integrator that does not exist, with the nearest name
StabilityMatrix run(const StabilityOptions& options);

/// Writes stability.csv, stability.json, and summary.json (versions, machine, command) into `folder`.
/// @param command  as a person would type it again
void write(const StabilityMatrix& matrix, const std::string& folder, const std::string& command);

}  // namespace palpate::stability
