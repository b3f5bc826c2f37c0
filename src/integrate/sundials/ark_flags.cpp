#include "integrate/sundials/ark_flags.h"

#include <arkode/arkode_arkstep.h>

namespace palpate::integrate::sun {

using dynamics::StepStatus;

StepStatus ark_status(int flag) {
  switch (flag) {
    case ARK_TOO_MUCH_ACC:
    case ARK_TOO_CLOSE:
    case ARK_ILL_INPUT: return StepStatus::kBadSettings;
    case ARK_ERR_FAILURE: return StepStatus::kErrorTestFailed;
    case ARK_CONV_FAILURE: return StepStatus::kNewtonFailed;
    case ARK_RHSFUNC_FAIL:
    case ARK_FIRST_RHSFUNC_ERR:
    case ARK_REPTD_RHSFUNC_ERR:
    case ARK_UNREC_RHSFUNC_ERR: return StepStatus::kNotFinite;
    default: return StepStatus::kSolverFailed;
  }
}

}  // namespace palpate::integrate::sun
