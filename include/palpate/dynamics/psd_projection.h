#pragma once

namespace palpate::dynamics {

/// Optional capability of a ForceTerm that can project its tangent onto the positive semi-definite matrices
/// (element by element, after Teran et al. 2005).  A class derives from it beside ForceTerm; System finds it
/// when the term is added.
class PsdProjectedTerm {
 public:
  virtual ~PsdProjectedTerm() = default;
  /// true: the tangent is projected from now on; false: it is the one that the term was made with.
  virtual void project_to_psd(bool on) = 0;
};

}  // namespace palpate::dynamics
