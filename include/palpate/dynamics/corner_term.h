#pragma once

namespace palpate::dynamics {

/// Optional capability of a ForceTerm: it acts on rigid blocks only, so that add_tangent() writes to
/// BorderedMatrix::corner and nowhere else. A class inherits it in addition to ForceTerm.
class CornerTerm {
 public:
  virtual ~CornerTerm() = default;
};

}  // namespace palpate::dynamics
