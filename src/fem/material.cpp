#include "palpate/fem/material.h"

#include <cmath>

#include "palpate/core/error.h"
#include "palpate/fem/spec.h"

namespace palpate::fem {

namespace {

void check_range(const char* where, const char* key, double value, const Range& range) {
  if (range.holds(value)) return;
  fail("{}: {} = {} {}", where, key, value, std::isinf(value) ? "must be a finite number" : range.demand());
}

}  // namespace

// Messages use the scene's keys, so that the user finds the line.
void check(const Material& m, const char* where) {
  using Ranges = MaterialRanges;
  check_range(where, "youngs_modulus_pa", m.youngs_modulus, Ranges::youngs_modulus_pa);
  check_range(where, "poissons_ratio", m.poissons_ratio, Ranges::poissons_ratio);
  check_range(where, "density_kg_m3", m.density, Ranges::density_kg_m3);
  check_range(where, "mass_damping_per_s", m.mass_damping, Ranges::mass_damping_per_s);
  check_range(where, "stiffness_damping_s", m.stiffness_damping, Ranges::stiffness_damping_s);
}

void check(const Materials& materials, int elements, const char* where) {
  for (const Material& material : materials.list) check(material, where);
  PALPATE_CHECK(!materials.list.empty(), "{}: the list of materials is empty", where);
  if (materials.of_element.empty()) return;
  PALPATE_CHECK(static_cast<int>(materials.of_element.size()) == elements,
                "{}: {} material indices for {} elements", where, materials.of_element.size(), elements);
  for (const int number : materials.of_element)
    PALPATE_CHECK(number >= 0 && number < static_cast<int>(materials.list.size()),
                  "{}: material index {} is not below {}, the number of materials", where, number,
                  materials.list.size());
}

}  // namespace palpate::fem
