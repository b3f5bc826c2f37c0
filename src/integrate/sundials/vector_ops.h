#pragma once
#include <sundials/sundials_nvector.h>

#include "integrate/sundials/hidden.h"

namespace palpate::integrate {
namespace PALPATE_HIDDEN sun {

/// Replaces the operations that dominate the cost of a large serial vector; clones inherit them. (Debian's
/// build takes 116 us for a weighted norm of 21,600 doubles; these vectorise.)
void use_fast_operations(N_Vector v);

/// Returns the entry with the largest |w_i v_i|; -1 where all are zero.
int index_of_largest(N_Vector v, N_Vector w);

}  // namespace sun
}  // namespace palpate::integrate
