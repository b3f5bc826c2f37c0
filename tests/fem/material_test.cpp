#include "palpate/fem/material.h"

#include <limits>

#include "fem_fixture.h"

using namespace palpate;
using namespace palpate::fem;
using namespace palpate::fem::testing;

TEST(Material, LameConstantsGiveBackYoungAndPoisson) {
  const Material m = soft_material();
  const double mu = m.mu(), lambda = m.lambda();
  EXPECT_NEAR(mu * (3 * lambda + 2 * mu) / (lambda + mu), m.youngs_modulus, 1e-14);
  EXPECT_NEAR(0.5 * lambda / (lambda + mu), m.poissons_ratio, 1e-15);
}

TEST(Material, EveryValueOutOfRangeIsNamed) {
  struct Bad {
    double Material::*field;
    double value;
    const char* message;
  };
  const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
  const Bad cases[] = {
      {&Material::youngs_modulus, 0.0, "youngs_modulus_pa = 0 must be positive"},
      {&Material::youngs_modulus, nan, "youngs_modulus_pa = nan must be positive"},
      {&Material::youngs_modulus, inf, "youngs_modulus_pa = inf must be a finite number"},
      {&Material::poissons_ratio, 0.5,
       "poissons_ratio = 0.5 must lie in (-1, 0.5); use 0.49 for nearly incompressible tissue"},
      {&Material::poissons_ratio, -1.0, "poissons_ratio = -1 must lie in (-1, 0.5)"},
      {&Material::density, -2.0, "density_kg_m3 = -2 must be positive"},
      {&Material::mass_damping, -0.1, "mass_damping_per_s = -0.1 must not be negative"},
      {&Material::stiffness_damping, -0.1, "stiffness_damping_s = -0.1 must not be negative"}};
  for (const Bad& bad : cases) {
    Material m = soft_material();
    m.*bad.field = bad.value;
    const std::string message = message_of([&] { check(m, "body \"liver\""); });
    expect_contains(message, "body \"liver\": ");
    expect_contains(message, bad.message);
  }
  EXPECT_EQ(message_of([] { check(soft_material(), "body"); }), "");
}
