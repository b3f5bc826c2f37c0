#pragma once
#include <string>
#include <vector>

#include "palpate/dynamics/stepper.h"

namespace palpate::integrate {

/// Method of ARKODE's ARKStep: an implicit table, an explicit one, or the two halves of an additive pair; -1:
/// none.
struct ArkMethod {
  std::string name, summary;
  int embedded_order = 1;  ///< Order of the embedded solution, whose difference is the error estimate.
  int implicit_table = -1, explicit_table = -1;
  dynamics::StepperTraits traits;
  /// On linear motion the error estimate has a higher order than the embedded solution: the condition of the
  /// tall tree, the only one of its order that applies there, is satisfied as well.
  bool sharper_on_linear_motion = false;
};

/// Returns one entry per method, in the order of the registry.
const std::vector<ArkMethod>& ark_methods();
/// Returns the method of that name. @throws Error for an unknown name
const ArkMethod& ark_method(const std::string& name);

}  // namespace palpate::integrate
