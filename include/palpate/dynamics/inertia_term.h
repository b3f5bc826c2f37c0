#pragma once
#include "palpate/dynamics/matrix.h"
#include "palpate/dynamics/state.h"

namespace palpate::dynamics {

/// The mass of one block: its rows and columns of M.  Gyroscopic forces are a ForceTerm.
class InertiaTerm {
 public:
  virtual ~InertiaTerm() = default;
  /// The block whose mass it is.
  virtual int block_id() const = 0;
  /// True when M of this block is diagonal and constant (lumped nodal mass).
  virtual bool diagonal() const = 0;
  /// Node pairs that add_mass may touch; none where the mass is diagonal.
  virtual void add_pattern(PatternBuilder&) const {}
  /// A += scale M
  virtual void add_mass(const StateView& state, double scale, BorderedMatrix& A) const = 0;
  /// y += M x
  virtual void apply(const StateView& state, const VecX& x, VecX& y) const = 0;
};

}  // namespace palpate::dynamics
