#pragma once
#include "palpate/dynamics/matrix.h"
#include "palpate/dynamics/state.h"

namespace palpate::dynamics {

/// Optional capability of a ForceTerm: writes all rows of one node block, so that the matrix need be neither
/// zeroed nor read there. A class inherits it in addition to ForceTerm; System detects it when the term is
/// added.
class StoredTangentTerm {
 public:
  virtual ~StoredTangentTerm() = default;
  /// Returns the node block whose rows store_tangent() writes.
  virtual int stored_block() const = 0;
  /// Sets the rows of stored_block() in the body part to k_scale K + d_scale D, whatever they held before.
  virtual void store_tangent(const StateView& state, double k_scale, double d_scale, BorderedMatrix& A) = 0;
};

}  // namespace palpate::dynamics
