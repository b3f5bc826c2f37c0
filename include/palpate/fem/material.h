#pragma once
#include <utility>
#include <vector>

namespace palpate::fem {

/// Lame's constants [Pa].
struct Lame {
  double mu = 0.0, lambda = 0.0;  ///< shear modulus, and its companion
};

/// Isotropic material by its behaviour at small strain, and its damping; what it does at large strain is the
/// constitutive law's (laws.h).
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

/// The materials of a body: one, or a list and the number in it of each tetrahedron.
struct Materials {
  std::vector<Material> list;   ///< at least one
  std::vector<int> of_element;  ///< in the order of the mesh; empty: all are list[0]

  /// One material throughout.
  Materials(const Material& all) : list{all} {}
  /// @param materials  the list  @param numbers  place in it of each tetrahedron, as many as the mesh has
  Materials(std::vector<Material> materials, std::vector<int> numbers)
      : list(std::move(materials)), of_element(std::move(numbers)) {}
  /// Place of an element's material in the list.
  int number(std::size_t element) const { return of_element.empty() ? 0 : of_element[element]; }
  /// An element's material.
  const Material& of(std::size_t element) const { return list[static_cast<std::size_t>(number(element))]; }
};

/// @throws Error naming the value out of range; `where` begins the message.
void check(const Material& material, const char* where);
/// Checks each material of a list, and that the numbers of the elements, one each, are in the list.
void check(const Materials& materials, int elements, const char* where);

}  // namespace palpate::fem
