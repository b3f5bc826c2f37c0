#include "tick_scheme.h"

namespace palpate::tool {

const Registry<MakeTickScheme>& tick_scheme_registry() {
  static const Registry<MakeTickScheme> registry = {
      {"linearly-implicit-euler",
       "linearly implicit Euler: one 6x6 solve per tick, stable for any coupling; the default", 1,
       make_linearly_implicit_euler},
      {"semi-implicit-euler",
       "semi-implicit Euler: new velocity from old forces; stable for k < 4 m/tick^2 - 2 b/tick", 1,
       make_semi_implicit_euler},
      {"simbody-rkmerson", "Simbody's Runge-Kutta-Merson under error control (1e-10)", 4,
       make_runge_kutta_merson},
      {"simbody-semi-explicit-euler2",
       "Simbody's semi-explicit Euler under error control (1e-6: two to three digits) by step doubling", 1,
       make_semi_explicit_euler2},
      {"simbody-cpodes", "Simbody's CPodes (BDF, variable order) under error control (1e-10)", 0,
       make_cpodes},
  };
  return registry;
}

}  // namespace palpate::tool
