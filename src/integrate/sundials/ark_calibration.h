#pragma once
#include "integrate/sundials/ark_methods.h"

namespace palpate::integrate {

/// Error of a Runge-Kutta pair on linear motion, where its stability function determines it.
struct ArkCalibration {
  double power = 1.0;   ///< Power of rtol in the tolerance of the error test.
  double factor = 1.0;  ///< Factor of that power; at most 1.
  double spare = 1.0;   ///< Ratio, at least 1, of the factor that is sufficient on smooth motion to `factor`.
  double defect = 0.0;  ///< Error of a step, due to the table's finite digits, in terms that should be exact.
  double order = 1.0, error = 1.0;  ///< p, and c.
};
/// Returns the calibration of a method; all are computed at the first call.
const ArkCalibration& ark_calibration(const ArkMethod& method);

/// Usual amplitude of a motion in units of its tolerance at rtol = 1: a tenth of the body's size, with the
/// usual atol_q = 0.01.
inline constexpr double kUsualMotion = 10.0;

}  // namespace palpate::integrate
