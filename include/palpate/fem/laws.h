#pragma once
#include "palpate/core/registry.h"
#include "palpate/fem/options.h"

namespace palpate::fem {

/// Hyperelastic, isotropic constitutive law (src/fem/law.h).
struct Law;

/// Returns the laws by the names used in SoftBodyOptions::law and in the scene's key `[[body]] law`. All
/// laws take Young's modulus and Poisson's ratio, and agree with linear elasticity at small strain.
const Registry<const Law*>& law_registry();

/// Returns the index of a law in law_registry().
/// @param name  Name of the law.
/// @param where  Beginning of the message.
/// @throws Error with the nearest known name
std::size_t find_law(const std::string& name, std::string_view where);

/// Checks that a law exists and supports the given options.
/// @param law  Name of the law.
/// @param tangent  Tangent that the law must support.
/// @param nodal_dilatation  Whether part of the volumetric stiffness is left to NodalDilatation.
/// @param where  Beginning of the message.
/// @throws Error if `law` is unknown or does not support the options
void check_law(const std::string& law, Tangent tangent, bool nodal_dilatation, const std::string& where);

}  // namespace palpate::fem
