#pragma once

/// Constitutive laws by their names in a scene, in the order of the registry. For each NAME there are
///
///   src/fem/NAME.cpp        derivation, scalar formulas and registry entry, laws::NAME (law.h);
///   src/fem/lanes_NAME.cpp  formulas in vector lanes (required functions: lane_forces.h);
///   CMakeLists.txt          both, in PALPATE_LAWS.
#define PALPATE_LAWS(LAW) \
  LAW(corotational)       \
  LAW(stable_neo_hookean)
