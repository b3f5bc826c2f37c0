#pragma once
#include <utility>
#include <vector>

namespace palpate::fem {

/// Lame's constants [Pa].
struct Lame {
  double mu = 0.0, lambda = 0.0;  ///< shear modulus mu and first Lame constant lambda
};

/// Isotropic material: its stiffness at small strain, density and damping. The response at large strain is
/// given by the constitutive law (laws.h).
struct Material {
  double youngs_modulus = 1e4;     ///< E [Pa] > 0
  double poissons_ratio = 0.3;     ///< nu in (-1, 0.5)
  double density = 1000.0;         ///< [kg/m^3] > 0
  double mass_damping = 0.0;       ///< alpha [1/s]
  double stiffness_damping = 0.0;  ///< beta [s]: mu_d = beta mu, lambda_d = beta lambda

  /// Shear modulus, E / (2 (1 + nu)) [Pa].
  double mu() const { return youngs_modulus / (2.0 * (1.0 + poissons_ratio)); }
  /// Lame's first constant, E nu / ((1 + nu) (1 - 2 nu)) [Pa].
  double lambda() const {
    return youngs_modulus * poissons_ratio / ((1.0 + poissons_ratio) * (1.0 - 2.0 * poissons_ratio));
  }
};

/// Materials of a body: one for all elements, or a list with one index per tetrahedron.
struct Materials {
  std::vector<Material> list;   ///< at least one
  std::vector<int> of_element;  ///< index in the list per element, in mesh order; empty: all are list[0]

  /// One material throughout.
  Materials(const Material& all) : list{all} {}
  /// @param materials  The list.
  /// @param numbers  Index in the list for each tetrahedron; as many as the mesh has.
  Materials(std::vector<Material> materials, std::vector<int> numbers)
      : list(std::move(materials)), of_element(std::move(numbers)) {}
  /// Index of an element's material in the list.
  int number(std::size_t element) const { return of_element.empty() ? 0 : of_element[element]; }
  /// An element's material.
  const Material& of(std::size_t element) const { return list[static_cast<std::size_t>(number(element))]; }
};

/// Checks that all values are in range. `where` begins the message.
/// @throws Error with the value that is out of range
void check(const Material& material, const char* where);
/// Checks each material of a list, and that there is one valid index per element. `where` begins the message.
/// @throws Error with the value that is out of range
void check(const Materials& materials, int elements, const char* where);

}  // namespace palpate::fem
