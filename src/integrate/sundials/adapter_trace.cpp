#include <nvector/nvector_serial.h>

#include <algorithm>
#include <limits>

#include "core/finite.h"
#include "integrate/sundials/adapter.h"
#include "integrate/sundials/vector_ops.h"

// Trace records of the steps of an Adapter, accepted and rejected.

namespace palpate::integrate::sun {

using dynamics::StepAttempt;

// Several attempts may fail inside one call of the library. Between two of them its failure counters
// increase, which is seen at the next evaluation; the end of an attempt is the latest time at which it
// evaluated.
void Adapter::trace_evaluation(double t, N_Vector y, bool finite) {
  finite_ = finite;
  if (!trace()) return;
  const Counts now = counts();
  if (attempt_open_ && now.error_test_failures > attempt_counts_.error_test_failures)
    close_attempt(StepAttempt::Outcome::kErrorTest);
  else if (attempt_open_ && now.solve_failures > attempt_counts_.solve_failures)
    close_attempt(attempt_finite_ ? StepAttempt::Outcome::kNewton : StepAttempt::Outcome::kNotFinite);
  if (!attempt_open_) attempt_halvings_ = halvings_;
  attempt_open_ = true;
  attempt_finite_ = finite;
  attempt_reach_ = std::max(attempt_reach_, t);
  attempt_y_ = Eigen::Map<const VecX>(NV_DATA_S(y), NV_LENGTH_S(y));
}

StepAttempt Adapter::attempt(double t0, double t1, StepAttempt::Outcome outcome) const {
  StepAttempt a;
  a.t = t0;
  a.h = t1 - t0;
  a.order = last_order();
  a.error = std::numeric_limits<double>::quiet_NaN();
  a.newton_iterations = static_cast<int>(counts().newton_iterations - attempt_counts_.newton_iterations);
  a.outcome = outcome;
  return a;
}

void Adapter::close_attempt(StepAttempt::Outcome outcome) {
  StepAttempt a = attempt(attempt_start_, attempt_reach_, outcome);
  a.halvings = attempt_halvings_;
  a.worst_dof = attempt_worst_ >= 0 ? problem_->dof_of(attempt_worst_) : -1;
  if (all_finite(attempt_y_)) {
    const auto [diagnostic, term] = problem_->inspect(attempt_reach_, attempt_y_.data());
    a.inverted_element = diagnostic.element;
    a.inverted_in = term;
  }
  trace()->attempt(a);
  attempt_counts_ = counts();
  attempt_reach_ = attempt_start_;
  attempt_worst_ = -1;
  attempt_open_ = false;
}

void Adapter::accept_attempt(double t0, double t1, bool event) {
  StepAttempt a = attempt(t0, t1, event ? StepAttempt::Outcome::kEvent : StepAttempt::Outcome::kAccepted);
  a.halvings = halvings_;
  if (local_errors(scratch_)) {
    fill_weights(y_, weights_);
    a.error = N_VWrmsNorm(scratch_, weights_);
    const int worst = index_of_largest(scratch_, weights_);
    a.worst_dof = worst >= 0 ? problem_->dof_of(worst) : -1;
  }
  const auto [diagnostic, term] = problem_->inspect(t1, NV_DATA_S(y_));
  a.inverted_element = diagnostic.element;
  a.inverted_in = term;
  trace()->attempt(a);
  attempt_open_ = false;
  attempt_worst_ = -1;
}

}  // namespace palpate::integrate::sun
