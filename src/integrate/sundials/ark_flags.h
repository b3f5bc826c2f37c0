#pragma once
#include "palpate/dynamics/stepper.h"

namespace palpate::integrate {
namespace sun __attribute__((visibility("hidden"))) {

  /// Return values of ARKStep and MRIStep, which are the same numbers.
  dynamics::StepStatus ark_status(int flag);

}  // namespace )
}  // namespace palpate::integrate
