#pragma once
#include "palpate/dynamics/matrix.h"
#include "palpate/dynamics/state.h"

namespace palpate::dynamics {

/// Mass of one block: its rows and columns of M. Gyroscopic forces are a ForceTerm.
class InertiaTerm {
 public:
  virtual ~InertiaTerm() = default;
  /// Returns the id of the block.
  virtual int block_id() const = 0;
  /// Returns true when M of this block is diagonal and constant (lumped nodal mass).
  virtual bool diagonal() const = 0;
  /// Adds the node pairs that add_mass may touch; none where the mass is diagonal.
  virtual void add_pattern(PatternBuilder&) const {}
  /// Adds A += scale M.
  virtual void add_mass(const StateView& state, double scale, BorderedMatrix& A) const = 0;
  /// Adds y += M x; x and y have layout.u_size entries.
  virtual void apply(const StateView& state, const VecX& x, VecX& y) const = 0;
};

}  // namespace palpate::dynamics
