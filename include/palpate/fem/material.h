#pragma once

namespace palpate::fem {

/// Isotropic linear material of the corotated energy, and its damping.
struct Material {
  double youngs_modulus = 1e4;        ///< E [Pa] > 0
  double poissons_ratio = 0.3;        ///< nu in (-1, 0.5)
  double density = 1000.0;            ///< [kg/m^3] > 0
  double mass_damping = 0.0;          ///< alpha [1/s]
  double stiffness_damping = 0.0;     ///< beta [s]: mu_d = beta mu, lambda_d = beta lambda

  double mu() const { return youngs_modulus / (2.0 * (1.0 + poissons_ratio)); }
  double lambda() const { return youngs_modulus * poissons_ratio / ((1.0 + poissons_ratio) * (1.0 - 2.0 * poissons_ratio)); }
};

/// @throws Error naming the value out of range; `where` begins the message.
void check(const Material& material, const char* where);

}  // namespace palpate::fem
