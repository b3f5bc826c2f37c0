#include "modal_steps.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <cmath>

#include "integrate/linear_step.h"

// x' = w G x, G = [0 1; -1 -2z], so that Z = H w G = y G.
//
//   Euler, implicit or linearly implicit    (1 - Z)^-1
//   implicit midpoint, trapezoidal rule     (1 - Z/2)^-1 (1 + Z/2)
//     (Newmark's average acceleration from a0 = M^-1 f0 is the trapezoidal rule)
//   classical Runge-Kutta                   1 + Z + Z^2/2 + Z^3/6 + Z^4/24
//   symplectic Euler                        a' <- (1 - 2 z y) a' - y (w a),  then  w a <- w a + y a'
//   BDF2                                    (3/2 - Z) x2 = 2 x1 - x0/2; the first step by Alexander's SDIRK
//                                           of order 2, s = 1 - 1/sqrt 2: (1 - s Z)^-2 (1 + (1 - 2 s) Z)
//   generalised-alpha (Chung and Hulbert 1993), X = [D; V; A] = [w a; w H a'; w H^2 a''] = [w a; y a'; ..]:
//     (1 - am) A1 + am A0 = -y^2 D_f - 2 z y V_f,      D_f = (1 - af) D1 + af D0, V_f alike,
//     D1 = D0 + V0 + (1/2 - b) A0 + b A1,      V1 = V0 + (1 - g) A0 + g A1;  at first A0 = -y^2 D0 - 2 z y V0
//   methods of SUNDIALS                     R(Z) of their tables (integrate/linear_step.h); for a contact
//                                           with the fraction c of the force, additive methods have
//                                           Z^ = c [0 0; -y -2zy] on the explicit side, multi-rate ones on
//                                           the fast one, and Z - Z^ on the other

namespace palpate::stability {
namespace {

MatX generator(double y, double z) { return (MatX(2, 2) << 0.0, y, -y, -2.0 * z * y).finished(); }

MatX inverse_times(const MatX& A, const MatX& B) { return A.partialPivLu().solve(B); }

}  // namespace

bool has_modal_steps(const Column& column) { return column.fixed && !is_static(column); }

ModalSteps::ModalSteps(const Column& column, double y, double z, double contact_share) {
  const MatX Z = generator(y, z), one = MatX::Identity(2, 2);
  if (column.name == "linearly-implicit-euler" || column.name == "backward-euler") {
    one_step(inverse_times(one - Z, one));
  } else if (column.name == "implicit-midpoint" || column.name == "newmark") {
    one_step(inverse_times(one - 0.5 * Z, one + 0.5 * Z));
  } else if (column.name == "rk4") {
    one_step(one + Z * (one + 0.5 * Z * (one + Z / 3.0 * (one + 0.25 * Z))));
  } else if (column.name == "symplectic-euler") {
    one_step((MatX(2, 2) << 1.0 - y * y, y * (1.0 - 2.0 * z * y), -y, 1.0 - 2.0 * z * y).finished());
  } else if (column.name == "bdf2" || column.name == "linearly-implicit-bdf2") {
    bdf2(Z);
  } else if (column.name == "generalized-alpha") {
    generalized_alpha(y, z, IntegratorSpec{}.spectral_radius);
  } else if (contact_share > 0.0 && splits(column)) {
    MatX contact = MatX::Zero(2, 2);
    contact.row(1) = contact_share * Z.row(1);
    one_step(integrate::split_step(column.name, Z - contact, contact));
  } else {
    one_step(integrate::linear_step(column.name, Z));
  }
}

void ModalSteps::one_step(const MatX& step) {
  start_ = MatX::Identity(2, 2);
  first_ = next_ = step;
}

void ModalSteps::bdf2(const MatX& Z) {
  const MatX one = MatX::Identity(2, 2);
  const double s = 1.0 - 1.0 / std::sqrt(2.0);
  start_ = MatX::Zero(4, 2);
  start_.topRows<2>() = one;
  first_ = next_ = MatX::Zero(4, 4);
  first_.bottomLeftCorner<2, 2>() = next_.bottomLeftCorner<2, 2>() = one;
  first_.topLeftCorner<2, 2>() =
      inverse_times(one - s * Z, inverse_times(one - s * Z, one + (1.0 - 2.0 * s) * Z));
  next_.topLeftCorner<2, 2>() = inverse_times(1.5 * one - Z, 2.0 * one);
  next_.topRightCorner<2, 2>() = inverse_times(1.5 * one - Z, -0.5 * one);
}

void ModalSteps::generalized_alpha(double y, double z, double r) {
  const double am = (2.0 * r - 1.0) / (r + 1.0), af = r / (r + 1.0), g = 0.5 - am + af,
               b = 0.25 * (1.0 - am + af) * (1.0 - am + af);
  // Left [D1; V1; A1] = right [D0; V0; A0], in X = [D; V/y; A/y^2], in which no entry is large.
  const double k = y * y, d = 2.0 * z * y;
  MatX left(3, 3), right(3, 3);
  left << 1.0, 0.0, -b, 0.0, 1.0, -g, (1.0 - af) * k, (1.0 - af) * d, 1.0 - am;
  right << 1.0, 1.0, 0.5 - b, 0.0, 1.0, 1.0 - g, -af * k, -af * d, -am;
  const Vec3 scale(1.0, y, k);
  left = (left * scale.asDiagonal()).eval();
  right = (right * scale.asDiagonal()).eval();
  left.row(2) /= 1.0 + k;
  right.row(2) /= 1.0 + k;
  first_ = next_ = inverse_times(left, right);
  start_ = MatX::Identity(3, 2);
  start_.row(2) << -1.0, -2.0 * z;
}

double ModalSteps::spectral_radius() const { return next_.eigenvalues().cwiseAbs().maxCoeff(); }

double ModalSteps::norm_of_first() const {
  return Eigen::JacobiSVD<MatX>((first_ * start_).topRows<2>()).singularValues()[0];
}

}  // namespace palpate::stability
