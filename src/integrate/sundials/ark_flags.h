#pragma once
#include "integrate/sundials/hidden.h"
#include "palpate/dynamics/stepper.h"

namespace palpate::integrate {
namespace PALPATE_HIDDEN sun {

/// Maps return values of ARKStep and MRIStep, which are the same numbers.
dynamics::StepStatus ark_status(int flag);

}  // namespace sun
}  // namespace palpate::integrate
