#include "palpate/dynamics/stepper.h"

namespace palpate::dynamics {

const char* to_string(StepStatus status) {
  switch (status) {
    case StepStatus::kOk: return "ok";
    case StepStatus::kNewtonFailed: return "Newton did not converge";
    case StepStatus::kErrorTestFailed: return "error test failed too often";
    case StepStatus::kSolverFailed: return "linear solver failed";
    case StepStatus::kNotFinite: return "a value is not finite";
    case StepStatus::kTooManySteps: return "too many steps";
    case StepStatus::kBadSettings: return "bad settings";
  }
  return "unknown";
}

}  // namespace palpate::dynamics
