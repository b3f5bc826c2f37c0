#include "palpate/dynamics/force_term.h"

#include "palpate/core/error.h"

namespace palpate::dynamics {

void ForceTerm::store_tangent(const StateView&, double, double, BorderedMatrix&) {
  PALPATE_CHECK(false, "term \"{}\" names a block whose rows it stores, and stores none", name());
}

}  // namespace palpate::dynamics
