#pragma once

namespace palpate::dynamics {

/// Optional capability of a ForceTerm: projects its tangent onto the positive semi-definite matrices (element
/// by element, after Teran et al. 2005). A class inherits it in addition to ForceTerm; System detects it when
/// the term is added.
class PsdProjectedTerm {
 public:
  virtual ~PsdProjectedTerm() = default;
  /// Switches the projection. true: the tangent is projected from now on; false: it is the tangent that the
  /// term was made with.
  virtual void project_to_psd(bool on) = 0;
};

}  // namespace palpate::dynamics
