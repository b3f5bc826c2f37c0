#pragma once

// The class layout in Simbody's headers depends on NDEBUG (CacheEntryInfo has members without it), and inline
// code in them accesses objects made by the library: they must see the setting that the library was built
// with. Debian's library is built without NDEBUG; if the headers see NDEBUG, realizeTopology crashes. CMake
// checks the library and sets PALPATE_SIMBODY_NDEBUG.
#pragma push_macro("NDEBUG")
#undef NDEBUG
#ifdef PALPATE_SIMBODY_NDEBUG
#define NDEBUG
#endif
#include <cassert>

#include <SimTKcommon/internal/common.h>

// C++20 also tries a == b as b == a, which makes Simbody 3.7's comparison of two of its index objects
// ambiguous (each converts to int and has members for every integer type). An exact match, declared before
// the headers that need it, resolves the ambiguity.
namespace SimTK {
template <class Index>
concept UniqueIndex = requires(Index i) {
  i.isValidExtended();
  i.invalidate();
  static_cast<int>(i);
};
template <UniqueIndex Index>
bool operator==(const Index& a, const Index& b) {
  return static_cast<int>(a) == static_cast<int>(b);
}
}  // namespace SimTK

#include <simbody/internal/Force_BuiltIns.h>
#include <simbody/internal/Force_Custom.h>
#include <simbody/internal/GeneralForceSubsystem.h>
#include <simbody/internal/MobilizedBody_Ball.h>
#include <simbody/internal/MobilizedBody_Free.h>
#include <simbody/internal/MobilizedBody_Ground.h>
#include <simbody/internal/MobilizedBody_Pin.h>
#include <simbody/internal/MobilizedBody_Weld.h>
#include <simbody/internal/MultibodySystem.h>
#include <simbody/internal/SimbodyMatterSubsystem.h>
#include <simmath/CPodesIntegrator.h>
#include <simmath/RungeKuttaMersonIntegrator.h>
#include <simmath/SemiExplicitEuler2Integrator.h>

#pragma pop_macro("NDEBUG")
#include <cassert>
