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
    case StepStatus::kInterrupted: return "interrupted";
  }
  return "unknown";
}

const char* to_string(StepAttempt::Outcome outcome) {
  switch (outcome) {
    case StepAttempt::Outcome::kAccepted: return "accepted";
    case StepAttempt::Outcome::kErrorTest: return "error test";
    case StepAttempt::Outcome::kNewton: return "Newton";
    case StepAttempt::Outcome::kNotFinite: return "not finite";
    case StepAttempt::Outcome::kEvent: return "event";
  }
  return "unknown";
}

const char* to_string(Stability stability) {
  switch (stability) {
    case Stability::kExplicit: return "explicit";
    case Stability::kStatic: return "static";
    case Stability::kAlpha: return "A(alpha)";
    case Stability::kA: return "A";
    case Stability::kL: return "L";
  }
  return "unknown";
}

}  // namespace palpate::dynamics
