#pragma once
#include "integrate/sundials/ark_methods.h"

namespace palpate::integrate {

/// What a Runge-Kutta pair is on linear motion, where its stability function says all.
struct ArkCalibration {
  double power = 1.0;               ///< of rtol, that the error test is held to
  double factor = 1.0;              ///< on that power; at most 1
  double spare = 1.0;               ///< so many times as large a factor would do on smooth motion
  double defect = 0.0;              ///< of the table's digits: error of a step in what it should do exactly
  double order = 1.0, error = 1.0;  ///< p, and c
};
const ArkCalibration& ark_calibration(const ArkMethod& method);

/// A motion in units of its tolerance at rtol = 1: a tenth of the body's size, with the usual atol_q = 0.01.
inline constexpr double kUsualMotion = 10.0;

}  // namespace palpate::integrate
