#pragma once
#include <string>
#include <vector>

#include "integrate/oscillator.h"

/// Names of the steppers implemented in palpate.
namespace hand_steppers {

using namespace palpate;

inline const std::vector<std::string> kHand = {"linearly-implicit-euler",
                                               "linearly-implicit-bdf2",
                                               "backward-euler",
                                               "implicit-midpoint",
                                               "bdf2",
                                               "newmark",
                                               "generalized-alpha",
                                               "symplectic-euler",
                                               "rk4"};
inline const std::vector<std::string> kNewton = {"backward-euler", "implicit-midpoint", "bdf2", "newmark",
                                                 "generalized-alpha"};

inline IntegratorSpec spec_of(const std::string& name, double h) {
  IntegratorSpec s;
  s.name = name;
  s.step_s = h;
  s.linear_solver = "cholmod";  // accurate to rounding: the steppers are tested
  return s;
}

}  // namespace hand_steppers
