#pragma once
#include "palpate/core/registry.h"
#include "palpate/fem/options.h"

namespace palpate::fem {

/// A hyperelastic, isotropic constitutive law (src/fem/law.h).
struct Law;

/// The laws that SoftBodyOptions::law and the scene's key `[[body]] material` name.  All take Young's modulus
/// and Poisson's ratio, and agree with linear elasticity at small strain.
const Registry<const Law*>& law_registry();

/// Refuses what a law does not have.
/// @param law  its name  @param tangent  which it is to have  @param where  begins the message
/// @param nodal_dilatation  whether part of the resistance to a change of volume is left to NodalDilatation
/// @throws Error where `law` is unknown, or lacks what is asked for; `where` begins the message
void check_law(const std::string& law, Tangent tangent, bool nodal_dilatation, const std::string& where);

}  // namespace palpate::fem
