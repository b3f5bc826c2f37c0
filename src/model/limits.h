#pragma once

namespace palpate::model {

/// Limits on the construction of a model; beyond them it fails with an Error.
struct Limits {
  double seconds = 600.0;  ///< wall time, from the first step on
  double spent = 0.0;      ///< wall time already spent in earlier steps [s]
  int points = 1'000'000;  ///< vertices that refinement may create, including those outside of the body
};

}  // namespace palpate::model
