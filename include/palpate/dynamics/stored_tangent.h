#pragma once
#include "palpate/dynamics/matrix.h"
#include "palpate/dynamics/state.h"

namespace palpate::dynamics {

/// Optional capability of a ForceTerm: it can write the rows of one node block whole, so that the matrix need
/// be neither set to zero there nor read.  A class derives from it beside ForceTerm; System finds it when the
/// term is added.
class StoredTangentTerm {
 public:
  virtual ~StoredTangentTerm() = default;
  /// The node block whose rows store_tangent() writes.
  virtual int stored_block() const = 0;
  /// The rows of stored_block() in the body part become k_scale K + d_scale D, whatever they held before.
  virtual void store_tangent(const StateView& state, double k_scale, double d_scale, BorderedMatrix& A) = 0;
};

}  // namespace palpate::dynamics
