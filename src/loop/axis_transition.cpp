#include <Eigen/Core>
#include <unsupported/Eigen/MatrixFunctions>

#include "palpate/loop/haptic_loop.h"

// Zero-order hold: with F constant over a step, y = (x, v, F) obeys y' = A y,
//     A = [0 1 0; -k/m -b/m 1/m; 0 0 0],
// so y(s) = exp(A s) y(0) without an error of time steps, k = b = 0 included.

namespace palpate::loop {

AxisTransition axis_transition(const HapticLoop::Axis& axis, double s) {
  const double m = axis.total_mass();
  Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
  A(0, 1) = 1.0;
  A.row(1) << -axis.arm_stiffness_n_m / m, -axis.total_damping() / m, 1.0 / m;
  const Eigen::Matrix3d E = (A * s).exp();
  return {E(0, 0), E(0, 1), E(0, 2), E(1, 0), E(1, 1), E(1, 2)};
}

}  // namespace palpate::loop
