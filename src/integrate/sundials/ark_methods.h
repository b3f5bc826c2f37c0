#pragma once
#include <string>
#include <vector>

#include "palpate/dynamics/stepper.h"

namespace palpate::integrate {

/// A method of ARKODE's ARKStep: an implicit table, an explicit one, or the two halves of an additive pair;
/// -1: none.
struct ArkMethod {
  std::string name, summary;
  int embedded_order = 1;  ///< of the second solution, whose difference is the error estimate
  int implicit_table = -1, explicit_table = -1;
  dynamics::StepperTraits traits;
  /// On a linear motion the estimate is of a higher order than the embedded one promises: the tall tree's
  /// condition, the only one of its order that counts there, is met as well.
  bool sharper_on_linear_motion = false;
};

/// One line a method, in the order of the registry.
const std::vector<ArkMethod>& ark_methods();
const ArkMethod& ark_method(const std::string& name);

}  // namespace palpate::integrate
