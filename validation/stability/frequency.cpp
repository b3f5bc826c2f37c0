#include "frequency.h"

#include <Eigen/Eigenvalues>
#include <cmath>

namespace palpate::stability {

double largest_frequency(dynamics::System& system, const dynamics::StateView& state) {
  const auto matrix = [&](double mass, double stiffness) {
    dynamics::BorderedMatrix A;
    system.step_matrix(state, mass, 0.0, stiffness, A);
    return A.to_dense();
  };
  return std::sqrt(Eigen::GeneralizedSelfAdjointEigenSolver<MatX>(matrix(0.0, 1.0), matrix(1.0, 0.0),
                                                                  Eigen::EigenvaluesOnly)
                       .eigenvalues()
                       .maxCoeff());
}

}  // namespace palpate::stability
