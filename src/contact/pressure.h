#pragma once
#include "palpate/contact/contact_force.h"

namespace palpate::contact {

/// A ContactSpec's law, its name resolved once.
struct PressureLaw {
  enum class Kind { kKelvinVoigt, kHuntCrossley } kind = Kind::kKelvinVoigt;
  double k = 0.0;      ///< [Pa/m]; per point [N/m]
  double d = 0.0;      ///< [Pa s/m]; per point [N s/m]; or c of hunt_crossley [s/m]
  double onset = 0.0;  ///< w [m]
  double friction = 0.0;
  double regularisation = 1e-3;  ///< v_r [m/s]
  /// step matrices leave out how friction follows the pressure (sample_math.cpp)
  bool symmetric_tangent = false;
  /// springs of points, not of area: `Pressure::p` is a force [N], and every sample's area is 1
  bool per_point = false;
};

/// @throws Error for a value that no contact can have, naming the pair and the key.
PressureLaw pressure_law(const ContactSpec& spec);

Pressure pressure(const PressureLaw& law, double gap, double gap_rate);

/// s(delta) with its derivative and its integral from 0.
struct Onset {
  double value, slope, integral;
};
Onset onset(double width, double depth);

/// Negative while the law presses, positive while it does not, and zero exactly where that changes [m].
/// Continuous in gap and rate.
double pressing(const PressureLaw& law, double gap, double gap_rate);

}  // namespace palpate::contact
