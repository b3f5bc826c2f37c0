#pragma once
#include "palpate/dynamics/zero_row_sum_matrix.h"

namespace palpate::dynamics {

using BalancedMatrix = ZeroRowSumMatrix;

}  // namespace palpate::dynamics
