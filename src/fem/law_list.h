#pragma once

/// The constitutive laws by their names in a scene, in the order of the registry; for each NAME there are
///
///   src/fem/NAME.cpp        its derivation, its scalar formulas and its entry, laws::NAME (law.h);
///   src/fem/lanes_NAME.cpp  its formulas in vector lanes (lane_forces.h says what they must offer);
///   CMakeLists.txt          both, in PALPATE_LAWS.
#define PALPATE_LAWS(LAW) \
  LAW(corotational)       \
  LAW(stable_neo_hookean)
