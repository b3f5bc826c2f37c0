#pragma once

namespace palpate::model {

/// What a model may take: it is made within these bounds, or refused.
struct Limits {
  double seconds = 600.0;  ///< wall time, from the first step on
  double spent = 0.0;      ///< of those seconds, in the steps before
  int points = 1'000'000;  ///< vertices that refinement may make, those outside of the body with them
};

}  // namespace palpate::model
