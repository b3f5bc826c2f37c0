#include "palpate/fem/material.h"

#include <cmath>

#include "palpate/core/error.h"

namespace palpate::fem {

// The names are the scene's keys, so that a person finds the line.
void check(const Material& m, const char* where) {
  if (!(std::isfinite(m.youngs_modulus) && m.youngs_modulus > 0.0))
    fail("{}: youngs_modulus_pa = {} must be positive and finite; soft tissue has 1e3 to 1e5 Pa", where,
         m.youngs_modulus);
  if (!(m.poissons_ratio > -1.0 && m.poissons_ratio < 0.5))
    fail("{}: poissons_ratio = {} must lie in (-1, 0.5); use 0.49 for nearly incompressible tissue", where,
         m.poissons_ratio);
  if (!(std::isfinite(m.density) && m.density > 0.0))
    fail("{}: density_kg_m3 = {} must be positive and finite; water has 1000 kg/m^3", where, m.density);
  if (!(std::isfinite(m.mass_damping) && m.mass_damping >= 0.0))
    fail("{}: mass_damping_per_s = {} must not be negative; use 0 for none", where, m.mass_damping);
  if (!(std::isfinite(m.stiffness_damping) && m.stiffness_damping >= 0.0))
    fail("{}: stiffness_damping_s = {} must not be negative; use 0 for none", where, m.stiffness_damping);
}

void check(const Materials& materials, int elements, const char* where) {
  for (const Material& material : materials.list) check(material, where);
  PALPATE_CHECK(!materials.list.empty(), "{}: no material", where);
  if (materials.of_element.empty()) return;
  PALPATE_CHECK(static_cast<int>(materials.of_element.size()) == elements,
                "{}: {} numbers of materials for {} elements", where, materials.of_element.size(), elements);
  for (const int number : materials.of_element)
    PALPATE_CHECK(number >= 0 && number < static_cast<int>(materials.list.size()), "{}: material {} of {}",
                  where, number, materials.list.size());
}

}  // namespace palpate::fem
