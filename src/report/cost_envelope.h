#pragma once
#include <string>
#include <vector>

#include "report/table.h"
#include "report/work_precision.h"

/// Cost of a target error on each refinement sequence of a comparison, and the cheapest sequence.
namespace palpate::report {

/// Ratio to the error of the reference below which errors are not resolved and do not affect a decision
/// (compare marks them, compare.h).
inline constexpr double kResolved = 10.0;

/// Cost of an error on one refinement sequence, from monotone envelopes of its levels (cost_envelope.cpp).
/// Costs are neither extrapolated nor interpolated across failed levels: there the cost of the next finer
/// level is an upper bound (`at_most`).
struct Cost {
  double value = kUnknown;                 ///< NaN: error not reached, or not resolved by the reference
  double low = kUnknown, high = kUnknown;  ///< By repeats and non-monotone levels
  bool at_most = false;                    ///< Whether `value` is an upper bound
};
/// Returns the cost of a target error.
/// @param reference_error  error of the reference; NaN: no error has a cost
Cost cost_at(const Ladder& ladder, double target, double reference_error);
std::string cost_text(const Cost& cost);    ///< "0.12", "<= 0.12", "-"
std::string spread_text(const Cost& cost);  ///< "0.11 to 0.14"

/// Ratio of two costs.
struct CostRatio {
  double value = kUnknown, low = kUnknown, high = kUnknown;
};
std::string ratio_text(const CostRatio& ratio);  ///< "1.50 (1.31 to 1.72)", "-"

/// Refinement sequence that reaches an error at the least cost.
struct Winner {
  double target = 0.0;
  bool resolved = false;  ///< Whether the reference resolves errors of this size
  bool found = false;     ///< Whether any sequence reaches the target
  std::string label, runner_up;
  Cost cost;
  CostRatio runner_up_ratio;  ///< Cost of the runner-up over the cheapest cost
  CostRatio baseline_ratio;   ///< Cost of kBaseline over the cheapest cost; NaN if kBaseline does not reach
                              ///< the error
  std::vector<std::string> rivals;  ///< Labels whose spread overlaps the cheapest: no winner
  bool declared() const { return found && rivals.empty(); }
};
/// Returns the cheapest sequence at each target.
/// @param reference_error  error of the reference; NaN: no winner is declared
std::vector<Winner> winners(const Table& compare, const std::string& error_column,
                            const std::string& cost_column, const std::vector<double>& targets,
                            double reference_error);
/// Returns the row of a target in a table: target, winner, cost, range, runner-up, and the two ratios.
/// @param shown  target as shown
/// @param ranked  text of the winner, where a sequence reaches the target
std::vector<std::string> winner_row(const Winner& win, double shown, const std::string& ranked);

}  // namespace palpate::report
